// A finished run of podm mesh, or of podm-mpi mesh: what its summary and its record tell of.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/options/options.h"
#include "cli/reports/appended_file.h"
#include "podm/label_image.h"
#include "podm/mesh_image.h"

namespace podm::cli {

/// Facets between two labels.
struct FacetCount {
  std::array<LabelIndex, 2> labels;
  std::uint64_t facets = 0;
};

/// What the mesh has, wherever its parts are.
struct MeshNumbers {
  std::uint64_t cells = 0, vertices = 0, boundary_facets = 0;
  std::vector<FacetCount> facet_pairs;  ///< one count for each pair of labels, most facets first
};
MeshNumbers numbers_of(const TetMesh& mesh);
/// Adds up counts of the same pair.
std::vector<FacetCount> sums_of(const std::vector<FacetCount>& counts);

struct MeshRun {
  const MeshCommand& command;
  const LabelImage& image;
  MeshingOptions options;  ///< as handed to mesh_image()
  MeshingReport report;
  MeshNumbers mesh;
  std::string mesh_sha256;  ///< empty: nobody has the whole mesh
  double read_s = 0, write_s = 0;
  std::uint64_t peak_rss_bytes = 0;
  nlohmann::ordered_json verification = nullptr;  ///< what podm-verify reports; null: nothing
  std::string program = "podm";
  nlohmann::ordered_json ranks = nullptr;  ///< for the record; null: the mesh was made in one process
  std::string ranks_text = {};             ///< the same for the summary

  /// Takes over what mesh_image() returned of this run, and adds the warnings of the image.
  void take(MeshingReport&& finished, const TetMesh& made);
  /// Seconds by phase: those of the library between "read" ("draw" where a phantom was drawn) and "write".
  std::map<std::string, double> phases_s() const;
  /// The elements per second of the paper's eq. (1): cells over the seconds of all phases but measuring,
  /// writing, the drawing of a phantom, calibration, and R7 and optimisation, which that paper does not have.
  double cells_per_second() const;
  double refine_cells_per_second() const;
  /// Those of podm-verify by claim; none where it reports nothing.
  std::map<std::string, std::string> verdicts() const;
  /// One sentence for each guarantee or limit that is unmet; none: the run is a success.
  std::vector<std::string> unmet() const;
};

/// Appends the record and prints summary, statistics, warnings and what is unmet, as the command asks. The
/// exit code.
int tell(const MeshRun& run, std::optional<AppendedFile>& records);

}  // namespace podm::cli
