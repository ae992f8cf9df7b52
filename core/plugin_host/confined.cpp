#include <core/plugin_host/confined.hpp>

#include <core/scene/input_file.hpp>

#include <exception>
#include <thread>

#include <fcntl.h>
#include <linux/landlock.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace rt::plugin_host {
namespace {

constexpr std::uint64_t kRead = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
// The rights of Landlock's first version, so that any kernel that has it will do.
constexpr std::uint64_t kHandled =
    kRead | LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE |
    LANDLOCK_ACCESS_FS_REMOVE_DIR | LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_MAKE_CHAR |
    LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_SOCK |
    LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK | LANDLOCK_ACCESS_FS_MAKE_SYM;

class Descriptor {
public:
    explicit Descriptor(long fd) : fd_(static_cast<int>(fd)) {}
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }

private:
    int fd_;
};

/// Where the loader finds what a module needs, and what libraries read of the machine when they start.
constexpr const char* kSystemPlaces[] = {
    "/usr/lib",      "/usr/lib64",       "/usr/local/lib", "/lib",
    "/lib64",        "/etc/ld.so.cache", "/dev/null",      "/proc/self/cgroup",
    "/proc/cpuinfo", "/proc/meminfo",    "/sys/fs/cgroup", "/sys/devices/system/cpu"};

bool allow(int ruleset, const std::filesystem::path& place) {
    const Descriptor where(::open(place.c_str(), O_PATH | O_CLOEXEC));
    if (where.get() < 0) return true; // what is not there needs no leave
    landlock_path_beneath_attr rule{};
    rule.parent_fd = where.get();
    std::error_code ignored;
    rule.allowed_access = std::filesystem::is_directory(place, ignored)
                              ? kRead
                              : std::uint64_t{LANDLOCK_ACCESS_FS_READ_FILE};
    return ::syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0) == 0;
}

/// Confines the calling thread.
bool confineThread(const std::vector<std::filesystem::path>& also) {
    landlock_ruleset_attr attributes{};
    attributes.handled_access_fs = kHandled;
    const Descriptor ruleset(
        ::syscall(SYS_landlock_create_ruleset, &attributes, sizeof attributes, 0));
    if (ruleset.get() < 0) return false;
    for (const char* const place : kSystemPlaces)
        if (!allow(ruleset.get(), place)) return false;
    for (const std::filesystem::path& place : also)
        if (!allow(ruleset.get(), place)) return false;
    for (const std::string& folder : scene::readableFolders())
        if (!allow(ruleset.get(), folder)) return false;
    return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           ::syscall(SYS_landlock_restrict_self, ruleset.get(), 0) == 0;
}

} // namespace

bool runConfined(const std::vector<std::filesystem::path>& also,
                 const std::function<void()>& work) {
    if (!scene::readingIsConfined()) {
        work();
        return true;
    }
    bool confined = false;
    std::exception_ptr thrown;
    std::thread([&] {
        confined = confineThread(also);
        if (!confined) return;
        try {
            work();
        } catch (...) {
            thrown = std::current_exception();
        }
    }).join();
    if (thrown) std::rethrow_exception(thrown);
    return confined;
}

} // namespace rt::plugin_host
