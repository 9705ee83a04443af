// The selection of an image's labels that `podm mesh` was given: the meshed labels and their values. It is
// parsed and applied by the verifier's own code.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "image/image.h"

namespace podm::verify {

struct LabelSelection {
  using Ranges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  ///< closed intervals

  std::uint32_t background = 0;                      ///< its value in the mesh and the image
  Ranges keep{}, drop{};                             ///< no range to keep: all are kept
  std::vector<std::vector<std::uint32_t>> merges{};  ///< each becomes one label with the first of its values
  std::vector<std::size_t> layers{};                 ///< see image/segmentation.h; none: all
  double drop_islands_mm3 = 0;                       ///< see image/islands.h; 0: none are dropped

  bool operator==(const LabelSelection&) const = default;
};

/// Parses "7". Throws InputError that names `option`.
std::uint32_t parse_label(std::string_view text, const std::string& option);
/// Parses "1,3-7". Throws InputError that names `option`.
LabelSelection::Ranges parse_label_ranges(const std::string& text, const std::string& option);
/// Parses "1,0". Throws InputError that names `option`.
std::vector<std::size_t> parse_layers(const std::string& text, const std::string& option);
/// Parses "2,3=kidney". The name is not kept, since no claim is about names. Throws InputError.
std::vector<std::uint32_t> parse_merge(const std::string& text);

/// Returns true for the background and for labels that are neither dropped nor left out.
bool keeps(const LabelSelection& selection, std::uint32_t value);

/// Applies the selection to the image. Labels that are dropped or not kept become background, 0. Merged
/// labels become one. A background of another value and 0 change places, as in move_background(). Throws
/// InputError if a value named by itself has no voxel or is the background, if a value is merged twice, or if
/// no label is left once islands are dropped.
void select_labels(Image& image, const LabelSelection& selection);

/// Makes 0 the background of a mesh whose file gives it the value `background`: the two values change places.
void move_background(Mesh& mesh, std::uint32_t background);

}  // namespace podm::verify
