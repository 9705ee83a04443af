// The labels in mesh files: a printable name for each, their colours, and the pairs of labels that facets
// separate.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "podm/tet_mesh.h"

namespace podm {

using LabelPair = std::array<LabelIndex, 2>;  ///< as in TetMesh::facet_labels

/// Distinct names in UTF-8 without quotes, bars or control characters. A label without a name is called
/// "label 3" after its value; the background is called "outside".
class LabelNames {
 public:
  explicit LabelNames(const std::vector<Label>& labels);
  const std::string& operator[](LabelIndex label) const { return names_[label]; }
  /// Returns the name of the label, then that of the label on its other side: "kidney|outside",
  /// "liver|kidney".
  std::string of_pair(const LabelPair& pair) const;
  /// Returns the names of the labels of a line, the background's last: "liver|kidney|outside".
  std::string of_line(const std::vector<LabelIndex>& labels) const;

 private:
  std::vector<std::string> names_;
};

/// The name of the array of colours in VTK's files, and its numbers: value, red, green and blue of each label
/// that has a colour, without the background.
inline constexpr const char* kColourArray = "label_colours";
std::vector<std::array<std::uint32_t, 4>> colours_of(const std::vector<Label>& labels);

/// The distinct pairs among the facets of a mesh, sorted; a pair's number is its position.
class LabelPairs {
 public:
  explicit LabelPairs(const std::vector<LabelPair>& facet_labels);
  std::size_t size() const { return pairs_.size(); }
  const LabelPair& operator[](std::size_t number) const { return pairs_[number]; }
  std::size_t number_of(const LabelPair& pair) const;

 private:
  std::vector<LabelPair> pairs_;
};

}  // namespace podm
