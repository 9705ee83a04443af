// Selects the labels of an image that are kept, and their final order.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "podm/image_io.h"

namespace podm {

/// True if the selection keeps the value and does not drop it. The background counts as kept.
bool is_kept(const LabelSelection& selection, std::uint32_t value);

/// As select_labels() without islands, for an image that does not hold its voxels. `present` are the values
/// that voxels have. Returns the new index of each old label.
std::vector<LabelIndex> select_among(LabelImage& image, const LabelSelection& selection,
                                     const std::set<std::uint32_t>& present, const std::string& path);

/// Takes an image whose voxels index `labels` in any order. Leaves the background first, followed by the
/// labels that have voxels and that the selection keeps, by value. Names and colours of the table come first,
/// then keeping and dropping, then merging; islands are dropped last. Throws InputError naming `path` if a
/// value that is given by itself is absent, a merge is contradictory, the volume of islands is invalid, or
/// nothing is left.
void select_labels(LabelImage& image, const LabelSelection& selection, const std::string& path,
                   std::size_t threads);

}  // namespace podm
