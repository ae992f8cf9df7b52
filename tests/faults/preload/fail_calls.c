/* LD_PRELOAD: makes the n-th call of one kind fail, counted from the start of main or from an opening.
   FAIL_CALL  open, read, write, short (half of a write), close, fsync, rename, space (statvfs says that none is left) or malloc
   FAIL_AT    n, from 1          FAIL_ERRNO  errno of it, ENOSPC by default
   FAIL_AFTER end of a file's name: calls are counted from its opening; empty: from the start of main
   FAIL_MARK  a file that is made when the call has been struck */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { NONE, OPEN, READ, WRITE, SHORT, CLOSE, FSYNC, RENAME, SPACE, MALLOC, KINDS };
static const char* const names[KINDS] = {"none",  "open",  "read",   "write", "short",
                                         "close", "fsync", "rename", "space", "malloc"};
static int kind, error_number, started;
static long at, count;
static const char *mark, *after = "";

static int strikes(int which) {
    if (!started || kind != which || __atomic_add_fetch(&count, 1, __ATOMIC_RELAXED) != at)
        return 0;
    const long fd = syscall(SYS_openat, AT_FDCWD, mark, O_WRONLY | O_CREAT, 0600);
    if (fd >= 0) syscall(SYS_close, (int)fd);
    errno = error_number;
    return 1;
}

static int (*real_main)(int, char**, char**);
static int counted_main(int argc, char** argv, char** envp) {
    started = *after == '\0';
    return real_main(argc, argv, envp);
}

typedef int start_function(int (*)(int, char**, char**), int, char**, void (*)(void),
                           void (*)(void), void (*)(void), void*);
int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(void),
                      void (*fini)(void), void (*rtld_fini)(void), void* stack_end) {
    const char* const wanted = getenv("FAIL_CALL");
    for (int i = 1; wanted != NULL && i < KINDS; ++i)
        if (strcmp(names[i], wanted) == 0) kind = i;
    if (kind != NONE) {
        at = atol(getenv("FAIL_AT"));
        mark = getenv("FAIL_MARK");
        if (getenv("FAIL_AFTER") != NULL) after = getenv("FAIL_AFTER");
        error_number = getenv("FAIL_ERRNO") != NULL ? atoi(getenv("FAIL_ERRNO")) : ENOSPC;
        if (kind == MALLOC) error_number = ENOMEM;
    }
    real_main = main;
    start_function* start;
    *(void**)&start =
        dlsym(RTLD_NEXT, "__libc_start_main"); /* ISO C has no such conversion, POSIX has */
    return start(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}

int open(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const int mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, int) : 0;
    va_end(arguments);
    const size_t size = strlen(path), end = strlen(after);
    if (end > 0 && size >= end && strcmp(path + size - end, after) == 0) started = 1;
    return strikes(OPEN) ? -1 : (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
}
FILE* fopen(const char* path, const char* mode) {
    FILE* (*next)(const char*, const char*);
    *(void**)&next = dlsym(RTLD_NEXT, "fopen");
    return strikes(OPEN) ? NULL : next(path, mode);
}
ssize_t read(int fd, void* bytes, size_t size) {
    return strikes(READ) ? -1 : syscall(SYS_read, fd, bytes, size);
}
ssize_t write(int fd, const void* bytes, size_t size) {
    if (fd > 2 && strikes(WRITE)) return -1;
    if (fd > 2 && size > 1 && strikes(SHORT)) size /= 2;
    return syscall(SYS_write, fd, bytes, size);
}
int close(int fd) { /* the descriptor is closed in any case, as Linux does */
    const int struck = fd > 2 && strikes(CLOSE), saved = errno;
    const int result = (int)syscall(SYS_close, fd);
    if (!struck) return result;
    errno = saved;
    return -1;
}
int fsync(int fd) { return strikes(FSYNC) ? -1 : (int)syscall(SYS_fsync, fd); }
int rename(const char* from, const char* to) {
    return strikes(RENAME) ? -1 : (int)syscall(SYS_rename, from, to);
}

int statvfs(const char* path, struct statvfs* space) {
    int (*next)(const char*, struct statvfs*);
    *(void**)&next = dlsym(RTLD_NEXT, "statvfs");
    const int result = next(path, space);
    if (result == 0 && strikes(SPACE)) space->f_bavail = 0;
    return result;
}

extern void *__libc_malloc(size_t), *__libc_calloc(size_t, size_t), *__libc_realloc(void*, size_t),
    *__libc_memalign(size_t, size_t);
void* malloc(size_t size) { return strikes(MALLOC) ? NULL : __libc_malloc(size); }
void* calloc(size_t items, size_t size) {
    return strikes(MALLOC) ? NULL : __libc_calloc(items, size);
}
void* realloc(void* old, size_t size) { return strikes(MALLOC) ? NULL : __libc_realloc(old, size); }
void* aligned_alloc(size_t alignment, size_t size) {
    return strikes(MALLOC) ? NULL : __libc_memalign(alignment, size);
}
int posix_memalign(void** to, size_t alignment, size_t size) {
    if (strikes(MALLOC)) return ENOMEM;
    *to = __libc_memalign(alignment, size);
    return *to != NULL ? 0 : ENOMEM;
}
