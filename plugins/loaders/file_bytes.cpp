#include "file_bytes.hpp"

#include "mesh_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

namespace rt::loaders {
namespace {

class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) close(fd_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }

private:
    int fd_;
};

[[noreturn]] void fail(const std::string& path, const std::string& why) {
    throw FileError(std::string(fileName(path)) + ": " + why);
}

[[noreturn]] void tooLong(const std::string& path, const char* verb, std::uint64_t limit) {
    fail(path, std::string(verb) + " more than " + std::to_string(limit >> 20) + " MiB");
}

std::string gunzip(const std::string& path, const std::string& packed, std::uint64_t limit) {
    z_stream stream{};
    constexpr int kGzipOnly = 16;
    if (inflateInit2(&stream, MAX_WBITS + kGzipOnly) != Z_OK) throw std::bad_alloc();
    const std::unique_ptr<z_stream, int (*)(z_stream*)> guard(&stream, inflateEnd);

    std::string text;
    std::size_t used = 0, fed = 0;
    bool finished = false; // at the end of a member; gzip files may hold several in a row
    for (;;) {
        if (stream.avail_in == 0 && fed < packed.size()) {
            const auto piece = std::min<std::size_t>(packed.size() - fed, 1u << 30);
            stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + fed));
            stream.avail_in = static_cast<uInt>(piece);
            fed += piece;
        }
        if (finished) {
            if (stream.avail_in == 0) break;
            if (*stream.next_in == 0) break; // padding
            inflateReset(&stream);
            finished = false;
        }
        if (used == text.size()) {
            if (used > limit) tooLong(path, "unpacks to", limit);
            text.resize(std::min<std::uint64_t>(
                std::max<std::size_t>(2 * used, 4 * packed.size() + 4096), limit + 1));
            if (used == text.size()) tooLong(path, "unpacks to", limit);
        }
        const auto room = std::min<std::size_t>(text.size() - used, 1u << 30);
        stream.next_out = reinterpret_cast<Bytef*>(text.data() + used);
        stream.avail_out = static_cast<uInt>(room);
        const int result = inflate(&stream, Z_NO_FLUSH);
        used += room - stream.avail_out;
        if (result == Z_STREAM_END) {
            finished = true;
        } else if (result == Z_MEM_ERROR) {
            throw std::bad_alloc();
        } else if (result != Z_OK && result != Z_BUF_ERROR) {
            fail(path, "is damaged: gzip says " +
                           std::string(stream.msg ? stream.msg : "that the data is invalid"));
        } else if (stream.avail_in == 0 && fed == packed.size() && stream.avail_out != 0) {
            fail(path, "is cut short: the gzip data ends too early");
        }
    }
    if (used > limit) tooLong(path, "unpacks to", limit);
    text.resize(used);
    return text;
}

} // namespace

std::string_view fileName(std::string_view path) {
    const auto slash = path.find_last_of('/');
    return slash == std::string_view::npos ? path : path.substr(slash + 1);
}

std::string readFile(const std::string& path, std::uint64_t limit) {
    // O_NONBLOCK: opening a FIFO returns at once, and fstat then refuses it.
    const Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    if (file.get() < 0) fail(path, std::string("cannot be opened: ") + std::strerror(errno));
    struct stat status {};
    if (fstat(file.get(), &status) != 0)
        fail(path, std::string("cannot be read: ") + std::strerror(errno));
    if (!S_ISREG(status.st_mode)) fail(path, "is not a regular file");
    if (static_cast<std::uint64_t>(status.st_size) > limit) tooLong(path, "has", limit);

    std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
    std::size_t got = 0;
    while (got < bytes.size()) {
        const ssize_t n = read(file.get(), bytes.data() + got, bytes.size() - got);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) fail(path, std::string("cannot be read: ") + std::strerror(errno));
        if (n == 0) break; // it shrank meanwhile
        got += static_cast<std::size_t>(n);
    }
    bytes.resize(got);
    const bool gzip = got >= 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b';
    return gzip ? gunzip(path, bytes, limit) : bytes;
}

} // namespace rt::loaders
