// Which of an image's labels were meshed, and under which value: the selection that `podm mesh` was given,
// read and applied by the verifier's own code.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "image/image.h"

namespace podm::verify {

struct LabelSelection {
  using Ranges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  ///< closed

  std::uint32_t background = 0;                      ///< its value in the mesh and the image
  Ranges keep{}, drop{};                             ///< no range to keep: all are kept
  std::vector<std::vector<std::uint32_t>> merges{};  ///< each to one label, with the first of its values
  double drop_islands_mm3 = 0;                       ///< see image/islands.h; 0: none are dropped

  bool operator==(const LabelSelection&) const = default;
};

/// Parses "7". Throws InputError that names `option`.
std::uint32_t parse_label(std::string_view text, const std::string& option);
/// Parses "1,3-7". Throws InputError that names `option`.
LabelSelection::Ranges parse_label_ranges(const std::string& text, const std::string& option);
/// Parses "2,3=kidney"; the name is not kept, since no claim is about names. Throws InputError.
std::vector<std::uint32_t> parse_merge(const std::string& text);

/// Labels that are dropped or not kept become background, 0; of the rest, those merged become one. A
/// background of another value and 0 change places, as in `move_background`. Throws InputError when a value
/// asked for by itself has no voxel or is the background, when one is merged twice, and when no label is
/// left, islands dropped.
void select_labels(Image& image, const LabelSelection& selection);

/// Makes 0 the background in a mesh whose file gives it the value `background`: the two change places.
void move_background(Mesh& mesh, std::uint32_t background);

}  // namespace podm::verify
