#include "cli/reports/progress_display.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

#include "cli/reports/json_text.h"

namespace podm::cli {
namespace {

constexpr std::size_t kBarWidth = 30;
constexpr double kSecondsBetweenLines = 5;
constexpr const char* kEraseLine = "\r\x1b[K";

std::string describe(const Progress& progress) {
  std::string text = fmt::format("{:<10}{:4.0f} %", progress.phase, 100 * progress.fraction);
  if (progress.cells > 0) text += fmt::format("  {} cells", progress.cells);
  return text + fmt::format("  {:.1f} s", progress.seconds);
}

std::string bar(double fraction) {
  const auto filled = static_cast<std::size_t>(fraction * kBarWidth);
  return fmt::format("[{:#<{}}{:.<{}}] ", "", filled, "", kBarWidth - filled);
}

std::string json_of(const Progress& progress) {
  return json_line({{"phase", progress.phase},
                    {"fraction", progress.fraction},
                    {"cells", progress.cells},
                    {"seconds", progress.seconds}});
}

}  // namespace

ProgressDisplay::Style ProgressDisplay::style_for(std::FILE* stream) {
  const char* terminal = std::getenv("TERM");
  const bool can_redraw = terminal != nullptr && std::string_view(terminal) != "dumb";
  return can_redraw && ::isatty(::fileno(stream)) != 0 ? Style::kBar : Style::kLines;
}

ProgressDisplay::~ProgressDisplay() {
  if (style_ == Style::kBar && !phase_.empty()) std::fputs(kEraseLine, stream_);
}

void ProgressDisplay::show(const Progress& progress) {
  if (style_ == Style::kNone) return;
  Progress shown = progress;
  shown.fraction = std::clamp(progress.fraction, 0.0, 1.0);
  if (style_ == Style::kJson) {
    fmt::print(stream_, "{}", json_of(shown));
    std::fflush(stream_);
  } else if (style_ == Style::kBar) {
    fmt::print(stream_, "{}{}{}", kEraseLine, bar(shown.fraction), describe(shown));
    std::fflush(stream_);
  } else if (shown.phase != phase_ || shown.seconds >= next_line_s_) {
    fmt::print(stream_, "{}\n", describe(shown));
    next_line_s_ = shown.seconds + kSecondsBetweenLines;
  }
  phase_ = shown.phase;
}

}  // namespace podm::cli
