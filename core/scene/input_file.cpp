#include <core/scene/input_file.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <filesystem>
#include <memory>
#include <new>
#include <system_error>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rt::scene {
namespace {

namespace fs = std::filesystem;

constexpr Code kNoSuchFile{401}, kNotReadable{402}, kNotRegular{403}, kOutside{404};

constexpr const char* kWhyOutside = "lies outside of the folders that --sandbox allows";

struct Confinement {
    bool active = false;
    std::vector<std::string> folders;
};
Confinement confinement;

std::string_view kindOf(mode_t mode) {
    if (S_ISDIR(mode)) return "a folder";
    if (S_ISFIFO(mode)) return "a pipe";
    if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device";
    return "a socket";
}

FileRefusal refusalOf(int number) {
    if (number == ENOMEM) throw std::bad_alloc();
    if (number == ENOENT || number == ENOTDIR) return {kNoSuchFile, "there is no such file"};
    return {kNotReadable, "cannot be read: " + std::generic_category().message(number)};
}

struct Descriptor {
    int value;
    ~Descriptor() {
        if (value >= 0) ::close(value);
    }
};

/// Where the open file really lies; empty: unknown.
std::string placeOf(int fd) {
    std::array<char, PATH_MAX + 1> place;
    const ssize_t size =
        ::readlink(("/proc/self/fd/" + std::to_string(fd)).c_str(), place.data(), place.size());
    return size <= 0 ? "" : std::string(place.data(), static_cast<std::size_t>(size));
}

bool liesIn(const std::string& folder, const std::string& place) {
    return place.starts_with(folder) && (folder.ends_with('/') || place[folder.size()] == '/');
}

bool isReadable(const std::string& place) {
    return std::any_of(confinement.folders.begin(), confinement.folders.end(),
                       [&](const std::string& folder) { return liesIn(folder, place); });
}

bool liesInOwn(const std::string& own, const std::string& place) {
    std::error_code error;
    const fs::path real = fs::canonical(own, error);
    return !error && liesIn(real.string(), place);
}

} // namespace

void confineReading(const std::vector<std::string>& folders) {
    confinement.active = true;
    for (const std::string& folder : folders) {
        std::error_code error;
        const fs::path real = fs::canonical(folder.empty() ? "." : folder, error);
        if (!error) confinement.folders.push_back(real.string());
    }
}

bool readingIsConfined() { return confinement.active; }

const std::vector<std::string>& readableFolders() { return confinement.folders; }

std::variant<InputFile, FileRefusal> InputFile::open(const std::string& path,
                                                     const std::string& own) {
    if (path.find('\0') != std::string::npos)
        return FileRefusal{kNoSuchFile, "there is no such file"};
    // O_PATH looks without opening: a device does not notice, a pipe does not wait.
    const Descriptor look{::open(path.c_str(), O_PATH | O_CLOEXEC)};
    struct stat status {};
    if (look.value < 0 || ::fstat(look.value, &status) != 0) {
        const FileRefusal refusal = refusalOf(errno);
        // Whether a file exists outside is nobody's business.
        std::error_code ignored;
        if (!confinement.active ||
            isReadable(fs::weakly_canonical(fs::absolute(path, ignored), ignored).string()))
            return refusal;
        return FileRefusal{kOutside, kWhyOutside};
    }
    if (confinement.active)
        if (const std::string place = placeOf(look.value);
            !isReadable(place) && (own.empty() || !liesInOwn(own, place)))
            return FileRefusal{kOutside, kWhyOutside};
    if (!S_ISREG(status.st_mode))
        return FileRefusal{kNotRegular,
                           "is " + std::string(kindOf(status.st_mode)) + ", not a file"};
    // The very file that was looked at, where /proc tells; a path may have been given to another file meanwhile.
    constexpr int kFlags = O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY;
    int fd = ::open(("/proc/self/fd/" + std::to_string(look.value)).c_str(), kFlags);
    if (fd < 0 && !confinement.active && errno == ENOENT) fd = ::open(path.c_str(), kFlags);
    if (fd < 0) return refusalOf(errno);
    InputFile file(fd, 0);
    if (::fstat(fd, &status) != 0) return refusalOf(errno);
    if (!S_ISREG(status.st_mode))
        return FileRefusal{kNotRegular,
                           "is " + std::string(kindOf(status.st_mode)) + ", not a file"};
    file.size_ = static_cast<std::uint64_t>(status.st_size);
    return file;
}

std::variant<std::string, FileRefusal> InputFile::read(std::uint64_t maxBytes) const {
    if (size_ > maxBytes) return FileRefusal{kTooLarge, tooLarge(maxBytes)};
    std::string text;
    std::size_t size = 0;
    for (;;) { // files of /proc say that they are empty; files may grow
        text.resize(std::max(size + 65536, static_cast<std::size_t>(size_) + 1));
        const ssize_t got = ::read(fd_, text.data() + size, text.size() - size);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return refusalOf(errno);
        size += static_cast<std::size_t>(got);
        if (size > maxBytes) return FileRefusal{kTooLarge, tooLarge(maxBytes)};
        if (got == 0) break;
    }
    text.resize(size);
    return text;
}

InputFile::~InputFile() {
    if (fd_ >= 0) ::close(fd_);
}

std::vector<std::string> namesIn(const std::string& folder, std::size_t most) {
    struct Close {
        void operator()(DIR* open) const { ::closedir(open); }
    };
    const std::unique_ptr<DIR, Close> open(::opendir(folder.empty() ? "." : folder.c_str()));
    if (!open && errno == ENOMEM) throw std::bad_alloc();
    std::vector<std::string> names;
    while (open && names.size() < most) {
        const dirent* const entry = ::readdir(open.get());
        if (!entry) break;
        const std::string_view name = entry->d_name;
        if (name != "." && name != "..") names.emplace_back(name);
    }
    return names;
}

std::string tooLarge(std::uint64_t maxBytes) {
    const bool whole = maxBytes % (1 << 20) == 0;
    return "is larger than " +
           (whole ? std::to_string(maxBytes >> 20) + " MiB" : std::to_string(maxBytes) + " bytes") +
           ", the most that a text file may have";
}

} // namespace rt::scene
