// An image as the command line specifies it: selected and named labels.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cli/options/options.h"
#include "podm/label_image.h"
#include "podm/meshing_options.h"

namespace podm::cli {

/// Reads the table of labels, if there is one, and the image. `threads` and `most_bytes` are those of
/// read_image().
LabelImage read_labelled_image(const ImageArguments& arguments, int threads = 0,
                               std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Returns the selection with the names and colours of the table.
LabelSelection with_table(const ImageArguments& arguments);

/// Returns lengths by label value. A name stands for every label with this name. Throws InputError that names
/// `image_path` if a label is absent.
std::map<std::uint32_t, double> lengths_by_value(
    const std::vector<std::pair<std::string, double>>& lengths_mm, const LabelImage& image,
    const std::string& image_path);

/// Returns the bounds with labels by value, including the background. Throws as lengths_by_value() does.
std::vector<InterfaceSize> near_by_value(const std::vector<NearLabels>& near, const LabelImage& image,
                                         const std::string& image_path);

/// Returns the volume of a voxel in the world: the product of the spacings only where the axes are
/// orthogonal.
double voxel_volume_mm3(const LabelImage& image);

/// Returns the name of a label, or "label 7" with its value if it has no name.
std::string display_name(const Label& label);

}  // namespace podm::cli
