// A finished run of podm mesh: what its summary and its record tell of.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "cli/crossover.h"
#include "cli/options.h"
#include "podm/label_image.h"
#include "podm/mesh_image.h"

namespace podm::cli {

struct MeshRun {
  const MeshCommand& command;
  const LabelImage& image;
  MeshingOptions options;  ///< as handed to mesh_image()
  Crossover crossover;     ///< what --algorithm auto went by
  MeshingResult result;
  std::string mesh_sha256;
  double read_s = 0, write_s = 0;
  std::uint64_t peak_rss_bytes = 0;
  std::map<std::string, std::string> verdicts;  ///< podm-verify's by claim; empty: none were asked for

  /// Seconds by phase: those of the library between "read" ("draw" where a phantom was drawn) and "write".
  std::map<std::string, double> phases_s() const;
  /// The elements per second of the paper's eq. (1): cells over the seconds of all phases but measuring,
  /// writing, the drawing of a phantom and calibration.
  double cells_per_second() const;
  double refine_cells_per_second() const;
  /// One sentence for each guarantee or limit that is unmet; none: the run is a success.
  std::vector<std::string> unmet() const;
};

/// Facets between two labels.
struct FacetCount {
  std::array<LabelIndex, 2> labels;
  std::uint64_t facets = 0;
};
/// One count for each pair of labels, most facets first.
std::vector<FacetCount> count_facets(const TetMesh& mesh);

}  // namespace podm::cli
