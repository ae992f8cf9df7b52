// The table of threats, row by row: what somebody hostile or a bad day does to rt, and what rt does then. Rows 5, 12, 13 and 15 are
// in failing_calls.cpp, kills.cpp and tests/cli/film.cpp.
#include <tests/faults/faults.hpp>

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <regex>
#include <thread>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

namespace rt::faults {
namespace {

namespace fs = std::filesystem;
using cli_tests::linesOf;
using cli_tests::Outcome;
using cli_tests::RunOptions;

const std::string kHead =
    "rt: 1\nimage: {width: 8, height: 8}\ncamera: {position: [0, -5, 0], look_at: [0, 0, "
    "0], field_of_view: 50deg}\n";

std::string repeated(const std::string& piece, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += piece;
    return text;
}

} // namespace

class Threats : public Faults {
protected:
    /// Ends with `code` and one line that begins so.
    void refused(const std::string& arguments, int exitCode, const std::string& code,
                 const RunOptions& options = {}) const {
        const Outcome o = rt(arguments, options);
        EXPECT_EQ(o.exitCode, exitCode) << arguments << "\n" << o.err;
        EXPECT_NE(o.err.find("error[" + code + "]"), std::string::npos) << arguments << "\n"
                                                                        << o.err;
        EXPECT_LT(o.seconds,
                  20); // 2 on a machine of one's own; hostile_files.cpp holds the CPU time
    }
    void refusedScene(const std::string& text, int exitCode, const std::string& code,
                      const RunOptions& options = {}) const {
        write("bad.yaml", text);
        refused("check bad.yaml", exitCode, code, options);
    }
};

TEST_F(Threats, Threat01YamlBombDepthAndSize) {
    RT_NOT_SANITIZED(
        "its shadow takes more address space than the limit; hostile.cpp has the files");
    RunOptions half; // 512 MiB of address space
    half.memoryLimit = 512ul << 20;
    std::string bomb = "a0: &a0 [" + repeated("x, ", 9) + "x]\n";
    for (int i = 1; i < 10; ++i)
        bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" +
                repeated("*a" + std::to_string(i - 1) + ", ", 9) + "*a" + std::to_string(i - 1) +
                "]\n";
    refusedScene(bomb, 7, "E0712", half);
    refusedScene(repeated("[", 100'000) + repeated("]", 100'000), 7, "E0711", half);
    refusedScene(repeated("{a: ", 20'000), 7, "E0711", half);
    refusedScene(repeated("- ", 5'000) + "x\n", 7, "E0711", half);
    refusedScene("a: &a\n  b: *a\n", 3, "E0358", half);
    refusedScene("k: [1" + repeated(",1", 2'000'000) + "]\n", 7, "E0712", half);
    refusedScene("k: " + std::string(17 << 20, 'x'), 7, "E0710", half);
}

TEST_F(Threats, Threat02SilentYamlMistakes) {
    const struct {
        std::string text, message;
    } cases[] = {
        {kHead + "objets: []\n",
         "bad.yaml:4:1: error[E0301]: the scene has no key 'objets'; did you mean 'objects'?"},
        {kHead + "rt: 1\n",
         "bad.yaml:4:1: error[E0351]: the key 'rt' stands twice in this map, first in line 1"},
        {kHead + "name: \"open\n",
         "bad.yaml:4:7: error[E0352]: the quote \" that opens here is never closed"},
        {kHead + "---\nrt: 1\n",
         "bad.yaml:4:1: error[E0354]: a second document starts here; a scene is one document"},
        {kHead + "name: \xff\n",
         "bad.yaml:4:7: error[E0355]: the byte '\\xff' is no UTF-8; save the file as UTF-8"},
        {kHead + "\tname: 1\n",
         "bad.yaml:4:1: error[E0353]: a tab indents this line; YAML wants spaces"}};
    for (const auto& c : cases) {
        write("bad.yaml", c.text);
        const Outcome o = rt("check bad.yaml");
        EXPECT_EQ(o.exitCode, 3);
        EXPECT_EQ(linesOf(o.err).at(0), c.message);
    }
}

/// Every field is in tests/scene/hostile_values.cpp; here, that the program ends so.
TEST_F(Threats, Threat03NumbersThatAreNone) {
    for (const std::string& field : std::initializer_list<std::string>{
             "objects: [sphere: {radius: @}]", "objects: [sphere: {center: [0, 0, @]}]",
             "materials: {m: {ior: @}}", "materials: {m: {diffuse: @}}",
             "lights: [point: {position: [@, 0, 0]}]", "bounds: {min: [0, 0, 0], max: [1, @, 1]}"})
        for (const std::string& value : std::initializer_list<std::string>{
                 ".nan", ".inf", "-.inf", "1e400", "1e308", "x", "[]", "~"}) {
            std::string text = kHead + field + "\n";
            text.replace(text.find('@'), 1, value);
            write("bad.yaml", text);
            const Outcome o = rt("check bad.yaml");
            EXPECT_EQ(o.exitCode, 3) << text;
            EXPECT_TRUE(
                std::regex_search(o.err, std::regex("^bad\\.yaml:4:\\d+: error\\[E03\\d\\d\\]: ")))
                << o.err;
        }
}

TEST_F(Threats, Threat04PicturesWithoutEnd) {
    const auto sized = [](const std::string& width, const std::string& height) {
        std::string text = kHead;
        return text.replace(text.find("width: 8, height: 8"), 19,
                            "width: " + width + ", height: " + height);
    };
    for (const std::string& side :
         std::initializer_list<std::string>{"46341", "65536", "2147483647", "4294967295"}) {
        write("bad.yaml", sized(side, side));
        const Outcome o = rt("render bad.yaml -o a.pfm");
        EXPECT_EQ(o.exitCode, 7) << o.err;
        EXPECT_NE(o.err.find("error[E0713]"), std::string::npos) << o.err;
        EXPECT_TRUE(kSanitized || o.peakBytes < 100u << 20) << o.peakBytes; // nothing was allocated
    }
    for (const std::string& side : std::initializer_list<std::string>{"-1", "0", "1.5", "1e9"})
        refusedScene(sized(side, "8"), 3, side == "1.5" || side == "1e9" ? "E0307" : "E0306");
    RT_NOT_SANITIZED("its shadow is beyond any --limit-memory; what follows has one");
    write("bad.yaml", sized("65535", "65535"));
    const Outcome o = rt("render bad.yaml -o a.pfm --limit-pixels 4294967295 --limit-memory 100G");
    EXPECT_EQ(o.exitCode, 7);
    EXPECT_NE(
        o.err.find("takes about 309.2 GB of memory, more than the 107.4 GB of --limit-memory"),
        std::string::npos)
        << o.err;
    EXPECT_FALSE(exists("a.pfm"));
}

class Sandbox : public Threats {
protected:
    Sandbox() {
        for (const char* const folder : {"in", "in/deep", "out"})
            fs::create_directories(folder_ / folder);
        write("in/t.ppm", "P6\n1 1\n255\nabc");
        write("in/m.obj", kTriangle);
        write("out/t.ppm", "P6\n1 1\n255\nabc");
        write("out/m.obj", kTriangle);
        write("in/scene.yaml", kHead);
    }
    /// The scene names `file` as a texture, and as a mesh.
    void write(const std::string& name, const std::string& text) const {
        Faults::write(name, text);
    }
    Outcome texture(const std::string& file, const std::string& options) const {
        write("in/bad.yaml",
              kHead + "textures: {t: {image: {file: '" + file + "'}}}\nbackground: {texture: t}\n");
        return rt("check in/bad.yaml -q " + options);
    }
    Outcome mesh(const std::string& file, const std::string& options) const {
        write("in/bad.yaml", kHead + "objects: [mesh: {file: '" + file + "', loader: openmesh}]\n");
        return rt("check in/bad.yaml -q " + options);
    }
    const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n";
};

TEST_F(Sandbox, Threat06ReadsStayInTheFolder) {
    fs::create_symlink("../out/m.obj", folder_ / "in/link.obj");
    fs::create_symlink("../out", folder_ / "in/folder");
    fs::create_symlink("m.obj", folder_ / "in/near.obj");
    ASSERT_EQ(::mkfifo((folder_ / "in/pipe.obj").c_str(), 0600), 0);
    const std::string absolute = (folder_ / "out/m.obj").string();
    for (const std::string& file : std::initializer_list<std::string>{
             std::string("../out/m.obj"), std::string("deep/../../out/m.obj"), absolute,
             std::string("link.obj"), std::string("folder/m.obj"),
             std::string("/proc/self/environ"), std::string("/etc/passwd")}) {
        const Outcome o = mesh(file, "--sandbox");
        EXPECT_EQ(o.exitCode, 4) << file;
        EXPECT_NE(o.err.find("error[E0404]"), std::string::npos) << o.err;
        EXPECT_EQ(texture(file, "--sandbox").exitCode, 4) << file;
    }
    EXPECT_NE(mesh("nosuch.obj", "--sandbox").err.find("E0401"), std::string::npos);
    EXPECT_NE(mesh("../nosuch.obj", "--sandbox").err.find("E0404"), std::string::npos)
        << "tells what exists outside";
    // What is allowed: its own folder, links and '..' within it, and --allow-read.
    const auto expectRead = [](const Outcome& o) {
        EXPECT_EQ(o.exitCode, 0) << o.err;
        // ThreadSanitizer's symbolizer cannot start in the sandbox, and says so.
        if (!kThreadSanitized) {
            EXPECT_EQ(o.err, "");
        }
    };
    for (const std::string& file :
         std::initializer_list<std::string>{"m.obj", "deep/../m.obj", "near.obj"}) {
        SCOPED_TRACE(file);
        expectRead(mesh(file, "--sandbox"));
    }
    expectRead(texture("t.ppm", "--sandbox"));
    expectRead(mesh("link.obj", "--sandbox --allow-read out"));
    expectRead(
        texture(absolute.substr(0, absolute.rfind('/')) + "/t.ppm", "--sandbox --allow-read out"));
    // Without it every regular file, and only regular files.
    expectRead(mesh("link.obj", ""));
    for (const std::string& file :
         std::initializer_list<std::string>{"pipe.obj", "/dev/zero", "deep"})
        for (const std::string& options : std::initializer_list<std::string>{"", "--sandbox"})
            for (const Outcome& o : {mesh(file, options), texture(file, options)}) {
                EXPECT_EQ(o.exitCode, 4) << file;
                EXPECT_TRUE(std::regex_search(o.err, std::regex("error\\[E040[34]\\]"))) << o.err;
            }
}

/// What a mesh names itself is read by the loader, whom the kernel holds to the folders.
TEST_F(Sandbox, Threat06ALoaderStaysInTheFolder) {
    write("out/secret.mtl", "newmtl a\nKd 1 1 1\n");
    for (const std::string& library : std::initializer_list<std::string>{
             "../out/secret.mtl", "/dev/zero", "../../../../../../dev/zero"}) {
        write("in/lib.obj", "mtllib " + library + "\n" + kTriangle);
        const Outcome o = mesh("lib.obj", "--sandbox");
        EXPECT_EQ(o.exitCode, 0) << o.err; // noted, not read
        EXPECT_LT(o.seconds, 20);
    }
}

/// The frames of a film are rt's own: --resume reads them wherever the command line puts them, but not what their names are linked to.
TEST_F(Sandbox, Threat06AFilmResumesFromItsOwnFolder) {
    write("in/film.yaml", cli_tests::kFilm);
    const std::string line = "render in/film.yaml --size 8x6 --sandbox -o out/f_%04d.pfm";
    ASSERT_EQ(rt(line).exitCode, 0);
    const auto inode = [&](const char* name) {
        struct stat status {};
        EXPECT_EQ(::stat((folder_ / name).c_str(), &status), 0) << name;
        return status.st_ino;
    };
    fs::rename(folder_ / "out/f_0001.pfm", folder_ / "elsewhere.pfm");
    fs::create_symlink("../elsewhere.pfm", folder_ / "out/f_0001.pfm");
    const auto own = inode("out/f_0000.pfm"), linked = inode("elsewhere.pfm");
    const Outcome o = rt(line + " --resume");
    EXPECT_EQ(o.exitCode, 0) << o.err;
    EXPECT_EQ(inode("out/f_0000.pfm"), own) << "drawn again";
    EXPECT_NE(inode("elsewhere.pfm"), linked) << "read through the link";
}

TEST_F(Sandbox, Threat06ALinkThatIsSwapped) {
    std::atomic<bool> stop{false};
    std::thread swapper([&] { // in/now.obj is now the file inside, now the one outside
        for (int i = 0; !stop; ++i) {
            std::error_code ignored;
            fs::remove(folder_ / "in/next.obj", ignored);
            fs::create_symlink(i % 2 ? "m.obj" : "../out/two.obj", folder_ / "in/next.obj",
                               ignored);
            fs::rename(folder_ / "in/next.obj", folder_ / "in/now.obj", ignored);
        }
    });
    write("out/two.obj", kTriangle + "v 9 9 9\nf 1 2 4\n");
    write("in/race.yaml", kHead + "objects: [mesh: {file: now.obj}]\n");
    int inside = 0, refused = 0;
    for (int i = 0; i < (isFull() ? 1000 : 40); ++i) {
        const Outcome o = rt("info in/race.yaml -q --sandbox");
        if (o.exitCode == 0) {
            ++inside;
            EXPECT_NE(o.out.find("1 triangle,"), std::string::npos) << o.out;
        } else if (o.err.find("E0401") == std::string::npos) {
            ++refused;
            EXPECT_EQ(o.exitCode, 4) << o.err;
        }
    }
    stop = true;
    swapper.join();
    std::printf("%d times the file inside, %d times refused\n", inside, refused);
    EXPECT_GT(inside + refused, 0);
}

TEST_F(Threats, Threat06WritesStayBelowTheCurrentFolder) {
    fs::create_directories(folder_ / "here");
    fs::create_directories(folder_ / "elsewhere");
    fs::create_symlink("../elsewhere", folder_ / "here/link");
    write("elsewhere/kept.png", "old");
    fs::create_symlink("../elsewhere/kept.png", folder_ / "here/picture.png");
    const auto named = [&](const std::string& file) {
        std::string text = kHead;
        write("here/s.yaml", text.replace(text.find("width"), 0, "file: '" + file + "', "));
        RunOptions options;
        options.program = "/bin/sh";
        return run({"-c", "cd here && exec " RT_BINARY " render s.yaml"}, options);
    };
    for (const std::string& file :
         std::initializer_list<std::string>{"../a.png", "a/../../a.png", "/tmp/rt-threat.png"})
        EXPECT_EQ(named(file).exitCode, 3) << file;
    for (const std::string& file :
         std::initializer_list<std::string>{"link/a.png", "picture.png"}) {
        const Outcome o = named(file);
        EXPECT_EQ(o.exitCode, 6) << file;
        EXPECT_NE(o.err.find("error[E0615]"), std::string::npos) << o.err;
    }
    EXPECT_EQ(read("elsewhere/kept.png"), "old");
    EXPECT_EQ(named("fine.png").exitCode, 0);
}

TEST_F(Sandbox, Threat07MeshesThatFooledTheLibrary) {
    const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (const std::string& text : std::initializer_list<std::string>{
             "f /1\n", "f 1 2 99999999\n", "f 0 1 2\n", "f 4294967297 2 3\n",
             "v nan 0 0\nf 1 2 3\n", "v 0,5 0 0\nf 1 2 3\n", "v 1e400 0 0\nf 1 2 3\n", "f 1 2\n",
             "f -9 1 2\n", "f 1 2 x\n", ""}) {
        write("in/bad.obj", v + text);
        const Outcome o = mesh("bad.obj", "");
        EXPECT_EQ(o.exitCode, 4) << text << o.err;
        EXPECT_EQ(o.signal, 0);
        EXPECT_TRUE(std::regex_search(o.err, std::regex("error\\[E0420\\]: .*bad\\.obj"))) << o.err;
    }
    write("in/bad.obj", v + "f 1 \\\n2 3\n"); // legal, and lost by the library
    EXPECT_EQ(mesh("bad.obj", "").err, "");
}

TEST_F(Sandbox, Threat08TexturesThatExplode) {
    const auto be32 = [](unsigned n) {
        return std::string{char(n >> 24), char(n >> 16), char(n >> 8), char(n)};
    };
    const std::string png = "\x89PNG\r\n\x1a\n" + be32(13) + "IHDR" + be32(20000) + be32(20000) +
                            std::string("\x08\x02\0\0\0", 5);
    const struct {
        std::string bytes;
        int exitCode;
    } cases[] = {{png + be32(0), 7},
                 {"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n", 7},
                 {"P6 4294967295 4294967295 255\n", 7},
                 {"PF\n100000 100000\n-1.0\n", 7},
                 {"PF\n1 1\n-1.0\n" + std::string("\0\0\xc0\x7f\0\0\xc0\x7f\0\0\xc0\x7f", 12), 4},
                 {"GIF89a\1\0\1\0", 4},
                 {std::string("II*\0\x08\0\0\0", 8), 4},
                 {"some text", 4},
                 {"", 4},
                 {"P6 4 4 255\nabc", 4}};
    for (const auto& c : cases) {
        write("in/bad.png", c.bytes);
        const Outcome o = texture("bad.png", "");
        EXPECT_EQ(o.exitCode, c.exitCode) << o.err;
        EXPECT_TRUE(std::regex_search(o.err, std::regex("^in/bad\\.yaml:4:\\d+: error\\[E0")))
            << o.err;
        EXPECT_TRUE(kSanitized || o.peakBytes < 300u << 20) << o.peakBytes;
    }
}

TEST_F(Threats, Threat09PluginNames) {
    for (const std::string& name :
         std::initializer_list<std::string>{"../../evil", "a/b", "evil.so", "Evil", "'evil\\0'",
                                            "'" + std::string(1'000, 'e') + "'"})
        refusedScene(kHead + "objects: [" + name + ": {}]\n", 5, "E0523");
    refusedScene(kHead + "objects: [" + std::string(100'000, 'e') + ": {}]\n", 3,
                 "E0352"); // longer than YAML has a key
    // No search path of the system's is used, and no folder of the scene's.
    fs::copy_file(fs::path(RT_TEST_MODULES) / "constructor/dot.rtplugin.so",
                  folder_ / "dot.rtplugin.so");
    RunOptions hijack;
    hijack.environment = {"LD_LIBRARY_PATH=:", "RT_PLUGIN_PATH=::"};
    write("bad.yaml", kHead + "objects: [dot: {}]\n");
    EXPECT_EQ(rt("check bad.yaml", hijack).exitCode, 5);
}

/// Who may not name plugins to somebody else's rt cannot do it by the environment either.
TEST_F(Threats, Threat09ASetuidProgramIgnoresThePath) {
    RT_NOT_SANITIZED("a setuid program does not see its options");
    if (::geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
    struct statvfs place {};
    ASSERT_EQ(::statvfs(folder_.c_str(), &place), 0);
    if (place.f_flag & ST_NOSUID) GTEST_SKIP() << "no program is setuid here";
    constexpr unsigned kNobody = 65534;
    const fs::path own = folder_ / "rt";
    fs::copy_file(RT_BINARY, own);
    RunOptions options;
    options.program = own.string();
    options.environment = {"RT_PLUGIN_PATH=" RT_TEST_MODULES "/good"};
    EXPECT_NE(rt("plugins", options).out.find("dot"), std::string::npos);
    fs::permissions(folder_, fs::perms{0755});
    ASSERT_EQ(::chown(own.c_str(), kNobody, kNobody), 0);
    ASSERT_EQ(::chmod(own.c_str(), 04755), 0); // after chown, which takes the bit away
    const Outcome o = rt("plugins", options);
    EXPECT_EQ(o.exitCode, 0) << o.err;
    EXPECT_EQ(o.out.find("dot"), std::string::npos) << o.out;
}

TEST_F(Threats, Threat10ModulesThatAreNone) {
    write("bad.yaml", kHead + "objects: [dot: {}]\n");
    const std::string module = [&] {
        std::ifstream file(fs::path(RT_TEST_MODULES) / "good/dot.rtplugin.so", std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(file), {});
    }();
    ASSERT_GT(module.size(), 1000u);
    const auto refusedModule = [&](const std::string& bytes) {
        write("modules/dot.rtplugin.so", bytes);
        const Outcome o = rt("check bad.yaml --plugin-dir modules");
        EXPECT_EQ(o.exitCode, 5) << o.err;
        EXPECT_NE(o.err.find("dot.rtplugin.so was refused"), std::string::npos) << o.err;
    };
    for (std::size_t i = 0; i < 50; ++i) refusedModule(module.substr(0, module.size() * i / 50));
    std::string narrow = module;
    narrow[4] = 1; // ELFCLASS32
    refusedModule(narrow);
    for (const std::string& kind : std::initializer_list<std::string>{
             "major_0", "major_2", "minor_newer", "layout", "magic", "size", "no_entry"}) {
        const Outcome o = rt("check bad.yaml --plugin-dir " RT_TEST_MODULES "/" + kind);
        EXPECT_EQ(o.exitCode, 5) << kind;
        EXPECT_NE(o.err.find("was refused"), std::string::npos) << o.err;
    }
}

TEST_F(Threats, Threat11PluginsThatThrow) {
    for (const std::string& act : std::initializer_list<std::string>{"throw", "throw int"}) {
        write("bad.yaml", kHead + "objects: [rude: {act: " + act + "}]\n");
        const Outcome o = rt("render bad.yaml -o a.pfm --plugin-dir " RT_TEST_MODULES "/rude");
        EXPECT_EQ(o.exitCode, 5);
        EXPECT_NE(o.err.find("bad.yaml:4:11: error[E0531]: shape 'rude': it threw an exception"),
                  std::string::npos)
            << o.err;
        EXPECT_FALSE(exists("a.pfm"));
    }
}

TEST_F(Threats, Threat11PluginsThatAskForTooMuchMemory) {
    RT_NOT_SANITIZED("its operator new ends the program");
    write("a.pfm", "old");
    write("bad.yaml", kHead + "objects: [rude: {act: allocate}]\n");
    const Outcome o = rt("render bad.yaml -o a.pfm --plugin-dir " RT_TEST_MODULES "/rude");
    EXPECT_EQ(o.exitCode, 5) << o.err;
    EXPECT_NE(o.err.find("bad.yaml:4:11: error[E0531]: shape 'rude': "), std::string::npos)
        << o.err;
    EXPECT_EQ(read("a.pfm"), "old");
}

/// Each kind of end, in each kind of call: tests/cli/crashes.cpp.
TEST_F(Threats, Threat11PluginsThatCrash) {
    write("a.pfm", "old");
    for (const std::string& call : std::initializer_list<std::string>{"lower", "intersect"})
        for (const std::string& act :
             std::initializer_list<std::string>{"address", "abort", "exit", "overflow"}) {
            write("bad.yaml", kHead + "objects: [crasher: {" + call + ": " + act + "}]\n");
            const Outcome o =
                rt("render bad.yaml -o a.pfm --plugin-dir " RT_TEST_MODULES "/crasher");
            EXPECT_EQ(o.exitCode, 5) << o.err;
            EXPECT_NE(o.err.find("'crasher': its code ended in "), std::string::npos) << o.err;
            EXPECT_EQ(read("a.pfm"), "old");
        }
}

/// One that never returns: the second signal ends rt in any case.
TEST_F(Threats, Threat11PluginsThatHang) {
    if (kThreadSanitized)
        GTEST_SKIP() << "ThreadSanitizer keeps a signal until the thread calls something it "
                        "intercepts: one that hangs never does";
    RunOptions options;
    options.whileRunning = [](int child) {
        std::this_thread::sleep_for(std::chrono::seconds(1));
        for (int i = 0; i < 2; ++i) {
            ::kill(child, SIGINT);
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
    };
    write("bad.yaml", kHead + "objects: [crasher: {lower: loop}]\n");
    const Outcome o =
        rt("render bad.yaml -o a.pfm --plugin-dir " RT_TEST_MODULES "/crasher", options);
    EXPECT_TRUE(o.exitCode == 130 || o.signal == SIGINT) << o.exitCode << o.err;
    EXPECT_LT(o.seconds, 30);
    EXPECT_EQ(files(), std::vector<std::string>{"bad.yaml"});
}

TEST_F(Threats, Threat12AFullDiskSaysWhatItNeeds) {
    write("a.pfm", "old");
    const auto [o, struck] = runFailing("render scene.yaml -o a.pfm", "write", 1, ENOSPC);
    ASSERT_TRUE(struck);
    EXPECT_EQ(o.exitCode, 6);
    EXPECT_TRUE(std::regex_search(
        o.err,
        std::regex("^a\\.pfm: error\\[E0605\\]: cannot be written: No space left on device "
                   "\\(36878 bytes needed, \\d+ free\\); what was there before is untouched")))
        << o.err;
    EXPECT_EQ(read("a.pfm"), "old");
    const Outcome warned = runFailing("render scene.yaml -o a.pfm", "space", 1, 0).outcome;
    EXPECT_EQ(warned.exitCode, 0);
    EXPECT_EQ(warned.err, "a.pfm: warning: needs 36864 bytes, and its disk has 0 left\n");
}

TEST_F(Threats, Threat14SignalsAtAnyTime) {
    const int count = isFull() ? 100 : 12;
    for (int i = 0; i < count; ++i) {
        const int signal = i % 2 ? SIGINT : SIGTERM;
        std::chrono::steady_clock::time_point sent;
        RunOptions options;
        options.whileRunning = [&](int child) {
            std::this_thread::sleep_for(std::chrono::milliseconds(7 * i));
            sent = std::chrono::steady_clock::now();
            ::kill(child, signal);
        };
        write("a.pfm", "old");
        const Outcome o =
            rt("render scene.yaml --size 800x600 --antialias grid=3 -o a.pfm", options);
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - sent).count();
        // Before main has begun the system itself ends it.
        const bool early = o.signal == signal;
        EXPECT_TRUE(early || o.exitCode == 128 + signal || o.exitCode == 0) << o.exitCode << o.err;
        if (o.exitCode != 0) {
            EXPECT_LT(seconds, 2);
            EXPECT_EQ(read("a.pfm"), "old");
        }
        for (const std::string& file : files()) EXPECT_FALSE(file.starts_with('.')) << file;
    }
}

TEST_F(Threats, Threat16TwoRendersOneOutput) {
    RunOptions options;
    Outcome second;
    options.whileRunning = [&](int child) {
        for (int i = 0; i < 600 && !exists(".a.pfm.lock"); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        second = rt("render scene.yaml -o a.pfm");
        EXPECT_NE(second.err.find("a.pfm: error[E0608]: is being written by process " +
                                  std::to_string(child) + " since "),
                  std::string::npos)
            << second.err;
        ::kill(child, SIGINT);
    };
    rt("render scene.yaml --size 3000x2000 --antialias grid=16 -o a.pfm", options);
    EXPECT_EQ(second.exitCode, 6);
    EXPECT_FALSE(exists(".a.pfm.lock"));
    // What a killed one left is no lock, and is swept up.
    write(".a.pfm.lock", "process 1 since yesterday");
    write(".a.pfm.2147483646.tmp", "half");
    EXPECT_EQ(rt("render scene.yaml -o a.pfm").exitCode, 0);
    EXPECT_EQ(files(), (std::vector<std::string>{"a.partial.pfm", "a.pfm"}));
    // Eight at once: one at a time writes, the others say so, the picture is whole.
    const std::string complete = read("a.pfm");
    std::atomic<int> wrote{0}, waited{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; ++i)
        threads.emplace_back([&] {
            const Outcome o = rt("render scene.yaml -o a.pfm");
            if (o.exitCode == 0) ++wrote;
            if (o.exitCode == 6) ++waited;
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrote + waited, 8);
    EXPECT_GT(wrote, 0);
    EXPECT_EQ(read("a.pfm"), complete);
    EXPECT_EQ(files(), (std::vector<std::string>{"a.partial.pfm", "a.pfm"}));
}

TEST_F(Threats, Threat17ThreadsMakeNoDifference) {
    ASSERT_EQ(rt("render scene.yaml -o 1.pfm -t 1 --antialias grid=2").exitCode, 0);
    for (const std::string& threads : std::initializer_list<std::string>{"2", "3", "8", "64"}) {
        ASSERT_EQ(rt("render scene.yaml -o n.pfm --antialias grid=2 -t " + threads).exitCode, 0);
        EXPECT_EQ(read("n.pfm"), read("1.pfm")) << threads;
    }
}

TEST_F(Threats, Threat18SamplesThatAreNoNumber) {
    write("bad.yaml", kHead + "textures: {t: {nan_texture: {}}}\nbackground: {texture: t}\n");
    const std::string line =
        "render bad.yaml -o a.pfm --plugin-dir " RT_TEST_MODULES "/nan_texture";
    Outcome o = rt(line);
    EXPECT_EQ(o.exitCode, 0);
    EXPECT_EQ(o.err, "bad.yaml: warning: 64 samples were not a finite number and are black\n");
    EXPECT_EQ(read("a.pfm").substr(12), std::string(8 * 8 * 12, '\0'));
    o = rt(line + " --strict");
    EXPECT_EQ(o.exitCode, 70);
    EXPECT_EQ(o.err, "rt render: error: 64 samples were not a finite number and are magenta\n");
    EXPECT_EQ(read("a.pfm").substr(12, 12), std::string("\0\0\x80\x3f\0\0\0\0\0\0\x80\x3f", 12));
}

} // namespace rt::faults
