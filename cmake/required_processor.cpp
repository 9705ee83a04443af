// Part of each program that is compiled for x86-64-v3, but itself compiled for every x86-64 processor: a
// processor without these instructions gets a sentence, and not the signal SIGILL. The function runs before
// all other code of the program, constructors of static variables included.
#include <unistd.h>

namespace {

constexpr int kBadInput = 2;
constexpr char kSentence[] =
    "this processor has no AVX2, BMI2 or FMA, which this program needs; take one of the level x86-64-v3 "
    "(2013 or "
    "later), or build the sources with -DPODM_MARCH=x86-64\n";

void check_processor(int, char**, char**) {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
      __builtin_cpu_supports("fma"))
    return;
  const auto written = write(STDERR_FILENO, kSentence, sizeof kSentence - 1);
  _exit(written < 0 ? kBadInput + 1 : kBadInput);
}

[[gnu::section(".preinit_array"), gnu::used]] void (*const kFirst)(int, char**, char**) = check_processor;

}  // namespace
