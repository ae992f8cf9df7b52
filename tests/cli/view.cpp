// rt view: replayed from scripts, and in a real window under Xvfb.
#include <tests/cli/run.hpp>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <regex>
#include <set>
#include <thread>

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <xcb/xcb.h>

namespace rt::cli_tests {

namespace {

/// Three frames, in which the left sphere rises.
const std::string kUpAndDown = R"(animation:
  frames: 3
  fps: 5
  tracks:
    - {target: left, move: {position: [-1.2, 0, 1.5]}, frames: [0, 2]}
)";

class View : public Cli {
protected:
    /// The last picture that a script ended with, as PNG bytes.
    std::string lastShown() const {
        std::string last;
        for (const std::string& name : files())
            if (name.starts_with("shown/") && name.ends_with(".png")) last = name;
        return last.empty() ? "" : read(last);
    }
    Outcome replay(const std::string& script) {
        write("keys.txt", script);
        return rt("view scene.yaml --script keys.txt --record shown");
    }
};

} // namespace

TEST_F(View, WithoutADisplayEndsWithEightAndAdvice) {
    const Outcome unset = rt("view scene.yaml");
    EXPECT_EQ(unset.exitCode, 8);
    EXPECT_EQ(unset.out, "");
    EXPECT_EQ(unset.err, "rt view: error: there is no display: DISPLAY is not set; run it on a "
                         "desktop, over ssh -X, or with "
                         "--script FILE --record DIR\n");
    RunOptions nowhere;
    nowhere.environment = {"DISPLAY=:4711"};
    const Outcome wrong = rt("view scene.yaml", nowhere);
    EXPECT_EQ(wrong.exitCode, 8);
    EXPECT_EQ(wrong.err, "rt view: error: there is no display: nothing answers at DISPLAY=:4711; "
                         "run it on a desktop, over ssh -X, "
                         "or with --script FILE --record DIR\n");
}

TEST_F(View, IdlePictureIsThatOfRender) {
    EXPECT_EQ(replay("wait\n").exitCode, 0);
    EXPECT_EQ(rt("render scene.yaml -o still.png").exitCode, 0);
    EXPECT_EQ(lastShown(), read("still.png"));
}

TEST_F(View, IdlePictureAfterAFlightIsThatOfRenderWithThePrintedCamera) {
    const Outcome flown =
        replay("key w 3\nkey j 2\nkey r\nkey e\ndrag 10 10 14 12\nwheel 2 5 5\nwait\nkey c\n");
    ASSERT_EQ(flown.exitCode, 0) << flown.err;
    ASSERT_TRUE(flown.out.starts_with("camera:\n")) << flown.out;
    const std::string scene = read("scene.yaml");
    const std::size_t camera = scene.find("camera:");
    ASSERT_NE(camera, std::string::npos);
    std::size_t end = scene.find('\n', camera) + 1; // past the key and the indented lines below it
    while (scene[end] == ' ') end = scene.find('\n', end) + 1;
    write("flown.yaml", scene.substr(0, camera) + flown.out + scene.substr(end));
    ASSERT_EQ(rt("check flown.yaml").exitCode, 0) << rt("check flown.yaml").err;
    EXPECT_EQ(rt("render flown.yaml -o still.png").exitCode, 0);
    EXPECT_EQ(lastShown(), read("still.png"));
}

TEST_F(View, ShadingModesAreThoseOfRender) {
    const char* const modes[] = {"full", "normals", "depth", "id", "cost"};
    for (int i = 0; i < 5; ++i) {
        SCOPED_TRACE(modes[i]);
        EXPECT_EQ(replay("key " + std::to_string(i + 1) + "\nwait\n").exitCode, 0);
        EXPECT_EQ(
            rt("render scene.yaml --antialias none -o still.png --shade " + std::string(modes[i]))
                .exitCode,
            0);
        EXPECT_EQ(lastShown(), read("still.png"));
    }
}

TEST_F(View, ClickNamesWhatStandsThere) {
    const Outcome clicked = replay("click 32 24\nclick 0 0\nwait\n");
    EXPECT_EQ(clicked.exitCode, 0);
    const auto lines = linesOf(clicked.out);
    ASSERT_EQ(lines.size(), 2u) << clicked.out;
    EXPECT_NE(lines[0].find(": material "), std::string::npos) << lines[0];
    EXPECT_NE(lines[0].find(", distance "), std::string::npos);
    EXPECT_NE(lines[0].find(", uv ["), std::string::npos);
    EXPECT_EQ(lines[1], "background");
}

TEST_F(View, ReportsHowSoonPicturesFollowedEvents) {
    const Outcome flown = replay("wait\nkey w 3\nwait\n");
    EXPECT_TRUE(std::regex_match(
        flown.err, std::regex("3 events changed the picture, after [0-9.]+ ms \\(median; at most "
                              "[0-9.]+ ms\\): [0-9.]+ pictures/s of [0-9]+x[0-9]+\n")))
        << flown.err;
}

TEST_F(View, StepsAndPlaysTheScenesOwnFrames) {
    write("scene.yaml", read("scene.yaml") + kUpAndDown);
    ASSERT_EQ(rt("render scene.yaml -o 0.png").exitCode, 0);
    ASSERT_EQ(rt("render scene.yaml -o 1.png --set objects.left.center=[-1.2,0,1]").exitCode, 0);
    ASSERT_EQ(rt("render scene.yaml -o 2.png --set objects.left.center=[-1.2,0,1.5]").exitCode, 0);
    EXPECT_EQ(replay("wait\nkey .\nwait\nkey p\nkey .\nwait\nkey p\nkey ,\nkey ,\nwait\n").exitCode,
              0);
    EXPECT_EQ(read("scene-view-0001.png"), read("1.png"));
    EXPECT_EQ(read("scene-view-0002.png"), read("2.png"));
    EXPECT_EQ(lastShown(), read("0.png"));
    // One second a picture allows the full size, so that each frame that is played shows all of it.
    write("keys.txt", "wait\nkey space\npause 2000\nkey space\nwait\n");
    EXPECT_EQ(rt("view scene.yaml --script keys.txt --record played --fps 1").exitCode, 0);
    std::set<std::string> played;
    for (const std::string& name : files())
        if (name.starts_with("played/") && name.ends_with(".png")) played.insert(read(name));
    for (const char* const frame : {"0.png", "1.png", "2.png"})
        EXPECT_TRUE(played.contains(read(frame))) << frame;
}

TEST_F(View, PSavesThePictureShown) {
    const Outcome saved = replay("wait\nkey p 2\n");
    EXPECT_EQ(saved.exitCode, 0);
    EXPECT_EQ(saved.out, "scene-view-0001.png\nscene-view-0002.png\n");
    EXPECT_EQ(read("scene-view-0001.png"), lastShown());
}

TEST_F(View, RefusesWhatCannotBe) {
    const Outcome alone = rt("view scene.yaml --record shown");
    EXPECT_EQ(alone.exitCode, 2);
    EXPECT_EQ(
        alone.err,
        "rt view: error: --record needs --script; such as --script keys.txt --record shown\n");
    EXPECT_EQ(rt("view scene.yaml --script missing.txt").exitCode, 4);
    write("bad.txt", "key w\nfly\n");
    const Outcome bad = rt("view scene.yaml --script bad.txt");
    EXPECT_EQ(bad.exitCode, 4);
    EXPECT_TRUE(bad.err.starts_with("bad.txt:2:1: error[E0405]: ")) << bad.err;
    EXPECT_EQ(rt("view missing.yaml --script bad.txt").exitCode, 4);
}

namespace {

std::string output(const std::string& command) {
    std::string text;
    if (FILE* pipe = popen(command.c_str(), "r")) {
        char buffer[256];
        while (std::fgets(buffer, sizeof buffer, pipe)) text += buffer;
        pclose(pipe);
    }
    return text;
}

bool has(const char* program) { return !output(std::string("command -v ") + program).empty(); }

/// An X server of our own, on the first free number.
class Xvfb {
public:
    Xvfb() {
        int ends[2];
        if (pipe(ends) != 0) return;
        process_ = fork();
        if (process_ == 0) {
            prctl(PR_SET_PDEATHSIG, SIGKILL); // it holds this test's output open
            close(ends[0]);
            // -noreset: else it starts anew, and lets nobody in meanwhile, whenever its last client leaves,
            // as xdotool often does.
            execlp("Xvfb", "Xvfb", "-displayfd", std::to_string(ends[1]).c_str(), "-screen", "0",
                   "1024x768x24", "-nolisten", "tcp", "-noreset", nullptr);
            _exit(127);
        }
        close(ends[1]);
        char number[16] = {};
        for (ssize_t n = 0, got;
             n < 15 && (got = ::read(ends[0], number + n, 1)) == 1 && number[n] != '\n'; ++n) {
        }
        close(ends[0]);
        display = ":" + std::string(number).substr(0, std::string(number).find('\n'));
    }
    ~Xvfb() {
        if (process_ <= 0) return;
        kill(process_, SIGTERM);
        waitpid(process_, nullptr, 0);
    }
    std::string display;

private:
    pid_t process_ = -1;
};

/// Sends what a window manager sends when its close button is pressed [ICCCM 4.2.8.1].
void pressCloseButton(const std::string& display, const std::string& window) {
    xcb_connection_t* connection = xcb_connect(display.c_str(), nullptr);
    const auto atom = [&](const std::string& name) {
        const auto cookie =
            xcb_intern_atom(connection, 0, static_cast<std::uint16_t>(name.size()), name.c_str());
        const std::unique_ptr<xcb_intern_atom_reply_t, decltype(&std::free)> reply(
            xcb_intern_atom_reply(connection, cookie, nullptr), &std::free);
        return reply->atom;
    };
    xcb_client_message_event_t event{};
    event.response_type = XCB_CLIENT_MESSAGE;
    event.format = 32;
    event.window = static_cast<xcb_window_t>(std::stoul(window));
    event.type = atom("WM_PROTOCOLS");
    event.data.data32[0] = atom("WM_DELETE_WINDOW");
    const auto sent = xcb_send_event_checked(connection, 0, event.window, XCB_EVENT_MASK_NO_EVENT,
                                             reinterpret_cast<const char*>(&event));
    EXPECT_EQ(xcb_request_check(connection, sent), nullptr); // waits until it has arrived
    xcb_disconnect(connection);
}

} // namespace

TEST_F(View, WindowUnderXvfbTakesKeysMouseReloadAndClose) {
    if (!has("Xvfb") || !has("xdotool")) GTEST_SKIP() << "needs xvfb and xdotool";
    std::string display;
    const auto xdotool = [&](const std::string& command) {
        return output("DISPLAY=" + display + " xdotool " + command + " 2>/dev/null");
    };
    write("scene.yaml", read("scene.yaml") + kUpAndDown);
    const std::string good = read("scene.yaml");

    RunOptions options;
    options.seconds = 60;
    std::function<void(const std::string& window)> end;
    options.whileRunning = [&](int) {
        std::string window;
        ASSERT_TRUE(eventually([&] {
            const auto found = words(xdotool("search --name 'rt view'"));
            if (!found.empty()) window = found.back();
            return !found.empty();
        }));
        const auto key = [&](const std::string& name) {
            xdotool("key --window " + window + " " + name);
        };
        for (const char* name :
             {"w", "a", "s",    "d",     "r",  "f",     "q",     "e",     "i",      "j",
              "k", "l", "Left", "Right", "Up", "Down",  "plus",  "minus", "2",      "3",
              "4", "5", "1",    "h",     "h",  "space", "space", "comma", "period", "0"})
            key(name);
        key("p");
        EXPECT_TRUE(eventually([&] { return exists("scene-view-0001.png"); }));
        xdotool("mousemove --window " + window + " 32 24 click 1");
        xdotool("mousemove --window " + window +
                " 20 20 mousedown 1 mousemove_relative 9 3 mouseup 1 click 4 click 5");
        xdotool("windowsize " + window + " 300 240");
        key("p"); // letters still arrive after a click
        EXPECT_TRUE(eventually([&] { return exists("scene-view-0002.png"); }));
        write("scene.yaml", "rt: 1\nobjects: 3\n");
        std::this_thread::sleep_for(std::chrono::seconds(1)); // longer than the watch interval
        key("p");
        EXPECT_TRUE(eventually(
            [&] { return exists("scene-view-0003.png"); })); // the last good picture stays
        write("scene.yaml", good);
        std::this_thread::sleep_for(std::chrono::seconds(1));
        key("c");
        key("p");
        EXPECT_TRUE(eventually([&] { return exists("scene-view-0004.png"); }));
        end(window);
    };
    const auto view = [&] { // on a server of its own
        const Xvfb server;
        display = server.display;
        options.environment = {"DISPLAY=" + display};
        return run({"view", "scene.yaml"}, options);
    };
    end = [&](const std::string& window) { xdotool("key --window " + window + " Escape"); };
    const Outcome first = view();
    EXPECT_EQ(first.exitCode, 0) << first.err;
    for (const char* const n : {"1", "2", "3", "4"})
        std::filesystem::remove(folder_ / ("scene-view-000" + std::string(n) + ".png"));
    end = [&](const std::string& window) { pressCloseButton(display, window); };
    const Outcome outcome = view();
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("camera:\n"), std::string::npos) << outcome.out;
    EXPECT_TRUE(std::regex_search(
        outcome.out, std::regex("(^|\n)(background|[a-z]+: material [a-z]+, distance [0-9.]+, "
                                "position \\[.*\\], uv \\[.*\\])\n")))
        << outcome.out;
    EXPECT_NE(outcome.err.find("scene.yaml:2:10: error[E03"), std::string::npos) << outcome.err;
}

} // namespace rt::cli_tests
