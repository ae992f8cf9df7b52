// Every refusal of a module: its message word for word, and that none of its code has run.
#include <core/plugin_host/catalog.hpp>
#include <core/plugin_host/module.hpp>
#include <core/plugin_host/stamp.hpp>
#include <tests/plugin_host/temporary_folder.hpp>

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <random>

namespace rt::plugin_host {
namespace {

namespace fs = std::filesystem;
using scene::TypeKind;
using test::TemporaryFolder;

const fs::path kModules = RT_TEST_MODULES;
const fs::path kGood = kModules / "good/dot.rtplugin.so";

/// Why `path` is refused, with its own folder trusted; "" if it is not.
std::string whyRefused(const fs::path& path) {
    const auto result = openModule(path, {fs::canonical(path.parent_path())});
    const auto* why = std::get_if<std::string>(&result);
    return why != nullptr ? *why : "";
}

std::string whyRefused(const char* testCase) {
    return whyRefused(kModules / testCase / "dot.rtplugin.so");
}

std::string reasonOf(const std::variant<scene::TypeRows, scene::TypeRefusal>& found) {
    const auto* refusal = std::get_if<scene::TypeRefusal>(&found);
    return refusal != nullptr ? refusal->reason : "";
}

TEST(Load, OpensAPluginWrittenInC) {
    const auto result = openModule(kGood, {fs::canonical(kGood.parent_path())});
    ASSERT_TRUE(std::holds_alternative<const rt_module*>(result)) << std::get<std::string>(result);
    const rt_module& module = *std::get<const rt_module*>(result);
    EXPECT_STREQ(module.name, "dot");
    EXPECT_EQ(module.shape->param_count, 1u);
}

TEST(Load, OpensWhatTheOtherCompilerBuilt) {
    if (!fs::exists(kModules / "clang"))
        GTEST_SKIP() << "clang was not there when the build was configured";
    EXPECT_EQ(whyRefused("clang"), "");
    EXPECT_EQ(whyRefused(kModules / "clang/misfit.rtplugin.so"), "");
}

TEST(Load, RefusesAnotherMajor) {
    EXPECT_EQ(whyRefused("major_0"),
              "it was built for plugin ABI 0.1 and this rt speaks 1.1; rebuild it against this rt");
    EXPECT_EQ(whyRefused("major_2"),
              "it was built for plugin ABI 2.1 and this rt speaks 1.1; rebuild it against this rt");
}

TEST(Load, RefusesANewerMinor) {
    EXPECT_EQ(whyRefused("minor_newer"),
              "it was built for plugin ABI 1.2 and this rt speaks only 1.1; update rt, or rebuild "
              "it against this rt");
}

TEST(Load, RefusesAnotherLayout) {
    EXPECT_EQ(
        whyRefused("layout"),
        "its structs are laid out differently (a modified rt/plugin.h, or packing flags); rebuild "
        "it against this rt");
}

TEST(Load, RefusesAnotherMagicAndSize) {
    EXPECT_EQ(whyRefused("magic"), "its rt_plugin_entry is not an rt_module");
    EXPECT_EQ(whyRefused("size"), "its rt_plugin_entry is not an rt_module");
}

TEST(Load, RunsNoCodeOfWhatItRefuses) {
    unsetenv("RT_TEST_CONSTRUCTOR_RAN");
    for (const char* testCase : {"major_2", "minor_newer", "layout", "magic", "size"})
        EXPECT_NE(whyRefused(testCase), "");
    EXPECT_EQ(getenv("RT_TEST_CONSTRUCTOR_RAN"), nullptr);
    EXPECT_EQ(whyRefused("constructor"), ""); // or the line above would prove nothing
    EXPECT_NE(getenv("RT_TEST_CONSTRUCTOR_RAN"), nullptr);
}

TEST(Load, RefusesALibraryThatIsNoPlugin) {
    EXPECT_EQ(whyRefused("no_entry"), "it does not export rt_plugin_entry");
}

TEST(Load, RefusesABorrowedEntry) {
    EXPECT_EQ(whyRefused("borrower"),
              "it borrows rt_plugin_entry from another library instead of defining it");
}

TEST(Load, RefusesAModuleThatLacksAFunction) {
    EXPECT_EQ(whyRefused("needs"), "it cannot be opened (" +
                                       (kModules / "needs/dot.rtplugin.so").string() +
                                       ": undefined symbol: rt_test_nobody_defines_this)");
}

TEST(Load, RefusesAnotherName) {
    EXPECT_EQ(whyRefused("other_name"), "its file name says 'dot' and it calls itself 'spot'");
}

TEST(Load, RefusesAModuleThatOffersNothing) {
    EXPECT_EQ(whyRefused("nothing"),
              "it must offer exactly one of a shape, a texture and a loader");
    EXPECT_EQ(whyRefused("shape_size"), "its rt_plugin_entry is incomplete");
}

TEST(Load, RefusesRowsThatBreakTheRules) {
    EXPECT_EQ(whyRefused("row_twice"), "its parameter 'radius' exists twice");
    EXPECT_EQ(whyRefused("row_limits"), "its parameter 'radius' has limits that no number meets");
    EXPECT_EQ(whyRefused("row_type"), "its parameter 'radius' has an unknown type");
    EXPECT_EQ(whyRefused("row_unit"), "its parameter 'radius' has an unknown unit");
    EXPECT_EQ(whyRefused("row_name"), "the name of its parameter 1 is not snake_case");
    EXPECT_EQ(whyRefused("row_choice"),
              "its parameter 'radius' has choices without being a choice, or none");
    EXPECT_EQ(whyRefused("row_loads"), "its parameter 'radius' cannot be loaded");
    EXPECT_EQ(whyRefused("row_default"),
              "its parameter 'radius' has a default that must be >= 0 and <= 1 (got 2)");
}

TEST(Load, RefusesWhatIsNoModuleFile) {
    const TemporaryFolder folder;
    EXPECT_EQ(whyRefused(folder.write("empty.rtplugin.so", "")), "it is not an ELF file");
    EXPECT_EQ(
        whyRefused(folder.write("text.rtplugin.so",
                                "This is not a shared library at all, but text of some length.\n")),
        "it is not an ELF file");
    const std::string good = test::readFile(kGood);
    std::string bytes = good;
    bytes[4] = 1; // EI_CLASS: 32 bit
    EXPECT_EQ(whyRefused(folder.write("small.rtplugin.so", bytes)),
              "it is not built for this machine (64-bit x86-64)");
    bytes = good;
    bytes[18] = 40; // e_machine: ARM
    EXPECT_EQ(whyRefused(folder.write("arm.rtplugin.so", bytes)),
              "it is not built for this machine (64-bit x86-64)");
    bytes = good;
    bytes[16] = 2; // e_type: an executable
    EXPECT_EQ(whyRefused(folder.write("program.rtplugin.so", bytes)), "it is not a shared library");
    fs::create_directory(folder / "folder.rtplugin.so");
    EXPECT_EQ(whyRefused(folder / "folder.rtplugin.so"), "it is not a regular file");
    ASSERT_EQ(mkfifo((folder / "pipe.rtplugin.so").c_str(), 0600), 0);
    EXPECT_EQ(whyRefused(folder / "pipe.rtplugin.so"),
              "it is not a regular file"); // and does not wait for a writer
    EXPECT_EQ(whyRefused(folder / "missing.rtplugin.so"),
              "it cannot be read (No such file or directory)");
}

TEST(Load, RefusesEveryTruncation) {
    const TemporaryFolder folder;
    const std::string good = test::readFile(kGood);
    constexpr int kCuts = 200;
    for (int i = 0; i < kCuts; ++i) {
        const std::size_t length = good.size() * static_cast<std::size_t>(i) / kCuts;
        const std::string why = whyRefused(folder.write("dot.rtplugin.so", good.substr(0, length)));
        EXPECT_EQ(why, length < 64 ? "it is not an ELF file" : "it is truncated")
            << length << " of " << good.size();
    }
}

TEST(Load, SurvivesDamage) { // reads of the stamp only: what passes them is the user's to trust
    const TemporaryFolder folder;
    const std::string good = test::readFile(kGood);
    std::mt19937 random(1);
    int refused = 0;
    for (int i = 0; i < 1000; ++i) {
        std::string bytes = good;
        const std::size_t reach = i % 2 ? 0x400 : bytes.size(); // headers, or anywhere
        for (int k = 0; k < 1 + i % 7; ++k) bytes[random() % reach] = static_cast<char>(random());
        const fs::path path = folder.write("dot.rtplugin.so", bytes);
        const int fd = open(path.c_str(), O_RDONLY);
        ASSERT_GE(fd, 0);
        refused += std::holds_alternative<std::string>(readStamp(fd));
        close(fd);
    }
    EXPECT_GT(refused, 200);
    EXPECT_LT(refused, 1000); // else the damage has never reached beyond the first check
}

TEST(Load, RefusesWhatOthersMayChange) {
    const TemporaryFolder folder;
    const fs::path path = folder.write("dot.rtplugin.so", test::readFile(kGood));
    EXPECT_EQ(whyRefused(path), "");
    fs::permissions(path, fs::perms::others_write, fs::perm_options::add);
    EXPECT_EQ(whyRefused(path), "other users may write it; chmod go-w it");
    fs::permissions(path, fs::perms::others_write, fs::perm_options::remove);
    fs::permissions(folder.path(), fs::perms::others_write, fs::perm_options::add);
    EXPECT_EQ(whyRefused(path),
              "other users may write its folder; chmod go-w " + folder.path().string());
    fs::permissions(folder.path(), fs::perms::others_write, fs::perm_options::remove);
    if (geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
    ASSERT_EQ(chown(path.c_str(), 4242, 4242), 0);
    EXPECT_EQ(whyRefused(path), "it belongs to another user (uid 4242)");
}

TEST(Load, RefusesALinkOutOfThePluginFolders) {
    const TemporaryFolder folder;
    const fs::path outside = folder.write("elsewhere/dot.rtplugin.so", test::readFile(kGood));
    fs::create_directory(folder / "plugins");
    fs::create_symlink(outside, folder / "plugins/dot.rtplugin.so");
    EXPECT_EQ(whyRefused(folder / "plugins/dot.rtplugin.so"),
              "it is a link that leaves the plugin folders, to " + outside.string());
    fs::create_symlink(folder / "elsewhere", folder / "plugins/deeper");
    const auto deeper = openModule(folder / "plugins/deeper/dot.rtplugin.so", {folder / "plugins"});
    EXPECT_EQ(std::get<std::string>(deeper),
              "it is a link that leaves the plugin folders, to " + outside.string());
}

TEST(Load, AcceptsALinkInsideThePluginFolders) {
    const TemporaryFolder folder;
    const fs::path real = folder.write("1.0/dot.rtplugin.so", test::readFile(kGood));
    fs::create_symlink(real, folder / "dot.rtplugin.so");
    EXPECT_EQ(whyRefused(folder / "dot.rtplugin.so"), "");
}

TEST(Load, RefusesNamesThatAreNone) {
    EXPECT_TRUE(isTypeName("sphere_2"));
    EXPECT_TRUE(isTypeName(std::string(64, 'a')));
    for (const std::string name :
         {"", "Sphere", "2d", "a-b", "a/b", "../evil", "evil.so", "a b", "_a"})
        EXPECT_FALSE(isTypeName(name)) << name;
    EXPECT_FALSE(isTypeName(std::string_view("a\0b", 3)));
    EXPECT_FALSE(isTypeName(std::string(65, 'a')));
    const TemporaryFolder folder;
    EXPECT_EQ(whyRefused(folder.write("Dot.rtplugin.so", test::readFile(kGood))),
              "the name of a type is [a-z][a-z0-9_]*, at most 64 characters");
}

// ---- the catalog -------------------------------------------------------------------------------------------

TEST(Catalog, FindsTypesByFileNameAndOpensOnlyWhatIsNamed) {
    const TemporaryFolder folder;
    folder.write("dot.rtplugin.so", test::readFile(kGood));
    folder.write("broken.rtplugin.so", "no module");
    folder.write("notes.txt", "no plugin");
    Catalog catalog({folder.path()});
    EXPECT_EQ(catalog.names(TypeKind::shape), (std::vector<std::string>{"broken", "dot"}));
    EXPECT_TRUE(catalog.opened().empty());
    const auto found = catalog.find(TypeKind::shape, "dot");
    ASSERT_TRUE(std::holds_alternative<scene::TypeRows>(found)) << reasonOf(found);
    EXPECT_STREQ(std::get<scene::TypeRows>(found).rows[0].name, "radius");
    ASSERT_EQ(catalog.opened().size(), 1u);
    EXPECT_EQ(catalog.opened()[0].name, "dot");
    EXPECT_EQ(catalog.names(TypeKind::texture),
              (std::vector<std::string>{"broken"})); // known by now to be no texture
}

TEST(Catalog, QuotesARefusalToWhoAsksForTheType) {
    const TemporaryFolder folder;
    const fs::path path = folder.write(
        "dot.rtplugin.so", "no module at all, but longer than an ELF header would be: text.......");
    Catalog catalog({folder.path(), "/nowhere"});
    const std::string expected = "shape 'dot' cannot be used: " + path.string() +
                                 " was refused: it is not an ELF file (searched " +
                                 folder.path().string() + ", /nowhere (no such folder))";
    EXPECT_EQ(reasonOf(catalog.find(TypeKind::shape, "dot")), expected);
    folder.write("dot.rtplugin.so", test::readFile(kGood));
    EXPECT_EQ(reasonOf(catalog.find(TypeKind::shape, "dot")),
              expected); // remembered, not tried again
}

TEST(Catalog, SaysWhatItSearched) {
    Catalog none({});
    EXPECT_EQ(reasonOf(none.find(TypeKind::texture, "wood")),
              "there is no texture 'wood' (no plugin folder was searched)");
    const TemporaryFolder folder;
    Catalog one({folder.path()});
    EXPECT_EQ(reasonOf(one.find(TypeKind::shape, "blob")),
              "there is no shape 'blob' (searched " + folder.path().string() + ")");
    EXPECT_EQ(reasonOf(one.find(TypeKind::shape, "../evil")),
              "shape '../evil' cannot exist: the name of a type is [a-z][a-z0-9_]*, at most 64 "
              "characters");
}

TEST(Catalog, DoesNotTakeAShapeForATexture) {
    const fs::path folder = fs::canonical(kGood.parent_path());
    Catalog catalog({folder});
    EXPECT_EQ(reasonOf(catalog.find(TypeKind::texture, "dot")),
              "there is no texture 'dot': 'dot' is a shape (" +
                  (folder / "dot.rtplugin.so").string() + ")");
}

TEST(Catalog, RefusesANameThatTwoModulesClaim) {
    const TemporaryFolder folder;
    const std::string good = test::readFile(kGood);
    const fs::path first = folder.write("a/dot.rtplugin.so", good),
                   second = folder.write("b/dot.rtplugin.so", good);
    Catalog catalog({folder / "a", folder / "b"});
    EXPECT_EQ(reasonOf(catalog.find(TypeKind::shape, "dot")),
              "shape 'dot' cannot be used: two modules claim the name 'dot': " + first.string() +
                  " and " + second.string() + "; remove one (searched " + (folder / "a").string() +
                  ", " + (folder / "b").string() + ")");
    Catalog same({folder / "a", folder / "b/../a"}); // one folder, named twice
    EXPECT_EQ(reasonOf(same.find(TypeKind::shape, "dot")), "");
}

TEST(Catalog, ListsBrokenModulesWithTheirReason) {
    const TemporaryFolder folder;
    folder.write("dot.rtplugin.so", test::readFile(kGood));
    const fs::path broken = folder.write("bad.rtplugin.so", "");
    const fs::path wrong = folder.write("Wrong-Name.rtplugin.so", "");
    Catalog catalog({folder.path()});
    const auto all = catalog.openAll();
    ASSERT_EQ(all.size(), 3u);
    EXPECT_EQ(all[0].refusal,
              wrong.string() +
                  " was refused: the name of a type is [a-z][a-z0-9_]*, at most 64 characters");
    EXPECT_EQ(all[1].refusal, broken.string() + " was refused: it is not an ELF file");
    EXPECT_NE(all[2].module, nullptr);
}

TEST(Catalog, KnowsTheLoaderOfASuffix) {
    Catalog catalog({});
    EXPECT_EQ(catalog.loaderFor("obj"), "openmesh");
    EXPECT_EQ(catalog.loaderFor("ply"), "openmesh");
    EXPECT_EQ(catalog.loaderFor("docx"), "");
}

TEST(SearchPath, HasFoldersOfTheCommandLineThenTheEnvironmentThenTheProgram) {
    setenv("RT_PLUGIN_PATH", "/one::/two:relative:", 1);
    const auto folders = searchPath({"/zero"});
    unsetenv("RT_PLUGIN_PATH");
    const fs::path program = fs::read_symlink("/proc/self/exe");
    EXPECT_EQ(folders,
              (std::vector<fs::path>{"/zero", "/one", "/two", fs::absolute("relative"),
                                     program.parent_path().parent_path() / "lib/rt/plugins"}));
}

} // namespace
} // namespace rt::plugin_host
