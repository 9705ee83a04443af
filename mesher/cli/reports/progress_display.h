// Shows a run's progress: a bar on a terminal, occasional lines elsewhere, JSON for programs.
#pragma once

#include <cstdio>
#include <string>

#include "podm/mesh_image.h"

namespace podm::cli {

class ProgressDisplay {
 public:
  enum class Style { kNone, kBar, kLines, kJson };
  /// Returns kBar if `stream` is a terminal that can redraw a line, otherwise kLines.
  static Style style_for(std::FILE* stream);

  ProgressDisplay(std::FILE* stream, Style style) : stream_(stream), style_(style) {}
  /// Removes the bar from the screen.
  ~ProgressDisplay();
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  void show(const Progress& progress);

 private:
  std::FILE* stream_;
  Style style_;
  std::string phase_;       // phase of the last line
  double next_line_s_ = 0;  // kLines: time of the next line
};

}  // namespace podm::cli
