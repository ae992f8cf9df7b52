// Frames and their manifest: names, torn lines, foreign bytes.
#include <formats/frame_store.hpp>

#include <formats/checksum.hpp>
#include <tests/formats/temporary_folder.hpp>

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace rt::formats {
namespace {

std::vector<std::byte> bytesOf(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

std::string readText(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

class Frames : public testing::Test {
protected:
    std::optional<FrameStore> open(FrameStore::Mode mode) {
        diagnostics_ = {};
        return FrameStore::open(place_, settings_, mode, diagnostics_);
    }
    TemporaryFolder folder_;
    FramePlace place_{.folder = folder_ / "a.frames"};
    Settings settings_{{"image.width", "4"}, {"objects.moon.radius", "2"}};
    scene::Diagnostics diagnostics_;
};

TEST(FrameNames, OfPatterns) {
    EXPECT_EQ(framePattern("out/shot_%04d.png")->folder, "out");
    EXPECT_EQ(framePattern("out/shot_%04d.png")->fileOf(7), "shot_0007.png");
    EXPECT_EQ(framePattern("%d.exr")->fileOf(12345), "12345.exr");
    EXPECT_EQ(framePattern("50%%_%3d")->fileOf(1), "50%_001");
    for (const char* none : {"a.png", "%.png", "%s.png", "%d%d.png", "%099d.png", "a%", "%d/a.png"})
        EXPECT_FALSE(framePattern(none)) << none;
    EXPECT_EQ(framesBeside("x/film.old.mp4").pathOf("f"), "x/film.old.frames/f");
}

TEST_F(Frames, TornAndForeignLinesOfTheManifestVouchForNothing) {
    {
        auto store = open(FrameStore::Mode::fresh);
        ASSERT_TRUE(store);
        for (std::uint32_t frame = 0; frame < 4; ++frame)
            store->commit(frame, bytesOf("frame " + std::to_string(frame)));
    }
    const std::string manifest = readText(folder_ / "a.frames/manifest");
    for (std::size_t cut = 1; cut < 90; cut += 11) { // within the last line
        std::ofstream(folder_ / "a.frames/manifest", std::ios::binary)
            << manifest.substr(0, manifest.size() - cut);
        auto store = open(FrameStore::Mode::resume);
        ASSERT_TRUE(store) << cut;
        EXPECT_TRUE(store->isDone(1)) << cut;
        // Without its line end the last line is still whole.
        EXPECT_EQ(store->isListed(3), cut == 1) << cut;
        store->commit(3, bytesOf("frame 3"));
        EXPECT_EQ(FrameStore::read(place_, diagnostics_)->listed(),
                  (std::vector<std::uint32_t>{0, 1, 2, 3}))
            << cut;
    }
    std::string changed = manifest;
    changed[changed.rfind("frame\t3") + 6] = '9';
    std::ofstream(folder_ / "a.frames/manifest", std::ios::binary) << changed;
    EXPECT_FALSE(FrameStore::read(place_, diagnostics_)->isListed(9));
}

TEST_F(Frames, OfAnotherFilmAreNotMixedIn) {
    open(FrameStore::Mode::fresh)->commit(0, bytesOf("x"));
    EXPECT_FALSE(open(FrameStore::Mode::fresh));
    EXPECT_EQ(diagnostics_.all().front().code, scene::Code{609});
    settings_[1].second = "3";
    EXPECT_FALSE(open(FrameStore::Mode::resume));
    EXPECT_EQ(diagnostics_.all().front().message,
              "these frames are of another film: objects.moon.radius was '2' and is '3'");
    EXPECT_TRUE(open(FrameStore::Mode::overwrite));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.frames/frame_0000.png"));
    EXPECT_EQ(firstDifference({{"a", "1"}}, {{"a", "1"}, {"b", "2"}}), "b is new: '2'");
    EXPECT_EQ(firstDifference({{"a", "1"}, {"b", "2"}}, {{"a", "1"}}), "b was '2' and is gone");
}

TEST_F(Frames, LeftoversOfAKilledProcessAreSweptAndOthersFilesAreNot) {
    std::filesystem::create_directories(folder_ / "a.frames");
    for (const std::string name :
         {".frame_0001.png.4711.tmp", ".manifest.4711.tmp", ".frame_x.tmp", "mine.tmp"})
        std::ofstream(folder_ / ("a.frames/" + name)) << "x";
    ASSERT_TRUE(open(FrameStore::Mode::fresh));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.frames/.frame_0001.png.4711.tmp"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.frames/.manifest.4711.tmp"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "a.frames/.frame_x.tmp"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "a.frames/mine.tmp"));
}

TEST_F(Frames, AManifestNamesOnlyFramesOfItsFolder) {
    open(FrameStore::Mode::fresh)->commit(0, bytesOf("x"));
    const std::filesystem::path manifest = folder_ / "a.frames/manifest";
    std::ofstream(folder_ / "outside") << "x";
    for (const std::string name : {"../outside", "manifest", "frame_0001/../../outside", ""}) {
        const std::string line = "frame\t1\t" + name + "\t1\t" + checksum(std::string_view("x"));
        std::ofstream(manifest, std::ios::app) << line << '\t' << checksum(line) << '\n';
    }
    EXPECT_EQ(FrameStore::read(place_, diagnostics_)->listed(), std::vector<std::uint32_t>{0});
    EXPECT_TRUE(open(FrameStore::Mode::overwrite));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "outside"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.frames/frame_0000.png"));
}

TEST_F(Frames, AreRegularFiles) {
    open(FrameStore::Mode::fresh)->commit(0, bytesOf("x"));
    std::filesystem::remove(folder_ / "a.frames/frame_0000.png");
    std::filesystem::create_symlink("/dev/zero", folder_ / "a.frames/frame_0000.png");
    EXPECT_FALSE(FrameStore::read(place_, diagnostics_)->isDone(0));
    std::filesystem::remove(folder_ / "a.frames/manifest");
    std::filesystem::create_symlink("/dev/zero", folder_ / "a.frames/manifest");
    EXPECT_FALSE(FrameStore::read(place_, diagnostics_));
}

TEST_F(Frames, AreInUseByOneProcess) {
    const auto first = open(FrameStore::Mode::fresh);
    EXPECT_FALSE(open(FrameStore::Mode::resume));
    EXPECT_EQ(diagnostics_.all().front().code, scene::Code{608});
}

} // namespace
} // namespace rt::formats
