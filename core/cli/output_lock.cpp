#include <core/cli/output_lock.hpp>

#include <core/scene/input_file.hpp>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rt::cli {

namespace {

namespace fs = std::filesystem;

constexpr scene::Code kWriteFailed{605}, kInUse{608};

scene::Location wholeFile(const std::string& path) {
    return {std::make_shared<scene::Source>(scene::Source{path, {}}), 0, 0};
}

std::string now() {
    const std::time_t seconds = std::time(nullptr);
    std::tm parts{};
    ::localtime_r(&seconds, &parts);
    char text[32];
    return {text, std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &parts)};
}

/// Paths of held locks, for unlinkLocks(): one slot each, as many as a command line may sensibly have outputs.
std::array<std::atomic<const char*>, 16> held{};
static_assert(std::atomic<const char*>::is_always_lock_free);

void remember(const char* file) {
    for (auto& slot : held)
        if (const char* empty = nullptr; slot.compare_exchange_strong(empty, file)) return;
}

void forget(const char* file) {
    for (auto& slot : held)
        if (const char* expected = file; slot.compare_exchange_strong(expected, nullptr)) return;
}

/// Temporary files `.NAME.PID.tmp` of processes that are no more. Whoever holds the lock is the only one to write NAME.
void sweep(const fs::path& folder, const std::string& name) {
    const std::string start = "." + name + ".", end = ".tmp";
    for (const std::string& file : scene::namesIn(folder.string())) {
        if (!file.starts_with(start) || !file.ends_with(end)) continue;
        pid_t process = 0;
        const char* const digits = file.data() + start.size();
        const auto [rest, bad] = std::from_chars(digits, file.data() + file.size(), process);
        if (bad != std::errc() || rest == digits || (*rest != '.' && *rest != '-')) continue;
        std::error_code ignored;
        if (process > 0 && ::kill(process, 0) != 0 && errno == ESRCH)
            fs::remove(folder / file, ignored);
    }
}

std::string read(int fd) {
    char text[256];
    const ssize_t size = ::pread(fd, text, sizeof text, 0);
    return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : "another process";
}

} // namespace

std::optional<OutputLock> OutputLock::take(const std::string& path,
                                           scene::Diagnostics& diagnostics) {
    std::error_code ignored;
    const fs::path target = fs::weakly_canonical(fs::absolute(path, ignored), ignored);
    std::string name = target.filename().string();
    name.resize(std::min<std::size_t>(name.size(), NAME_MAX - 6));
    const std::string file = (target.parent_path() / ("." + name + ".lock")).string();
    for (;;) {
        // Before the file: where there is no memory for it, no file is left.
        auto remembered = std::make_unique<const std::string>(file);
        const int fd =
            ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
        if (fd < 0) {
            diagnostics.error(kWriteFailed, wholeFile(path),
                              "cannot be locked: " + std::generic_category().message(errno));
            return {};
        }
        OutputLock lock(fd, std::move(remembered));
        if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
            lock.file_.reset(); // not ours to remove
            diagnostics.error(kInUse, wholeFile(path), "is being written by " + read(fd));
            return {};
        }
        struct stat ours {
        }, there{};
        if (::fstat(fd, &ours) == 0 && ::stat(file.c_str(), &there) == 0 &&
            ours.st_ino == there.st_ino && ours.st_dev == there.st_dev) {
            const std::string who = "process " + std::to_string(::getpid()) + " since " + now();
            if (::ftruncate(fd, 0) != 0 || ::pwrite(fd, who.data(), who.size(), 0) < 0) {
            } // without it the message of another says less
            sweep(target.parent_path(), target.filename().string());
            remember(lock.file_->c_str());
            return lock;
        }
        lock.file_.reset(); // another removed it between open and flock
    }
}

OutputLock::OutputLock(OutputLock&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), file_(std::move(other.file_)) {}

OutputLock::~OutputLock() {
    if (fd_ < 0) return;
    if (file_) {
        forget(file_->c_str());
        ::unlink(file_->c_str()); // while it is held: nobody else believes to hold it
    }
    ::close(fd_);
}

void unlinkLocks() noexcept {
    for (const auto& slot : held)
        if (const char* const file = slot) ::unlink(file);
}

} // namespace rt::cli
