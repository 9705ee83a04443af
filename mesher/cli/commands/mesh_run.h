// A finished run of podm mesh or podm-mpi mesh: the data of its summary and its record.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/commands/values_on_cells.h"
#include "cli/options/options.h"
#include "cli/reports/appended_file.h"
#include "podm/label_image.h"
#include "podm/mesh_image.h"

namespace podm::cli {

/// Number of facets between two labels.
struct FacetCount {
  std::array<LabelIndex, 2> labels;
  std::uint64_t facets = 0;
};

/// Numbers of the whole mesh, also if ranks hold pieces of it.
struct MeshNumbers {
  std::uint64_t cells = 0, vertices = 0, boundary_facets = 0;
  std::vector<FacetCount> facet_pairs;  ///< one count per pair of labels, most facets first
};
MeshNumbers numbers_of(const TetMesh& mesh);
/// Adds up counts of the same pair.
std::vector<FacetCount> sums_of(const std::vector<FacetCount>& counts);

/// JSON that is complete. A pointer needs no definition of the type.
using JsonPointer = std::shared_ptr<const nlohmann::ordered_json>;

struct MeshRun {
  const MeshCommand& command;
  const LabelImage& image;
  MeshingOptions options;  ///< as handed to mesh_image()
  MeshingReport report;
  MeshNumbers mesh;
  std::string mesh_sha256;  ///< empty: no process holds the whole mesh
  double read_s = 0, values_s = 0, write_s = 0;
  std::vector<ValuesOnCells> values = {};
  std::uint64_t peak_rss_bytes = 0;
  JsonPointer verification = nullptr;  ///< report of podm-verify; null: none
  std::string program = "podm";
  JsonPointer ranks = nullptr;  ///< for the record; null: one process made the mesh
  std::string ranks_text = {};  ///< for the summary

  /// Takes over what mesh_image() returned of this run, and adds the warnings of the image.
  void take(MeshingReport&& finished, const TetMesh& made);
  /// Returns the seconds by phase: those of the library, "read" (or "draw" for a phantom), "values" and
  /// "write".
  std::map<std::string, double> phases_s() const;
  /// Returns the elements per second of the paper's eq. (1): cells over the seconds of all phases except
  /// measuring, writing, drawing a phantom, calibration, R7 and optimisation. R7 and optimisation are not in
  /// that paper.
  double cells_per_second() const;
  double refine_cells_per_second() const;
  /// Returns the verdicts of podm-verify by claim; empty if there is no report.
  std::map<std::string, std::string> verdicts() const;
  /// Returns one sentence for each guarantee or limit that the run misses; empty: the run is a success.
  std::vector<std::string> unmet() const;
};

/// Appends the record and prints summary, statistics, warnings and missed guarantees, as the command
/// specifies. Returns the exit code.
int report(const MeshRun& run, std::optional<AppendedFile>& records);

}  // namespace podm::cli
