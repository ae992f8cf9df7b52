#include <tests/formats/failing_calls.hpp>

#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

thread_local rt::Failure activeFailure = rt::Failure::none;
thread_local int activeError = 0, activeNth = 0, count = 0;

/// Whether this call is the one to fail.
bool strikes() { return activeFailure != rt::Failure::none && ++count == activeNth; }

int failed() {
    errno = activeError;
    return -1;
}

} // namespace

namespace rt {

FailingCalls::FailingCalls(Failure failure, int errorNumber, int nth) {
    activeFailure = failure, activeError = errorNumber, activeNth = nth, count = 0;
}
FailingCalls::~FailingCalls() { activeFailure = Failure::none; }
int FailingCalls::calls() const { return count; }

} // namespace rt

using rt::Failure;

extern "C" {

int open(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = flags & O_CREAT ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    return strikes() && activeFailure == Failure::errorNumber
               ? failed()
               : static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

ssize_t write(int fd, const void* bytes, std::size_t n) {
    if (!strikes()) return ::syscall(SYS_write, fd, bytes, n);
    if (activeFailure == Failure::shortWrite)
        return ::syscall(SYS_write, fd, bytes, n > 1 ? n / 2 : n);
    return failed();
}

ssize_t read(int fd, void* bytes, std::size_t n) {
    if (!strikes()) return ::syscall(SYS_read, fd, bytes, n);
    if (activeFailure == Failure::shortWrite)
        return ::syscall(SYS_read, fd, bytes, n > 1 ? n / 2 : n);
    return failed();
}

int fsync(int fd) {
    return strikes() && activeFailure == Failure::errorNumber
               ? failed()
               : static_cast<int>(::syscall(SYS_fsync, fd));
}

int fchmod(int fd, mode_t mode) noexcept {
    return strikes() && activeFailure == Failure::errorNumber
               ? failed()
               : static_cast<int>(::syscall(SYS_fchmod, fd, mode));
}

int rename(const char* from, const char* to) noexcept {
    return strikes() && activeFailure == Failure::errorNumber
               ? failed()
               : static_cast<int>(::syscall(SYS_rename, from, to));
}

int close(int fd) { // the descriptor is closed even where an error is reported, as Linux does
    const bool struck = strikes();
    const int result = static_cast<int>(::syscall(SYS_close, fd));
    return struck && activeFailure == Failure::errorNumber ? failed() : result;
}

} // extern "C"
