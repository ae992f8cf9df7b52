#include <core/view/script.hpp>

#include <gtest/gtest.h>

namespace rt::view {

namespace {

std::optional<std::vector<Command>> parsed(const std::string& text,
                                           scene::Diagnostics& diagnostics) {
    return parseScript(std::make_shared<scene::Source>(scene::Source{"keys.txt", text}),
                       diagnostics);
}

} // namespace

TEST(Script, ReadsEveryCommand) {
    scene::Diagnostics diagnostics;
    const auto commands = parsed(
        "# fly\nkey w 3\nkey left\nclick 4 5\ndrag 1 2 3 4 # look\nwheel -2 7 8\nwait\npause 30\n",
        diagnostics);
    ASSERT_TRUE(commands);
    ASSERT_EQ(commands->size(), 7u);
    EXPECT_EQ((*commands)[0].events.size(), 3u);
    EXPECT_EQ((*commands)[0].events[0].key, 'w');
    EXPECT_EQ((*commands)[1].events[0].key, 0xff51);
    EXPECT_EQ((*commands)[2].events[1].kind, Event::Kind::release);
    EXPECT_EQ((*commands)[3].events[1].kind, Event::Kind::move);
    EXPECT_EQ((*commands)[3].events[1].x, 3);
    EXPECT_EQ((*commands)[4].events.size(), 2u);
    EXPECT_EQ((*commands)[4].events[0].y, -1);
    EXPECT_EQ((*commands)[5].kind, Command::Kind::wait);
    EXPECT_EQ((*commands)[6].milliseconds, 30);
}

TEST(Script, SaysWhichLineIsNoCommand) {
    scene::Diagnostics diagnostics;
    EXPECT_FALSE(
        parsed("key w\n  klick 3 4\nkey w 0\nwheel 0 1 1\npause -1\nclick 1\n", diagnostics));
    ASSERT_EQ(diagnostics.errorCount(), 5u);
    EXPECT_EQ(scene::format(diagnostics.all()[0], false).substr(0, 184),
              "keys.txt:2:3: error[E0405]: this is no command of a viewer script: expected key "
              "NAME [COUNT], click X Y, drag X0 "
              "Y0 X1 Y1, wheel STEPS X Y, wait or pause MILLISECONDS; did you mean 'cl");
    EXPECT_EQ(diagnostics.all()[1].location.line, 3u);
}

TEST(Script, HandsOverTheNextEventWhenAPictureFollowedOrTheViewerIsIdle) {
    scene::Diagnostics diagnostics;
    std::vector<bool> first;
    ScriptDisplay display(
        *parsed("key w 2\nwait\n", diagnostics),
        [&](const ScriptDisplay::Shown& s) { first.push_back(s.firstSinceEvent); },
        [](Picture&, const std::vector<std::string>&) {});
    const Picture picture{1, 1, {0, 0, 0}}, brighter{1, 1, {1, 0, 0}};
    const Detail coarse{1, 1, false};
    display.show(picture, coarse);
    EXPECT_EQ(display.poll(0, true)->size(), 1u);
    EXPECT_EQ(display.poll(0, false)->size(), 0u); // nothing shown yet
    display.show(picture, coarse);                 // of what was under way before the event
    display.show(brighter, coarse);
    display.show(picture, coarse);
    EXPECT_EQ(display.poll(0, false)->size(), 1u);
    EXPECT_EQ(display.poll(0, true)->size(), 0u); // wait, done
    EXPECT_FALSE(display.poll(0, true));          // the script's end closes the display
    EXPECT_EQ(first, (std::vector<bool>{false, false, true, false}));
}

} // namespace rt::view
