#include "machine/probe.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "machine/pointer_chase.h"
#include "runtime/processor_seconds.h"

namespace podm::bench {
namespace {

constexpr int kBursts = 8;  // one burst takes about 10 ms
constexpr std::size_t kChaseBytes = std::size_t{32} << 20, kChaseLoads = 20'000;
constexpr std::size_t kTriadLength = std::size_t{1} << 20;  // 24 MiB in three arrays
constexpr std::uint64_t kChaseSeed = 1;

// Keeps the arrays of the triad between bursts.
class Triad {
 public:
  double gb_per_s() {
    const double start = processor_seconds();
    for (std::size_t i = 0; i < kTriadLength; ++i) a_[i] = b_[i] + 3.0 * c_[i];
    asm volatile("" : : "r"(a_.data()) : "memory");  // forces the compiler to compute the sums
    return 3.0 * sizeof(double) * kTriadLength / 1e9 / (processor_seconds() - start);
  }

 private:
  std::vector<double> a_ = std::vector<double>(kTriadLength), b_ = std::vector<double>(kTriadLength, 1.0),
                      c_ = std::vector<double>(kTriadLength, 2.0);
};

// The kinds alternate. Each kind is therefore spread over the whole probe.
ProbeRecord probe_here() {
  PointerChase chase(kChaseBytes, kChaseSeed);
  Triad triad;
  std::vector<ProbeRecord> bursts;
  for (int burst = 0; burst < kBursts; ++burst)
    bursts.push_back(
        {1e9 * chase.seconds_per_load(kChaseLoads), triad.gb_per_s(), 1e9 / cycles_per_second()});
  return best_of(bursts);
}

// Writes a probe into the pipe and exits.
[[noreturn]] void run_probe_in_child(int pipe) {
  try {
    const ProbeRecord probe = probe_here();
    _exit(write(pipe, &probe, sizeof probe) == sizeof probe ? 0 : 1);
  } catch (const std::exception&) {
    _exit(1);
  }
}

bool move_apart(double a, double b) { return std::max(a, b) > kToleratedMove * std::min(a, b); }

}  // namespace

ProbeRecord best_of(std::span<const ProbeRecord> bursts) {
  ProbeRecord best = bursts.front();
  for (const ProbeRecord& burst : bursts)
    best = {std::min(best.chase_ns, burst.chase_ns), std::max(best.triad_gb_per_s, burst.triad_gb_per_s),
            std::min(best.integer_ns, burst.integer_ns)};
  return best;
}

bool differ(std::span<const ProbeRecord> probes) {
  for (const ProbeRecord& a : probes)
    for (const ProbeRecord& b : probes)
      if (move_apart(a.chase_ns, b.chase_ns) || move_apart(a.triad_gb_per_s, b.triad_gb_per_s) ||
          move_apart(a.integer_ns, b.integer_ns))
        return true;
  return false;
}

Probe probe_machine() {
  int ends[2];
  if (pipe(ends) != 0) return Unavailable{std::strerror(errno)};
  const pid_t child = fork();
  if (child == 0) run_probe_in_child(ends[1]);
  const int error = errno;
  close(ends[1]);
  ProbeRecord probe;
  const bool is_read = child > 0 && read(ends[0], &probe, sizeof probe) == sizeof probe;
  close(ends[0]);
  if (child < 0) return Unavailable{std::strerror(error)};
  waitpid(child, nullptr, 0);
  if (!is_read) return Unavailable{"the probe ended before it had a value"};
  return probe;
}

}  // namespace podm::bench
