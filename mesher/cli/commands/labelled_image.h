// An image as the command line specifies it: selected labels, named from a table.
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

/// Reads the image and gives names from the table to labels without a name. `threads` and `most_bytes` are
/// those of read_image().
LabelImage read_labelled_image(const ImageArguments& arguments, int threads = 0,
                               std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// Gives names to labels without a name.
void name_labels(LabelImage& image, const std::map<std::uint32_t, std::string>& names);

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
