#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <thread>

#include "process/process.h"
#include "tests/temporary_folder.h"

namespace podm::bench {
namespace {

using End = ProcessOutcome::End;

ProcessRequest shell(const std::string& command) {
  return {.arguments = {"/bin/sh", "-c", command}, .stdout_path = {}, .stderr_path = {}, .timeout_s = 20};
}

TEST(Process, ExitCodeIsReported) {
  for (const int code : {0, 1, 2, 77}) {
    const ProcessOutcome outcome = run_process(shell("exit " + std::to_string(code)));
    EXPECT_EQ(outcome.end, End::kExited);
    EXPECT_EQ(outcome.exit_code, code);
    EXPECT_EQ(outcome.succeeded(), code == 0);
  }
}

TEST(Process, DeathBySignalIsDistinguishedFromAnExit) {
  const ProcessOutcome outcome = run_process(shell("kill -SEGV $$"));
  EXPECT_EQ(outcome.end, End::kSignalled);
  EXPECT_EQ(outcome.signal, SIGSEGV);
  EXPECT_FALSE(outcome.succeeded());
}

TEST(Process, MissingProgramIsNamedAndNothingIsMeasured) {
  const ProcessOutcome outcome =
      run_process({.arguments = {"/no/such/program"}, .stdout_path = {}, .stderr_path = {}, .timeout_s = 1});
  EXPECT_EQ(outcome.end, End::kNotStarted);
  EXPECT_NE(outcome.describe().find("/no/such/program"), std::string::npos);
  EXPECT_EQ(outcome.peak_rss_bytes, 0u);
}

TEST(Process, FileThatCannotBeWrittenIsNoSilentLoss) {
  ProcessRequest request = shell("exit 0");
  request.stderr_path = "/no/such/folder/err";
  EXPECT_EQ(run_process(request).end, End::kNotStarted);
}

TEST(Process, MemoryLimitEndsTheChild) {
  ProcessRequest request = shell("exec dd if=/dev/zero of=/dev/null count=1000 bs=300M");
  request.memory_limit_bytes = 100 << 20;
  const ProcessOutcome outcome = run_process(request);
  EXPECT_EQ(outcome.end, End::kOutOfMemory);
  // Each processor counts pages in batches before the kernel adds them up.
  constexpr std::uint64_t kBatches = 1 << 20;
  EXPECT_GT(outcome.peak_rss_bytes + kBatches, request.memory_limit_bytes);
  request.arguments.back() = "exit 0";
  EXPECT_TRUE(run_process(request).succeeded());
}

TEST(Process, OutputsGoToTheirFilesAndArgumentsArriveVerbatim) {
  const TemporaryFolder folder;
  const ProcessOutcome outcome =
      run_process({.arguments = {"/bin/sh", "-c", "echo \"$1\"; echo two >&2", "sh", "a  'b\" $c"},
                   .stdout_path = folder / "out",
                   .stderr_path = folder / "err",
                   .timeout_s = 20});
  EXPECT_TRUE(outcome.succeeded());
  EXPECT_EQ(read_tail(folder / "out", 100), "a  'b\" $c\n");
  EXPECT_EQ(read_tail(folder / "err", 100), "two\n");
}

TEST(Process, TimeLimitKillsTheChildAndItsChildren) {
  const TemporaryFolder folder;
  ProcessRequest request = shell("sleep 30 & echo $! > '" + (folder / "grandchild") + "'; wait");
  request.timeout_s = 0.3;
  const ProcessOutcome outcome = run_process(request);
  EXPECT_EQ(outcome.end, End::kTimedOut);
  EXPECT_GE(outcome.wall_s, 0.3);
  EXPECT_LT(outcome.wall_s, 10);
  // The grandchild is gone, or it is a zombie that its new parent has not waited for yet.
  const std::string grandchild = read_tail(folder / "grandchild", 20);
  ASSERT_FALSE(grandchild.empty());
  const std::string stat_path = "/proc/" + std::to_string(std::stoi(grandchild)) + "/stat";
  const auto is_running = [&] {
    const std::string stat = read_tail(stat_path, 1000);
    return !stat.empty() && stat.find(") Z") == std::string::npos;
  };
  for (int tries = 0; tries < 100 && is_running(); ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_FALSE(is_running());
}

TEST(Process, EndIsSeenWhenNoDescriptorIsLeft) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit few = before;
  few.rlim_cur = 64;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  std::vector<int> taken;  // the child's copies are closed when it executes its program
  for (int file; (file = open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0;) taken.push_back(file);
  const int error = errno;
  const ProcessOutcome outcome = run_process(shell("exit 3"));
  for (const int file : taken) close(file);
  setrlimit(RLIMIT_NOFILE, &before);
  ASSERT_EQ(error, EMFILE);
  EXPECT_EQ(outcome.end, End::kExited);
  EXPECT_EQ(outcome.exit_code, 3);
}

TEST(Process, StopRequestEndsTheChildEarly) {
  int asked = 0;
  const ProcessOutcome outcome = run_process(shell("sleep 30"), [&] { return ++asked == 3; });
  EXPECT_EQ(outcome.end, End::kInterrupted);
  EXPECT_LT(outcome.wall_s, 10);
}

TEST(Process, WallAndProcessorTimeAreDistinguished) {
  const ProcessOutcome asleep = run_process(shell("sleep 0.5"));
  EXPECT_GE(asleep.wall_s, 0.5);
  EXPECT_LT(asleep.user_s + asleep.system_s, 0.4);
  const ProcessOutcome busy = run_process(shell("i=0; while [ $i -lt 300000 ]; do i=$((i+1)); done"));
  EXPECT_GT(busy.user_s, 0.02);
}

TEST(Process, PeakMemoryIsThatOfTheChildAlone) {
  const std::uint64_t mib = 1024 * 1024;
  // dd holds one block in memory and touches all of it.
  const auto block_of = [](int size_mib) {
    return shell("dd if=/dev/zero of=/dev/null count=1 bs=" + std::to_string(size_mib) + "M");
  };
  EXPECT_GT(run_process(block_of(200)).peak_rss_bytes, 200 * mib);
  EXPECT_LT(run_process(block_of(1)).peak_rss_bytes, 100 * mib);  // the first child's peak does not count
}

TEST(ReadTail, GivesTheEndAndNothingForAMissingFile) {
  const TemporaryFolder folder;
  const std::string path = folder.write("text", "0123456789");
  EXPECT_EQ(read_tail(path, 4), "6789");
  EXPECT_EQ(read_tail(path, 100), "0123456789");
  EXPECT_EQ(read_tail(folder / "absent", 4), "");
}

}  // namespace
}  // namespace podm::bench
