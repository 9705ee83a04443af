// The reports of a run: lines for the terminal, JSON for programs, the cells in violation for a viewer.
#pragma once

#include <string>
#include <vector>

#include "run_claims.h"

namespace podm::verify {

/// Returns one line per claim, with the worst witness of each claim that fails, and a summary. `seconds` is
/// the time of the run from its beginning, reading included.
std::string terminal_report(const Inputs& inputs, const Options& options,
                            const std::vector<ClaimResult>& results, double seconds);

/// Returns the most memory that this process has had.
std::uint64_t peak_resident_bytes();

/// Returns JSON of schema podm-verify/1 (results/schema/podm-verify.schema.json). Numbers that are not finite
/// become null, and bytes of names that are not UTF-8 are replaced.
std::string json_report(const Inputs& inputs, const Options& options, const std::vector<ClaimResult>& results,
                        double seconds, std::uint64_t peak_bytes);

/// A cell that violates some claim.
struct BadCell {
  GlobalId id = 0;
  std::array<Point, 4> points{};
  LabelValue label = 0;
  std::uint64_t claims = 0;  ///< bit i: it violates the i-th of the results
};
/// Collective. Returns on the first rank the cells of all ranks that violate some claim, ascending; those
/// without all their vertices cannot be drawn and are left out.
std::vector<BadCell> find_bad_cells(const Mesh& mesh, const std::vector<ClaimResult>& results);

/// Writes these cells as VTU, appended raw. Its cell arrays are `cell` (position in the mesh), `label`, and
/// one of 0 and 1 for each claim that fails. The file appears whole or not at all. Throws InputError.
void write_bad_cells(const std::string& path, const std::vector<BadCell>& cells,
                     const std::vector<ClaimResult>& results);

/// Writes `text` to a file, whole or not at all, or to standard output for "-". A device or a pipe is written
/// directly. Throws InputError.
void write_text(const std::string& path, const std::string& text);

}  // namespace podm::verify
