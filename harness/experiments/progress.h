// Prints the progress of a run and its remaining time on stderr.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace podm::bench {

/// The remaining time: the expected seconds, scaled by the ratio of measured to expected seconds so far.
class RemainingTime {
 public:
  /// Takes the expected seconds of each turn, in their order.
  explicit RemainingTime(std::vector<std::optional<double>> expected_s);

  void finish_turn(double seconds);
  /// Returns nothing if no duration is known. `elapsed_s` are the seconds of the current turn so far.
  std::optional<double> seconds(double elapsed_s) const;

 private:
  std::vector<double> weights_;  // seconds; 1 each if none is known
  bool are_seconds_ = false;
  std::size_t num_finished_ = 0;
  double finished_s_ = 0, finished_weight_ = 0;
};

/// Prints one line per turn; on a terminal, also a line below it that counts the seconds.
class Progress {
 public:
  explicit Progress(std::vector<std::optional<double>> expected_s);

  void start_turn(const std::string& label);
  /// Shows the step that runs before the turn's own process; empty: the steps are over.
  void show_step(const std::string& step);
  void tick();
  void finish_turn(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  double elapsed_s() const;
  std::string remaining_text(double elapsed_s) const;

  RemainingTime remaining_;
  std::size_t num_turns_, num_started_ = 0;
  std::string label_, step_;
  Clock::time_point start_, drawn_;
  bool is_terminal_;
};

/// "about 40 s", "about 12 min", "about 3.5 h".
std::string print_duration(double seconds);

}  // namespace podm::bench
