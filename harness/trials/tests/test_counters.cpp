// Tests of counters of the child process that the kernel grants, refuses or runs for a part of the time.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>

#include "rows/codec.h"
#include "tests/temporary_folder.h"
#include "trials/counters.h"

namespace podm::bench {
namespace {

ProcessOutcome run_shell(const std::string& command) {
  return run_process(
      {.arguments = {"/bin/sh", "-c", command}, .stdout_path = {}, .stderr_path = {}, .timeout_s = 20});
}

// Touches fresh memory page by page.
void fault_pages(std::size_t number) {
  const auto page_bytes = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* memory =
      mmap(nullptr, number * page_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  madvise(memory, number * page_bytes, MADV_NOHUGEPAGE);
  for (std::size_t i = 0; i < number; ++i) static_cast<volatile char*>(memory)[i * page_bytes] = 1;
  munmap(memory, number * page_bytes);
}

TEST(PerfCounters, ChildAndItsChildrenAreCountedAndThisProcessIsNot) {
  const PerfCounters counters(CounterKinds::kSoftware);
  fault_pages(30'000);
  const ProcessOutcome outcome = run_shell("dd if=/dev/zero of=/dev/null count=1 bs=40M; true");
  fault_pages(30'000);
  const Json counts = to_json(counters.read(outcome));
  EXPECT_EQ(counts.size(), 4u) << counts;
  EXPECT_GT(counts["task_clock_ns"]["value"], 0);
  EXPECT_GT(counts["page_faults"]["value"], 20) << "dd's buffer, in huge pages";
  EXPECT_LT(counts["page_faults"]["value"], 20'000);
}

TEST(PerfCounters, EveryCounterIsAValueWithItsSourceOrAReason) {
  const PerfCounters counters(CounterKinds::kSoftwareAndHardware);
  const Json counts = to_json(counters.read(run_shell("exit 0")));
  EXPECT_EQ(counts.size(), 9u) << counts;
  for (const auto& [name, count] : counts.items())
    EXPECT_TRUE(count.is_string() ? count.get<std::string>().starts_with("unavailable: ")
                                  : count["value"] >= 0 && !count["source"].get<std::string>().empty())
        << name << ": " << count;
}

TEST(PerfCounters, RefusedOnesComeFromGetrusageOrSayWhy) {
  for (const auto& [error, words] :
       {std::pair{EACCES, "Permission denied"}, std::pair{EPERM, "Operation not permitted"},
        std::pair{ENOSYS, "Function not implemented"}}) {
    const PerfCounters counters(CounterKinds::kSoftwareAndHardware,
                                [code = error](perf_event_attr&) { return -code; });
    const Json counts = to_json(counters.read(run_shell("exit 0")));
    for (const char* name : {"task_clock_ns", "page_faults", "context_switches"})
      EXPECT_EQ(counts[name]["source"], "getrusage") << name;
    EXPECT_GT(counts["page_faults"]["value"], 0);
    for (const char* name : {"cpu_migrations", "cycles", "instructions", "llc_loads", "dtlb_load_misses"})
      EXPECT_EQ(counts[name], std::string("unavailable: perf_event_open: ") + words) << name;
  }
}

TEST(PerfCounters, HardwareIsCountedOutsideTheKernelWhereThatAloneIsAllowed) {
  const TemporaryFolder folder;
  const std::uint64_t reading[] = {7, 5, 5};
  const std::string path = folder.write("reading", {reinterpret_cast<const char*>(reading), sizeof(reading)});
  const PerfCounters counters(CounterKinds::kSoftwareAndHardware, [&](perf_event_attr& attributes) {
    return attributes.exclude_kernel ? open(path.c_str(), O_RDONLY | O_CLOEXEC) : -EACCES;
  });
  const Json counts = to_json(counters.read(run_shell("exit 0")));
  EXPECT_EQ(counts["cycles"], Json({{"value", 7}, {"source", "perf_event, user mode"}}));
  EXPECT_EQ(counts["context_switches"]["source"], "getrusage") << "those happen in the kernel";
}

TEST(PerfCounters, CountsOfAShareOfTheTimeAreScaledAndSaySo) {
  const TemporaryFolder folder;
  const auto read_as = [&](std::vector<std::uint64_t> count_enabled_running) {
    const std::string path = folder.write(
        "reading",
        {reinterpret_cast<const char*>(count_enabled_running.data()), 8 * count_enabled_running.size()});
    const PerfCounters counters(CounterKinds::kSoftware,
                                [&](perf_event_attr&) { return open(path.c_str(), O_RDONLY | O_CLOEXEC); });
    return to_json(counters.read(run_shell("exit 0")))["page_faults"];
  };
  EXPECT_EQ(read_as({100, 40, 40}), Json({{"value", 100}, {"source", "perf_event"}}));
  EXPECT_EQ(read_as({100, 40, 10}),
            Json({{"value", 400.0}, {"source", "perf_event"}, {"running_share", 0.25}}));
  for (const auto& none : {std::vector<std::uint64_t>{0, 40, 0}, {}})
    EXPECT_TRUE(read_as(none).get<std::string>().starts_with("unavailable: ")) << none.size();
}

TEST(PerfCounters, ProcessThatDidNotStartHasNoCounts) {
  const PerfCounters counters(CounterKinds::kSoftware);
  const Json counts = to_json(counters.read(run_process(
      {.arguments = {"/no/such/program"}, .stdout_path = {}, .stderr_path = {}, .timeout_s = 1})));
  for (const auto& [name, count] : counts.items())
    EXPECT_EQ(count, "unavailable: the process did not start") << name;
}

}  // namespace
}  // namespace podm::bench
