// --values: images of values, read before the run, and their values on the cells of the mesh.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/options/options.h"
#include "podm/cell_values.h"
#include "podm/label_image.h"
#include "podm/tet_mesh.h"

namespace podm::cli {

/// Values of an image on the cells of a mesh.
struct ValuesOnCells {
  std::string name, path;
  CellValuesReport report;
};

class ImagesOfValues {
 public:
  /// Reads the images of the command, in at most `most_bytes` each. Throws InputError that names the option
  /// or the file if the mesh file cannot hold values, if two arrays would have one name, or if an image lies
  /// apart from the image that is meshed.
  ImagesOfValues(const MeshCommand& command, const LabelImage& image, std::uint64_t most_bytes);

  /// Adds the arrays to the mesh, which has its final order of cells. Throws as add_cell_values() does.
  std::vector<ValuesOnCells> add_to(TetMesh& mesh) const;
  /// Returns the unusual properties of the files.
  std::vector<std::string> warnings() const;

 private:
  const MeshCommand& command_;
  const LabelImage& image_;
  std::vector<ValueImage> images_;  // in the order of the options
};

}  // namespace podm::cli
