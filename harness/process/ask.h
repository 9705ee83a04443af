// Runs another program to its end and returns its output, for example its version or the size of an image.
#pragma once

#include <string>
#include <vector>

#include "process/process.h"

namespace podm::bench {

struct Reply {
  std::string text;      ///< standard output without line ends at its end; at most the last 1 MiB
  std::string messages;  ///< the last 2000 bytes of standard error
  ProcessOutcome outcome;

  bool succeeded() const { return outcome.succeeded(); }
  /// Returns `messages` in one line.
  std::string error_text() const;
  /// Describes the end of a program that did not succeed, with its error text.
  std::string failure_text() const;
};

inline constexpr double kReplyTimeoutS = 30;

/// Runs the program `arguments.front()`, which is looked up in PATH unless it contains a slash. Kills it
/// after `timeout_s` seconds and on a stop request. Leaves no file behind. Throws std::system_error when
/// there is no memory for the answer.
Reply ask(const std::vector<std::string>& arguments, double timeout_s = kReplyTimeoutS,
          const StopQuery& stop_requested = {});

}  // namespace podm::bench
