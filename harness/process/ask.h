// The one way to ask another program a question: run it to its end and take what it prints for an answer.
#pragma once

#include <string>
#include <vector>

#include "process/process.h"

namespace podm::bench {

struct Reply {
  std::string text;      ///< what it printed to stdout, without line ends at its end; at most the last 1 MiB
  std::string messages;  ///< the last 2000 bytes that it printed to stderr
  ProcessOutcome outcome;

  bool succeeded() const { return outcome.succeeded(); }
  /// `messages` in one line.
  std::string complaint() const;
  /// How a program that did not succeed ended, and its complaint.
  std::string why_not() const;
};

inline constexpr double kReplyTimeoutS = 30;

/// Runs the program `arguments.front()`, which is looked up in PATH unless it has a slash; kills it after
/// `timeout_s` seconds and on a stop request. Leaves no file behind. Throws std::system_error when memory for
/// the answer is not to be had.
Reply ask(const std::vector<std::string>& arguments, double timeout_s = kReplyTimeoutS,
          const StopQuery& stop_requested = {});

}  // namespace podm::bench
