// Every hostile file: no signal, no hang, no memory to speak of, the right exit code and a message that says where.
#include <tests/faults/faults.hpp>
#include <tests/faults/hostile_files.hpp>

#include <regex>

namespace rt::faults {
namespace {

// Of the processor: the wall clock also counts who else uses the machine.
constexpr double kMaxSeconds = 2;
// OpenCV takes 60 MiB to start; a million nodes of YAML, the most that are held, 300 MiB.
constexpr std::size_t kMaxBytes = 512u << 20;

} // namespace

class Hostile : public Faults {
protected:
    /// Writes what leads rt to the file; the command lines that do.
    std::vector<std::string> ways(const HostileFile& f) const {
        const std::string head = "rt: 1\nimage: {width: 8, height: 8}\ncamera: {position: [0, -5, "
                                 "0], look_at: [0, 0, 0], "
                                 "field_of_view: 50deg}\n";
        switch (f.format) {
        case Format::scene:
            return {"check " + f.name};
        case Format::inf:
            return {"convert --check " + f.name};
        case Format::movie:
            write("base.inf", cli_tests::kOldScene);
            return {"convert --check base.inf --movie " + f.name};
        case Format::library:
            write("base.obj",
                  "mtllib " + f.name + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
            write("way.yaml", head + "objects: [mesh: {file: base.obj}]\n");
            return {"check way.yaml"};
        case Format::mesh:
            write("way.yaml", head + "objects: [mesh: {file: " + f.name + "}]\n");
            return {"check way.yaml"};
        case Format::picture:
            write("way.yaml", head + "textures: {t: {image: {file: " + f.name +
                                  "}}}\nbackground: {texture: t}\n");
            return {"check way.yaml", "compare " + f.name + " " + f.name};
        case Format::script:
            return {"view scene.yaml --script " + f.name};
        case Format::module:
            write("modules/dot.rtplugin.so", f.bytes);
            write("way.yaml", head + "objects: [dot: {}]\n");
            return {"check way.yaml --plugin-dir modules"};
        }
        return {};
    }
    /// Some line of stderr that refuses with this exit code and says in which file, and most often where in it.
    static std::regex located(int exitCode) {
        return std::regex("(^|\n)[^\n]*\\.(yaml|inf|txt|png|jpg|bmp|hdr|exr|pfm|pgm|ppm)(:\\d+:\\d+"
                          ")?: error\\[E0" +
                          std::to_string(exitCode) + "\\d\\d\\]: [^\n]+\n");
    }
};

TEST_F(Hostile, FilesAreRefused) {
    const auto all =
        hostileFiles(RT_SOURCE_DIR "/tests/corpus", RT_TEST_MODULES "/good/dot.rtplugin.so");
    EXPECT_GE(all.size(), 200u);
    double slowest = 0;
    std::size_t largest = 0, runs = 0;
    for (const HostileFile& f : all) {
        write(f.name, f.bytes);
        for (const std::string& way : ways(f)) {
            SCOPED_TRACE(way + ": " + f.bytes.substr(0, 200));
            const auto before = files();
            cli_tests::RunOptions patient; // the clock on the wall is no measure here
            patient.seconds = 300;
            const cli_tests::Outcome o = rt(way, patient);
            // Who uses the other thread of a core slows this one: of three runs the quickest counts.
            double seconds = o.cpuSeconds;
            for (int again = 0; again < 2 && !kSanitized && seconds >= kMaxSeconds; ++again)
                seconds = std::min(seconds, rt(way, patient).cpuSeconds);
            ++runs;
            slowest = std::max(slowest, seconds), largest = std::max(largest, o.peakBytes);
            EXPECT_EQ(o.signal, 0);
            // A picture's header that asks for too much may also be too much for its format.
            const bool eitherWay = f.format == Format::picture && o.exitCode + f.exitCode == 11;
            EXPECT_TRUE(o.exitCode == f.exitCode || eitherWay)
                << o.exitCode << ", not " << f.exitCode << ": " << o.err.substr(0, 500);
            EXPECT_TRUE(kSanitized || seconds < kMaxSeconds) << seconds;
            EXPECT_TRUE(kSanitized || o.peakBytes < kMaxBytes) << o.peakBytes;
            if (f.exitCode != 0) {
                EXPECT_TRUE(std::regex_search(o.err.substr(0, 2000), located(o.exitCode)))
                    << o.err.substr(0, 500);
            }
            for (const char c : o.err)
                EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= 0x20) << int(c);
            EXPECT_EQ(files(), before);
        }
        std::filesystem::remove(folder_ / f.name);
    }
    std::printf("%zu files, %zu runs, slowest %.2f s of CPU, largest %zu MiB\n", all.size(), runs,
                slowest, largest >> 20);
}

} // namespace rt::faults
