/* What Debian 12's libraries and podm-bench take from glibc 2.32 and later, for programs that run with 2.31, too. */
#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/random.h>
#include <sys/syscall.h>
#include <unistd.h>

/* False: a reference count is always changed atomically. */
char __libc_single_threaded __attribute__((visibility("hidden"))) = 0;

/* std::random_device. */
__attribute__((visibility("hidden"))) unsigned arc4random(void) {
  unsigned value;
  while (getrandom(&value, sizeof value, 0) != (ssize_t)sizeof value)
    if (errno != EINTR) abort();
  return value;
}

/* The harness waits for its trials by it. */
__attribute__((visibility("hidden"))) int pidfd_open(pid_t process, unsigned flags) {
  return (int)syscall(SYS_pidfd_open, process, flags);
}
