#include <formats/atomic_file.hpp>
#include <tests/formats/failing_calls.hpp>
#include <tests/formats/temporary_folder.hpp>

#include <gtest/gtest.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <vector>

namespace {

namespace fs = std::filesystem;
using rt::contentsOf;
using rt::TemporaryFolder;
using rt::formats::writeFileAtomically;

std::span<const std::byte> bytesOf(const std::string& text) {
    return std::as_bytes(std::span(text));
}
void put(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}
mode_t modeOf(const std::string& path) {
    struct stat status {};
    EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
    return status.st_mode & 07777;
}
/// The error of writing `text` to `path`, 0 for success.
int errorOfWriting(const std::string& path, const std::string& text) {
    try {
        writeFileAtomically(path, bytesOf(text));
        return 0;
    } catch (const std::system_error& error) {
        EXPECT_NE(std::string(error.what()).find("'" + path + "'"), std::string::npos)
            << error.what();
        return error.code().value();
    }
}

const std::string kNew(200000, 'n'); // more than one buffer of the read-back

TEST(AtomicFile, NewFileHasTheUsersMode) {
    const TemporaryFolder folder;
    const mode_t before = ::umask(027);
    EXPECT_EQ(errorOfWriting(folder / "a.png", kNew), 0);
    ::umask(before);
    EXPECT_EQ(contentsOf(folder / "a.png"), kNew);
    EXPECT_EQ(modeOf(folder / "a.png"), 0640u);
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, ExistingFileKeepsItsMode) {
    const TemporaryFolder folder;
    put(folder / "a.png", "old");
    ::chmod((folder / "a.png").c_str(), 0604);
    EXPECT_EQ(errorOfWriting(folder / "a.png", kNew), 0);
    EXPECT_EQ(modeOf(folder / "a.png"), 0604u);
    EXPECT_EQ(contentsOf(folder / "a.png"), kNew);
}

TEST(AtomicFile, EmptyContentsAndRelativePath) {
    const TemporaryFolder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    EXPECT_EQ(errorOfWriting("empty", ""), 0);
    fs::current_path(before);
    EXPECT_TRUE(fs::is_empty(folder / "empty"));
}

TEST(AtomicFile, SymbolicLinkKeepsPointing) {
    const TemporaryFolder folder, elsewhere;
    put(elsewhere / "real.png", "old");
    fs::create_symlink(elsewhere / "real.png", folder / "link.png");
    EXPECT_EQ(errorOfWriting(folder / "link.png", kNew), 0);
    EXPECT_TRUE(fs::is_symlink(folder / "link.png"));
    EXPECT_EQ(contentsOf(elsewhere / "real.png"), kNew);
    EXPECT_EQ(elsewhere.entries(), 1u);
}

TEST(AtomicFile, PlacesThatCannotBeWritten) {
    const TemporaryFolder folder;
    EXPECT_EQ(errorOfWriting(folder.path().string(), kNew), EISDIR);
    EXPECT_EQ(errorOfWriting(folder / "new/", kNew), EISDIR);
    EXPECT_EQ(errorOfWriting(folder / "missing/a.png", kNew), ENOENT);
    EXPECT_EQ(errorOfWriting("", kNew), ENOENT);
    put(folder / "file", "old");
    EXPECT_EQ(errorOfWriting(folder / "file/a.png", kNew), ENOTDIR);
    EXPECT_EQ(errorOfWriting(folder / std::string(300, 'x'), kNew), ENAMETOOLONG);
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, LongestNameFits) {
    const TemporaryFolder folder;
    EXPECT_EQ(errorOfWriting(folder / std::string(255, 'x'), kNew), 0);
    EXPECT_EQ(folder.entries(), 1u);
}

/// In a child that is not root: root may write anywhere.
TEST(AtomicFile, UnwritableFolderAndFile) {
    const TemporaryFolder folder;
    put(folder / "a.png", "old");
    ::chmod(folder.path().c_str(), 0555);
    fs::create_directory(folder / "open");
    put(folder / "open/b.png", "old");
    ::chmod((folder / "open").c_str(), 0777);
    ::chmod((folder / "open/b.png").c_str(), 0444);
    const pid_t child = ::fork();
    if (child == 0) {
        if (::geteuid() == 0 && (::setgid(65534) != 0 || ::setuid(65534) != 0)) ::_exit(9);
        ::_exit(errorOfWriting(folder / "a.png", kNew) == EACCES &&
                        errorOfWriting(folder / "b.png", kNew) == EACCES &&
                        errorOfWriting(folder / "open/b.png", kNew) == EACCES
                    ? 0
                    : 1);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
    EXPECT_EQ(contentsOf(folder / "a.png"), "old");
    EXPECT_EQ(contentsOf(folder / "open/b.png"), "old");
    EXPECT_EQ(folder.entries(), 2u);
    ::chmod(folder.path().c_str(), 0755);
}

TEST(AtomicFile, DevicesAreWrittenNotReplaced) {
    EXPECT_EQ(errorOfWriting("/dev/null", kNew), 0);
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    EXPECT_EQ(errorOfWriting("/dev/full", kNew), ENOSPC);
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(AtomicFile, PipeIsWritten) {
    const TemporaryFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    std::string received;
    std::thread reader([&] { received = contentsOf(folder / "pipe"); });
    EXPECT_EQ(errorOfWriting(folder / "pipe", kNew), 0);
    reader.join();
    EXPECT_EQ(received, kNew);
}

/// Without SIGXFSZ ignored this kills the process.
TEST(AtomicFile, FileSizeLimit) {
    const TemporaryFolder folder;
    put(folder / "a.png", "old");
    const pid_t child = ::fork();
    if (child == 0) {
        const rlimit limit{100000, 100000};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        ::_exit(errorOfWriting(folder / "a.png", kNew) == EFBIG ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
    EXPECT_EQ(contentsOf(folder / "a.png"), "old");
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, FullFileSystem) {
    const TemporaryFolder folder;
    if (::mount("rt-test", folder.path().c_str(), "tmpfs", 0, "size=128k") != 0)
        GTEST_SKIP() << "no right to mount: " << std::strerror(errno);
    put(folder / "a.png", "old");
    try {
        writeFileAtomically(folder / "a.png", bytesOf(kNew));
        ADD_FAILURE() << "200000 bytes fitted into 128 KiB";
    } catch (const std::system_error& error) {
        EXPECT_EQ(error.code().value(), ENOSPC);
        EXPECT_NE(std::string(error.what()).find("200000 bytes needed, "), std::string::npos)
            << error.what();
    }
    EXPECT_EQ(contentsOf(folder / "a.png"), "old");
    EXPECT_EQ(folder.entries(), 1u);
    ::umount(folder.path().c_str());
}

/// SQLite's way: fail the first call, then the second, until one run is not hit. What lies at the path is the old file
/// or the new one in full, the old one whenever an error before the last call was reported, and nothing lies beside it.
void failEveryCall(rt::Failure failure, int errorNumber, bool survives) {
    const TemporaryFolder folder;
    const std::string path = folder / "a.png";
    for (int nth = 1;; ++nth) {
        put(path, "old");
        int error = 0, calls = 0;
        {
            const rt::FailingCalls failing(failure, errorNumber, nth);
            error = errorOfWriting(path, kNew);
            calls = failing.calls();
        }
        const std::string contents = contentsOf(path);
        EXPECT_TRUE(contents == kNew || (error != 0 && contents == "old")) << "call " << nth;
        EXPECT_TRUE(error == 0 || !survives) << "call " << nth;
        EXPECT_EQ(folder.entries(), 1u) << "call " << nth;
        if (calls < nth) {
            EXPECT_EQ(error, 0);
            EXPECT_GT(
                nth,
                10); // open, write, fchmod, fsync, close, open, reads, close, rename, open, fsync, close
            return;
        }
    }
}

TEST(AtomicFile, EveryCallFailingWithNoSpace) {
    failEveryCall(rt::Failure::errorNumber, ENOSPC, false);
}
TEST(AtomicFile, EveryCallFailingWithInputOutputError) {
    failEveryCall(rt::Failure::errorNumber, EIO, false);
}
TEST(AtomicFile, EveryCallInterrupted) { failEveryCall(rt::Failure::errorNumber, EINTR, true); }
TEST(AtomicFile, EveryWriteShort) { failEveryCall(rt::Failure::shortWrite, 0, true); }

TEST(AtomicFile, WritersOfOnePathDoNotMix) {
    const TemporaryFolder folder;
    const std::string path = folder / "a.png";
    std::vector<std::thread> writers;
    for (char c = 'a'; c < 'e'; ++c)
        writers.emplace_back([&, c] {
            for (int i = 0; i < 20; ++i) EXPECT_EQ(errorOfWriting(path, std::string(100000, c)), 0);
        });
    for (auto& writer : writers) writer.join();
    const std::string contents = contentsOf(path);
    EXPECT_EQ(contents, std::string(100000, contents[0]));
    EXPECT_EQ(folder.entries(), 1u);
}

/// Killed at any time: a final file is complete.
TEST(AtomicFile, KilledWriterLeavesOldOrNew) {
    const TemporaryFolder folder;
    const std::string path = folder / "a.png", other(200000, 'o');
    put(path, other);
    for (int i = 0; i < 20; ++i) {
        const pid_t child = ::fork();
        if (child == 0)
            for (;;) writeFileAtomically(path, bytesOf(i % 2 ? other : kNew));
        ::usleep(static_cast<useconds_t>(1000 + 700 * i));
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        const std::string contents = contentsOf(path);
        EXPECT_TRUE(contents == kNew || contents == other) << contents.size();
    }
}

} // namespace
