/* What Debian 12's libstdc++ takes from glibc 2.32 and later, for programs that also run with glibc 2.31. */
#include <errno.h>
#include <stddef.h>
#include <stdlib.h>
#include <sys/random.h>

/* False: a reference count is always changed atomically. */
char __libc_single_threaded __attribute__((visibility("hidden"))) = 0;

/* std::random_device. */
__attribute__((visibility("hidden"))) unsigned arc4random(void) {
  unsigned value;
  while (getrandom(&value, sizeof value, 0) != (ssize_t)sizeof value)
    if (errno != EINTR) abort();
  return value;
}
