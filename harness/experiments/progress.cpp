#include "experiments/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace podm::bench {
namespace {

constexpr std::chrono::seconds kRedraw{1};
constexpr const char* kClearLine = "\r\033[K";

}  // namespace

RemainingTime::RemainingTime(std::vector<std::optional<double>> expected_s) {
  double known_s = 0;
  std::size_t num_known = 0;
  for (const auto& seconds : expected_s) {
    known_s += seconds.value_or(0);
    num_known += seconds.has_value();
  }
  are_seconds_ = num_known > 0;
  const double otherwise = are_seconds_ ? known_s / static_cast<double>(num_known) : 1;
  for (const auto& seconds : expected_s) weights_.push_back(seconds.value_or(otherwise));
}

void RemainingTime::finish_turn(double seconds) {
  finished_s_ += seconds;
  finished_weight_ += weights_[num_finished_++];
}

std::optional<double> RemainingTime::seconds(double elapsed_s) const {
  if (!are_seconds_ && num_finished_ == 0) return {};
  const double scale = finished_weight_ > 0 ? finished_s_ / finished_weight_ : 1;
  double seconds = 0;
  for (std::size_t turn = num_finished_; turn < weights_.size(); ++turn) seconds += scale * weights_[turn];
  const double running_s = num_finished_ < weights_.size() ? scale * weights_[num_finished_] : 0;
  return seconds - std::min(elapsed_s, running_s);
}

Progress::Progress(std::vector<std::optional<double>> expected_s)
    : remaining_(expected_s), num_turns_(expected_s.size()), is_terminal_(isatty(STDERR_FILENO) == 1) {}

void Progress::start_turn(const std::string& label) {
  ++num_started_;
  label_ = label;
  step_.clear();
  start_ = Clock::now();
  drawn_ = start_ - kRedraw;
  tick();
}

void Progress::show_step(const std::string& step) {
  step_ = step.empty() ? "" : ": " + step;
  drawn_ = start_ - kRedraw;
  tick();
  if (!is_terminal_ && !step.empty())
    fmt::print(stderr, "[{}/{}] {}{}\n", num_started_, num_turns_, label_, step_);
}

void Progress::tick() {
  if (!is_terminal_ || Clock::now() - drawn_ < kRedraw) return;
  drawn_ = Clock::now();
  fmt::print(stderr, "{}[{}/{}] {}{}: {:.0f} s{}", kClearLine, num_started_, num_turns_, label_, step_,
             elapsed_s(), remaining_text(elapsed_s()));
  std::fflush(stderr);
}

void Progress::finish_turn(const std::string& line) {
  remaining_.finish_turn(elapsed_s());
  fmt::print(stderr, "{}[{}/{}] {}{}\n", is_terminal_ ? kClearLine : "", num_started_, num_turns_, line,
             num_started_ < num_turns_ ? remaining_text(0) : "");
}

double Progress::elapsed_s() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

std::string Progress::remaining_text(double elapsed_s) const {
  const auto seconds = remaining_.seconds(elapsed_s);
  return seconds ? fmt::format("; {} left", print_duration(*seconds)) : "";
}

std::string print_duration(double seconds) {
  constexpr double kMinute = 60, kHour = 3600;
  if (seconds < 2 * kMinute) return fmt::format("about {:.0f} s", seconds);
  if (seconds < 2 * kHour) return fmt::format("about {:.0f} min", seconds / kMinute);
  return fmt::format("about {:.1f} h", seconds / kHour);
}

}  // namespace podm::bench
