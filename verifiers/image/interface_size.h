// A bound on cells near the interface between two groups of labels, as an option states it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace podm::verify {

struct InterfaceSize {
  std::string text;                                  ///< as in the option
  std::array<std::vector<std::uint32_t>, 2> labels;  ///< on either side, one or more; 0 is the background
  double radius_mm = 0, width_mm = 0;
};

/// Parses "3,0=1" or "2+3,4=0.5:2": labels of either side, a length in mm and a width. The width is the
/// length if it is not given. Throws InputError.
InterfaceSize parse_interface_size(const std::string& text);

}  // namespace podm::verify
