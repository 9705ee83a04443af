// Tests of programs that answer, fail, hang, are absent, or print too much.
#include "process/ask.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/temporary_folder.h"

namespace podm::bench {
namespace {

Reply ask_shell(const std::string& script, double timeout_s = 20) {
  return ask({"sh", "-c", script}, timeout_s);
}

TEST(Ask, TakesWhatAProgramPrintsWithoutItsLastLineEnds) {
  const Reply reply = ask_shell("echo one; echo two; echo; echo aside >&2");
  EXPECT_TRUE(reply.succeeded());
  EXPECT_EQ(reply.text, "one\ntwo");
  EXPECT_EQ(reply.messages, "aside\n");
  EXPECT_EQ(ask_shell("true").text, "");
}

TEST(Ask, ReportsWhyThereIsNoAnswer) {
  const Reply failed = ask_shell("echo half; echo no such >&2; echo image >&2; exit 3");
  EXPECT_FALSE(failed.succeeded());
  EXPECT_EQ(failed.text, "half");
  EXPECT_EQ(failed.failure_text(), "exit code 3: no such; image");
  EXPECT_EQ(ask_shell("kill -KILL $$").failure_text().rfind("killed by signal 9", 0), 0u);
  EXPECT_NE(ask({"/absent/program"}).failure_text().find("/absent/program"), std::string::npos);
  EXPECT_EQ(ask_shell("sleep 30", 0.1).failure_text().rfind("timed out", 0), 0u);
}

TEST(Ask, StopsOnRequest) {
  const Reply reply = ask({"sleep", "30"}, 20, [] { return true; });
  EXPECT_EQ(reply.outcome.end, ProcessOutcome::End::kInterrupted);
}

TEST(Ask, KeepsTheEndOfWhatIsTooLong) {
  const Reply reply =
      ask_shell("head -c 3000000 /dev/zero | tr '\\0' a; echo b; head -c 5000 /dev/zero | tr '\\0' c >&2");
  EXPECT_EQ(reply.text.size(), (std::size_t{1} << 20) - 1) << "and a line end that is taken off";
  EXPECT_TRUE(reply.text.ends_with("ab"));
  EXPECT_EQ(reply.messages, std::string(2000, 'c'));
}

TEST(Ask, LeavesNothingBehind) {
  const TemporaryFolder folder;
  const char* before = std::getenv("TMPDIR");
  const std::string old = before == nullptr ? "" : before;
  setenv("TMPDIR", folder.path().c_str(), 1);
  ask_shell("echo text");
  old.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", old.c_str(), 1);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace podm::bench
