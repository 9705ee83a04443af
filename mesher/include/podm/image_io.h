// Where label images come from: files, phantoms, and what is kept of them.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "podm/label_image.h"

namespace podm {

/// Which labels of an image are kept, and under which value. Values are those stored in the file.
struct LabelSelection {
  std::uint32_t background = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> keep;  ///< closed ranges; empty: all
  std::vector<std::pair<std::uint32_t, std::uint32_t>> drop;  ///< closed ranges
  struct Merge {
    std::vector<std::uint32_t> values;  ///< become one label with the first of these values
    std::string name;
  };
  std::vector<Merge> merges;
};

/// Parses "1,3-7". Throws InputError naming `option` and the fault.
std::vector<std::pair<std::uint32_t, std::uint32_t>> parse_label_ranges(const std::string& text,
                                                                        const std::string& option);
/// Parses "2,3=kidney".
LabelSelection::Merge parse_merge(const std::string& text);

/// Reads label names: ITK-SNAP tables, or lines "value name ..." as in aal.nii.txt.
std::map<std::uint32_t, std::string> read_label_names(const std::string& path);

/// Reads NIfTI, NRRD, MetaImage, INR (each .gz where usual), or "phantom:NAME[@SIZE]".
/// Throws InputError naming the file and the fault. Labels are sorted by value. `threads`: 0 for all cores.
/// `most_bytes`: what a file's voxels and their labels may take together while they are read.
LabelImage read_image(const std::string& path, const LabelSelection& selection = {}, int threads = 0,
                      std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// The analytic phantoms: "abdomen", "spheres", "torus"; `size` voxels along the longest axis.
LabelImage make_phantom(const std::string& name, int size, int threads = 0);
std::vector<std::string> phantom_names();

/// Writes a NIfTI-1 label image (.nii or .nii.gz), whole or not at all.
void write_nifti(const LabelImage& image, const std::string& path);

}  // namespace podm
