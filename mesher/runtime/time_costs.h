// The constants of virtual time: the time that work takes on the reference core, each with its source. The
// cores of a described machine work `core_speed` times as fast (runtime/machine_model.h).
//
// The reference core is one of experiments/machines/epyc_zen5_2_cores.toml, with the code that `make build`
// compiles. The costs of attempts are the parts of a profile (the liver, 3 million cells), each divided by
// its count. All are increased by 6 % to match the median of eleven images and sizes. The other costs were
// timed one by one. Commit 584d07f has counts, seconds and residuals, in
// results/reference/amd-epyc-zen5-2-cores/README.md.
//
// The model is frozen: a changed value, or a changed rule that charges the values (workers/accounting.h), is
// another model with a new version.
#pragma once

#include <array>
#include <string>

namespace podm {

/// The version of the rules of virtual time and of the values below.
inline constexpr int kTimeModelVersion = 1;

/// Seconds on the reference core, except for the shares at the end.
struct TimeCosts {
  // ---- An attempt ----

  /// An entry taken off the list; if the entry is stale, the whole attempt.
  double list_looked_up = 0.011e-6;
  /// An examined cell: its label and bound, R3 to R5.
  double classified = 0.19e-6;
  /// A search for the nearest point of the isosurface.
  double searched = 0.435e-6;
  /// A cell tested against a point.
  double tested = 0.0225e-6;
  /// A cell made and glued, including the clearing of its page and the cells that removals leave.
  double created = 0.0945e-6;
  /// A cell that R7 plans, whether or not the plan is carried out.
  double planned = 0.2e-6;

  // ---- Between attempts ----

  /// A begging worker puts itself on a list, under the list's lock; or a worker serves it.
  double begging = 0.2e-6;
  /// An entry of a poor element list that changes hands.
  double entry_given = 0.01e-6;
  /// An entry listed with the leaf that contains its circumcenter.
  double entry_to_leaf = 0.055e-6;
  /// A cell of the initial mesh that moves to another node's memory.
  double cell_moved = 0.1e-6;
  /// A cell whose dihedral angles are checked.
  double cell_judged = 0.05e-6;
  /// A look-up of the label at a point of space.
  double place_looked_up = 0.1e-6;
  /// A leaf whose poor cells are pushed to the queue, and that is shared out.
  double leaf_shared_out = 1.3e-6;
  /// A leaf taken off the refinement queue or returned, with its buffer zones, under the queue's lock.
  double leaf_handed_out = 20e-6;

  // ---- Before and after refinement, on one thread; loops divide it among all threads ----

  double voxel_read = 3e-9;          ///< from a compressed file, on one thread
  double voxel_transformed = 50e-9;  ///< on all threads
  double thread_started = 15e-6;     ///< by the thread that calls the run
  double cube_made = 2e-6;           ///< of the octree, on one thread
  double cell_extracted = 37e-9;     ///< on all threads

  // ---- Shares of an attempt ----

  /// Locks lengthen an attempt by this share.
  double locked = 0.04;
  /// Attempts of equal work do not end together: each is longer or shorter by a random share up to this
  /// value.
  double spread = 0.5;
};

struct NamedTimeCost {
  const char* name;
  double TimeCosts::*member;
};
/// Every constant once, in the order of declaration.
inline constexpr std::array<NamedTimeCost, 21> kTimeCosts{{
    {"list_looked_up", &TimeCosts::list_looked_up},
    {"classified", &TimeCosts::classified},
    {"searched", &TimeCosts::searched},
    {"tested", &TimeCosts::tested},
    {"created", &TimeCosts::created},
    {"planned", &TimeCosts::planned},
    {"begging", &TimeCosts::begging},
    {"entry_given", &TimeCosts::entry_given},
    {"entry_to_leaf", &TimeCosts::entry_to_leaf},
    {"cell_moved", &TimeCosts::cell_moved},
    {"cell_judged", &TimeCosts::cell_judged},
    {"place_looked_up", &TimeCosts::place_looked_up},
    {"leaf_shared_out", &TimeCosts::leaf_shared_out},
    {"leaf_handed_out", &TimeCosts::leaf_handed_out},
    {"voxel_read", &TimeCosts::voxel_read},
    {"voxel_transformed", &TimeCosts::voxel_transformed},
    {"thread_started", &TimeCosts::thread_started},
    {"cube_made", &TimeCosts::cube_made},
    {"cell_extracted", &TimeCosts::cell_extracted},
    {"locked", &TimeCosts::locked},
    {"spread", &TimeCosts::spread},
}};
static_assert(sizeof(TimeCosts) == kTimeCosts.size() * sizeof(double), "a constant has no name");

/// Returns the model as text, whose hash identifies it: its version, then one line per constant, "name
/// value".
std::string time_model_text(const TimeCosts& costs);

}  // namespace podm
