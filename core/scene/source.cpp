#include <core/scene/source.hpp>

#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace rt::scene {
namespace {

constexpr Code kNoSuchFile{401}, kNotReadable{402}, kNotRegular{403}, kTooLarge{710};

struct Descriptor {
    int value;
    ~Descriptor() {
        if (value >= 0) ::close(value);
    }
};

std::string_view kindOf(mode_t mode) {
    if (S_ISDIR(mode)) return "a folder";
    if (S_ISFIFO(mode)) return "a pipe";
    if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device";
    return "a socket";
}

} // namespace

std::shared_ptr<const Source> readSource(const std::string& path, std::uint64_t maxBytes,
                                         Diagnostics& diagnostics, const Location& namedAt) {
    auto source = std::make_shared<Source>(Source{path, {}});
    const auto refuse = [&](Code code, const std::string& reason) {
        if (namedAt.source)
            diagnostics.error(code, namedAt, quoted(path) + ": " + reason);
        else
            diagnostics.error(code, {source}, reason);
        return nullptr;
    };
    const auto refuseErrno = [&](int number) {
        if (number == ENOENT || number == ENOTDIR)
            return refuse(kNoSuchFile, "there is no such file");
        return refuse(kNotReadable, "cannot be read: " + std::generic_category().message(number));
    };

    if (path.find('\0') != std::string::npos) return refuse(kNoSuchFile, "there is no such file");
    // O_NONBLOCK: opening a FIFO must not wait for a writer.
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY)};
    if (file.value < 0) return refuseErrno(errno);
    struct stat status {};
    if (::fstat(file.value, &status) != 0) return refuseErrno(errno);
    if (!S_ISREG(status.st_mode))
        return refuse(kNotRegular, "is " + std::string(kindOf(status.st_mode)) + ", not a file");
    const auto tooLarge = [&] {
        return refuse(kTooLarge, "is larger than " + std::to_string(maxBytes >> 20) +
                                     " MiB, the most that a text file may have");
    };
    if (static_cast<std::uint64_t>(status.st_size) > maxBytes) return tooLarge();

    std::string& text = source->text;
    std::size_t size = 0;
    for (;;) { // files of /proc say that they are empty; files may grow
        text.resize(size + 65536 > static_cast<std::size_t>(status.st_size) + 1
                        ? size + 65536
                        : static_cast<std::size_t>(status.st_size) + 1);
        const ssize_t got = ::read(file.value, text.data() + size, text.size() - size);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return refuseErrno(errno);
        size += static_cast<std::size_t>(got);
        if (size > maxBytes) return tooLarge();
        if (got == 0) break;
    }
    text.resize(size);
    return source;
}

} // namespace rt::scene
