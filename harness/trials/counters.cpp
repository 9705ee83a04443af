#include "trials/counters.h"

#include <fmt/format.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>

namespace podm::bench {
namespace {

constexpr std::uint64_t cache_event(std::uint64_t cache, std::uint64_t result) {
  return cache | (PERF_COUNT_HW_CACHE_OP_READ << 8U) | (result << 16U);
}

struct Event {
  const char* name;
  std::uint32_t type;
  std::uint64_t config;
};

constexpr Event kEvents[] = {
    {"task_clock_ns", PERF_TYPE_SOFTWARE, PERF_COUNT_SW_TASK_CLOCK},
    {"page_faults", PERF_TYPE_SOFTWARE, PERF_COUNT_SW_PAGE_FAULTS},
    {"context_switches", PERF_TYPE_SOFTWARE, PERF_COUNT_SW_CONTEXT_SWITCHES},
    {"cpu_migrations", PERF_TYPE_SOFTWARE, PERF_COUNT_SW_CPU_MIGRATIONS},
    {"cycles", PERF_TYPE_HARDWARE, PERF_COUNT_HW_CPU_CYCLES},
    {"instructions", PERF_TYPE_HARDWARE, PERF_COUNT_HW_INSTRUCTIONS},
    {"llc_loads", PERF_TYPE_HW_CACHE, cache_event(PERF_COUNT_HW_CACHE_LL, PERF_COUNT_HW_CACHE_RESULT_ACCESS)},
    {"llc_load_misses", PERF_TYPE_HW_CACHE,
     cache_event(PERF_COUNT_HW_CACHE_LL, PERF_COUNT_HW_CACHE_RESULT_MISS)},
    {"dtlb_load_misses", PERF_TYPE_HW_CACHE,
     cache_event(PERF_COUNT_HW_CACHE_DTLB, PERF_COUNT_HW_CACHE_RESULT_MISS)},
};
constexpr std::size_t kNumSoftwareEvents = 4;

// The kernel writes this for the `read_format` below.
struct Reading {
  std::uint64_t count, enabled_ns, running_ns;
};

// The counter is off in this process and its children until they execute a program.
perf_event_attr attributes_of(const Event& event) {
  perf_event_attr attributes{};
  attributes.size = sizeof(attributes);
  attributes.type = event.type;
  attributes.config = event.config;
  attributes.read_format = PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING;
  attributes.disabled = attributes.inherit = attributes.enable_on_exec = 1;
  return attributes;
}

bool is_forbidden(int error) { return error == EACCES || error == EPERM; }

std::string in_words(int error) {
  if (error == ENOENT) return "neither processor nor kernel has this counter";
  return std::string("perf_event_open: ") + std::strerror(error);
}

// Returns the value that wait4(2) reports for the event. It does not report migrations.
std::optional<double> of_getrusage(const Event& event, const ProcessOutcome& outcome) {
  if (event.type != PERF_TYPE_SOFTWARE) return {};
  switch (event.config) {
    case PERF_COUNT_SW_TASK_CLOCK:
      return 1e9 * (outcome.user_s + outcome.system_s);
    case PERF_COUNT_SW_PAGE_FAULTS:
      return static_cast<double>(outcome.page_faults);
    case PERF_COUNT_SW_CONTEXT_SWITCHES:
      return static_cast<double>(outcome.context_switches);
    default:
      return {};
  }
}

std::variant<Counter, Unavailable> value_of(const Reading& reading, const char* source) {
  if (reading.running_ns == 0 && reading.enabled_ns > 0)
    return Unavailable{"the processor's counters were always in use"};
  if (reading.running_ns == reading.enabled_ns) return Counter{reading.count, source, {}};
  const double share = static_cast<double>(reading.running_ns) / static_cast<double>(reading.enabled_ns);
  return Counter{std::round(static_cast<double>(reading.count) / share), source, share};
}

}  // namespace

int open_counter(perf_event_attr& attributes) {
  constexpr int kThisThread = 0, kAnyProcessor = -1, kNoGroup = -1;
  const long descriptor =
      syscall(SYS_perf_event_open, &attributes, kThisThread, kAnyProcessor, kNoGroup, PERF_FLAG_FD_CLOEXEC);
  return descriptor < 0 ? -errno : static_cast<int>(descriptor);
}

CountersKeptReady::CountersKeptReady() {
  perf_event_attr attributes = attributes_of(kEvents[0]);
  attributes.inherit = attributes.enable_on_exec = 0;
  descriptor_ = open_counter(attributes);
}

CountersKeptReady::~CountersKeptReady() {
  if (descriptor_ >= 0) close(descriptor_);
}

PerfCounters::PerfCounters(CounterKinds kinds, const OpenCounter& open) {
  const bool all = kinds == CounterKinds::kSoftwareAndHardware;
  for (const Event& event : std::span(kEvents).first(all ? std::size(kEvents) : kNumSoftwareEvents)) {
    perf_event_attr attributes = attributes_of(event);
    int descriptor = open(attributes);
    // A process that may not count in the kernel may be allowed to count in user mode. Software events happen
    // only in the kernel.
    const bool retry = is_forbidden(-descriptor) && event.type != PERF_TYPE_SOFTWARE;
    attributes.exclude_kernel = attributes.exclude_hv = retry;
    if (retry) descriptor = open(attributes);
    counters_.push_back({descriptor, retry});
  }
}

PerfCounters::~PerfCounters() {
  for (const OpenedCounter& counter : counters_)
    if (counter.descriptor >= 0) close(counter.descriptor);
}

Counters PerfCounters::read(const ProcessOutcome& outcome) const {
  Counters counts;
  for (std::size_t i = 0; i < counters_.size(); ++i) {
    const OpenedCounter& counter = counters_[i];
    auto& count = counts[kEvents[i].name];
    Reading reading{};
    if (outcome.end == ProcessOutcome::End::kNotStarted)
      count = Unavailable{"the process did not start"};
    else if (counter.descriptor < 0) {
      const auto value = of_getrusage(kEvents[i], outcome);
      if (value)
        count = Counter{*value, "getrusage", {}};
      else
        count = Unavailable{in_words(-counter.descriptor)};
    } else if (::read(counter.descriptor, &reading, sizeof(reading)) != sizeof(reading))
      count = Unavailable{fmt::format("cannot read the counter: {}", std::strerror(errno))};
    else
      count = value_of(reading, counter.is_of_user_mode ? "perf_event, user mode" : "perf_event");
  }
  return counts;
}

}  // namespace podm::bench
