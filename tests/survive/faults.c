/* Preloaded, it fails one system call that writes, or all from one on.
 *
 * FAULT_AT      number of the call, from 1
 * FAULT_ERRNO   what it fails with
 * FAULT_LASTS   1: every call from there on fails, too
 * FAULT_MARK    a file that is made when the first call fails
 *
 * Counted are writes to files (not to the standard streams), syncs, renames, links and changes of
 * length.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_long calls;

static long number(const char *name) {
    const char *value = getenv(name);
    return value ? atol(value) : 0;
}

/* Whether this call is to fail. */
static int fails(void) {
    long at = number("FAULT_AT");
    long call = atomic_fetch_add(&calls, 1) + 1;
    if (at == 0 || call < at || (call > at && !number("FAULT_LASTS"))) return 0;
    const char *mark = getenv("FAULT_MARK");
    if (call == at && mark) syscall(SYS_close, syscall(SYS_openat, AT_FDCWD, mark, O_CREAT | O_WRONLY, 0644));
    errno = (int)number("FAULT_ERRNO");
    return 1;
}

static int is_file(int fd) {
    struct stat found;
    return fd > 2 && fstat(fd, &found) == 0 && S_ISREG(found.st_mode);
}

#define REAL(name) ((typeof(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int fd, const void *bytes, size_t n) {
    return is_file(fd) && fails() ? -1 : REAL(write)(fd, bytes, n);
}
ssize_t writev(int fd, const struct iovec *parts, int n) {
    return is_file(fd) && fails() ? -1 : REAL(writev)(fd, parts, n);
}
ssize_t pwrite(int fd, const void *bytes, size_t n, off_t at) {
    return is_file(fd) && fails() ? -1 : REAL(pwrite)(fd, bytes, n, at);
}
ssize_t pwrite64(int fd, const void *bytes, size_t n, off64_t at) {
    return is_file(fd) && fails() ? -1 : REAL(pwrite64)(fd, bytes, n, at);
}
int ftruncate(int fd, off_t length) { return fails() ? -1 : REAL(ftruncate)(fd, length); }
int ftruncate64(int fd, off64_t length) { return fails() ? -1 : REAL(ftruncate64)(fd, length); }
int fsync(int fd) { return fails() ? -1 : REAL(fsync)(fd); }
int fdatasync(int fd) { return fails() ? -1 : REAL(fdatasync)(fd); }
int rename(const char *from, const char *to) { return fails() ? -1 : REAL(rename)(from, to); }
int link(const char *from, const char *to) { return fails() ? -1 : REAL(link)(from, to); }
int linkat(int a, const char *from, int b, const char *to, int flags) {
    return fails() ? -1 : REAL(linkat)(a, from, b, to, flags);
}
