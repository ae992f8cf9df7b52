// Bytes as the manifest of a folder of frames, as they are, and as lines that get the checksums which bytes at random never have:
// what is read is mended once, goes on, and touches nothing outside of the folder.
#include <formats/checksum.hpp>
#include <formats/frame_store.hpp>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace fs = std::filesystem;
using rt::formats::FramePlace;
using rt::formats::FrameStore;

namespace {

void require(bool holds) {
    if (!holds) std::abort();
}

/// In memory where there is such a file system, so that syncing costs nothing.
struct Folder {
    std::string path =
        fs::exists("/dev/shm") ? "/dev/shm/rt_manifest_XXXXXX" : "rt_manifest_XXXXXX";
    Folder() { require(::mkdtemp(path.data()) != nullptr); }
    ~Folder() { fs::remove_all(path); }
};

std::string sealed(std::string_view text) {
    std::string lines = "rt-frames 1\n";
    while (!text.empty()) {
        const std::string line(text.substr(0, text.find('\n')));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        lines += line + '\t' + rt::formats::checksum(line) + '\n';
    }
    return lines;
}

void run(const std::string& manifest) {
    static const Folder folder;
    const FramePlace place{.folder = folder.path + "/a.frames"};
    fs::create_directories(place.folder);
    std::ofstream(folder.path + "/outside") << "x";
    std::ofstream(place.folder + "/frame_0000.png") << "x";
    std::ofstream(place.folder + "/manifest") << manifest;

    constexpr std::uint32_t kNext = 7;
    rt::scene::Diagnostics diagnostics;
    auto frames = std::vector<std::uint32_t>{};
    if (const auto read = FrameStore::read(place, diagnostics)) {
        for (const std::uint32_t frame : read->listed()) (void)read->load(frame);
        const auto open = [&](rt::scene::Diagnostics& said) {
            return FrameStore::open(place, read->settings(), FrameStore::Mode::resume, said);
        };
        if (auto store = open(diagnostics)) {
            require(store->listed() == read->listed());
            const std::byte byte{1};
            store->commit(kNext, {&byte, 1});
            frames = store->listed();
        } else {
            // Only where a field has two values.
            require(diagnostics.all().back().code == rt::scene::Code{610});
        }
    }
    if (!frames.empty()) {
        const auto again = FrameStore::read(place, diagnostics);
        require(again && again->listed() == frames && again->isDone(kNext));
    }
    const auto fresh = FrameStore::open(place, {}, FrameStore::Mode::overwrite, diagnostics);
    require(fresh && fresh->listed().empty());
    require(fs::exists(folder.path + "/outside"));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    run(text);
    run(sealed(text));
    return 0;
}
