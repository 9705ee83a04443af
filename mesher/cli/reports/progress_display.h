// Shows a run's progress: a bar on a terminal, now and then a line elsewhere.
#pragma once

#include <cstdio>
#include <string>

#include "podm/mesh_image.h"

namespace podm::cli {

class ProgressDisplay {
 public:
  enum class Style { kNone, kBar, kLines };
  /// kBar if `stream` is a terminal that can redraw a line, else kLines.
  static Style style_for(std::FILE* stream);

  ProgressDisplay(std::FILE* stream, Style style) : stream_(stream), style_(style) {}
  /// Takes the bar off the screen.
  ~ProgressDisplay();
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  void show(const Progress& progress);

 private:
  std::FILE* stream_;
  Style style_;
  std::string phase_;       // the one that the last line told of
  double next_line_s_ = 0;  // kLines: when the next one is due
};

}  // namespace podm::cli
