// The constants of virtual time: what work takes on the reference core, each with its source. The cores of a
// described machine work `core_speed` times as fast (runtime/machine_model.h).
//
// The reference core is one of experiments/machines/epyc_zen5_2_cores.toml, with what `make build` compiles.
// The costs of attempts are the parts of a profile, the liver at 3 million cells, each over the count that it
// goes with, all lengthened by 6 % for the median of eleven images and sizes; the others were timed one by
// one. Commit 584d07f has counts, seconds and residuals, in
// results/reference/amd-epyc-zen5-2-cores/README.md.
//
// The model is frozen: another value, or another rule that charges them, is another model with a new version.
#pragma once

#include <array>
#include <string>

namespace podm {

/// Of the rules by which virtual time goes and of the values below.
inline constexpr int kTimeModelVersion = 1;

/// Seconds on the reference core, but for the shares at the end.
struct TimeCosts {
  // ---- An attempt ----

  /// The entry that it takes off the list; where that is stale, all of it.
  double list_looked_up = 0.011e-6;
  /// A cell that is examined: its label and bound, R3 to R5.
  double classified = 0.19e-6;
  /// The search for the nearest point of the isosurface.
  double searched = 0.435e-6;
  /// A cell tested against a point.
  double tested = 0.0225e-6;
  /// A cell made and glued, the clearing of its page and the cells that removals leave included.
  double created = 0.0945e-6;
  /// A cell that R7 plans, to carry it out or not.
  double planned = 0.2e-6;

  // ---- Between attempts ----

  /// A worker that begs puts itself on a list, under its lock; so does one that serves it.
  double begging = 0.2e-6;
  /// An entry of a poor element list that changes hands.
  double entry_given = 0.01e-6;
  /// An entry that is listed with the leaf that has its circumcentre.
  double entry_to_leaf = 0.055e-6;
  /// A cell of the initial mesh that moves to another node's memory.
  double cell_moved = 0.1e-6;
  /// A cell whose dihedral angles are looked at.
  double cell_judged = 0.05e-6;
  /// The label at a point of space.
  double place_looked_up = 0.1e-6;
  /// A leaf whose cells the queue is told of, and that is shared out.
  double leaf_shared_out = 1.3e-6;
  /// A leaf is taken off the refinement queue or given back, with its buffer zones, under the queue's lock.
  double leaf_handed_out = 20e-6;

  // ---- Before and after refinement, of one thread; loops share it among all ----

  double voxel_read = 3e-9;          ///< from a compressed file, on one thread
  double voxel_transformed = 50e-9;  ///< on all
  double thread_started = 15e-6;     ///< by the thread that the run is called from
  double cube_made = 2e-6;           ///< of the octree, on one thread
  double cell_extracted = 37e-9;     ///< on all

  // ---- Shares of an attempt ----

  /// Locks make it longer by this share.
  double locked = 0.04;
  /// Attempts of equal work do not end together: each is longer or shorter by a random share up to this.
  double spread = 0.5;
};

struct NamedTimeCost {
  const char* name;
  double TimeCosts::*member;
};
/// Every constant once, in the order of their declaration.
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

/// The model as text, whose hash names it: its version, then a line a constant, "name value".
std::string time_model_text(const TimeCosts& costs);

}  // namespace podm
