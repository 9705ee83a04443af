// How far a run is and how long it will still take, on stderr.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace podm::bench {

/// The seconds still to come: those expected, in proportion to how true expectations were so far.
class RemainingTime {
 public:
  /// Takes the seconds of each turn, in their order.
  explicit RemainingTime(std::vector<std::optional<double>> expected_s);

  void finish_turn(double seconds);
  /// Empty while nothing is known. `elapsed_s` are the seconds of the turn that runs so far.
  std::optional<double> seconds(double elapsed_s) const;

 private:
  std::vector<double> weights_;  // seconds, or 1 each where none is known
  bool are_seconds_ = false;
  std::size_t num_finished_ = 0;
  double finished_s_ = 0, finished_weight_ = 0;
};

/// A line a turn; on a terminal, one below it that counts the seconds.
class Progress {
 public:
  explicit Progress(std::vector<std::optional<double>> expected_s);

  void start_turn(const std::string& label);
  /// What is done before the turn's own process runs; empty: that is over.
  void tell(const std::string& step);
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
