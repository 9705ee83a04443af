// Shell scripts that stand in for the mesher and its verifier.
#pragma once

#include <fmt/format.h>

#include <string>

#include "tests/temporary_folder.h"
#include "trials/preparation.h"

namespace podm::bench {

/// A claim for experiments that test something else. It comes last in the file.
inline const std::string kClaim = R"(
[[claims]]
name = "all-pass"
statement = "Every trial passes."
basis = "any"
kind = "share"
value = "passed"
at_least = 1.0
)";

/// An experiment on one image whose trial "some" has options and `repeats` rounds. `lines` are the options
/// and what follows the trial.
inline std::string experiment_of(int repeats, const std::string& image, const std::string& lines) {
  return fmt::format(R"(title = "Title"
claim = "Headline"
paper = "Table 7"
repeats = {}
[inputs.a]
image = "{}"
[[trials]]
name = "some"
input = "a"
{})",
                     repeats, image, lines);
}

/// The record of a healthy mesher: meshing takes 2 s, refinement makes `cells` cells per second, writing
/// takes 5 s.
inline const std::string kGoodRecord =
    R"({"schema":1,"input":{"path":"image.nii","sha256":"00"},"cells":1000,"vertices":300,)"
    R"("refine_cells_per_second":1000.0,"phases_s":{"read":0.5,"refine":1.0,"extract":0.5,"write":5.0},)"
    R"("guarantees":{"radius_edge":0,"facet_angle":0},"stop_reason":"complete"})";

/// The preparation of a trial whose image is a file and whose radius is given.
inline Preparation prepared(const Trial& trial) { return {trial.image, "00", {}}; }

/// A script for `podm`. It answers --version, and `info` with 10 x 10 x 10 voxels of 8 mm^3, unless the
/// image's name contains "refused". `phantom` writes its name and size and notes them in the file "drawn".
/// `replay` of a log runs the file "replay". `mesh` notes its arguments in "arguments" and runs `mesh_body`,
/// where $record is the file of --record and $output the file of -o.
inline std::string fake_mesher(const TemporaryFolder& folder, const std::string& mesh_body) {
  return folder.script("podm", R"(
[ "$1" = --version ] && { echo 'podm 9.9'; exit 0; }
[ "$1" = info ] && case $2 in *refused*) echo refused >&2; exit 2;; esac
[ "$1" = info ] && { echo '{"size":[10,10,10],"voxel_volume_mm3":8}'; exit 0; }
[ "$1" = phantom ] && { echo "$2 $4" > "$6"; echo "$2 $4" >> "$(dirname "$0")/drawn"; exit 0; }
[ "$1" = replay ] && { [ -e "$3" ] || exit 9; . "$(dirname "$0")/replay"; exit; }
echo "$@" > "$(dirname "$0")/arguments"
while [ $# -gt 0 ]; do
  case $1 in --record) record=$2;; -o) output=$2;; --log) echo log > "$2";; esac
  shift
done
)" + mesh_body);
}

/// A script for `podm-verify` that runs `body`, where $report is the file of --json.
inline std::string fake_verifier(const TemporaryFolder& folder, const std::string& body) {
  return folder.script("podm-verify", R"(
asked=$*
while [ $# -gt 0 ]; do
  case $1 in --json) report=$2;; esac
  shift
done
)" + body);
}

/// The output of a solver.
inline const std::string kSolved =
    R"({"solver":"Solver 1.0","poisson":{"unknowns":9,)"
    R"("jacobi":{"iterations":12,"smallest_eigenvalue":0.1,"largest_eigenvalue":2.0,"setup_s":0.0,"seconds":0.5},)"
    R"("amg":{"iterations":3,"smallest_eigenvalue":0.5,"largest_eigenvalue":1.0,"setup_s":0.1,"seconds":0.2}},)"
    R"("elasticity":{"unknowns":27,)"
    R"("jacobi":{"iterations":24,"smallest_eigenvalue":0.1,"largest_eigenvalue":4.0,"setup_s":0.0,"seconds":1.5},)"
    R"("amg":{"iterations":6,"smallest_eigenvalue":0.5,"largest_eigenvalue":1.0,"setup_s":0.3,"seconds":0.4}}})";

}  // namespace podm::bench
