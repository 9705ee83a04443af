// The comparison of topologies as a phase of a run, and the refinements that mend what differs.
#pragma once

#include "algorithms/construction.h"
#include "podm/topology_report.h"

namespace podm {

/// Compares the topology of each label in the mesh with that in the image. Where they differ, deltas are
/// halved around the place, down to the least delta, and the mesh is refined with them: again and again,
/// until nothing differs, or all deltas at what differs are the least. Then the report lists what differs.
/// Does nothing if the problem keeps no thin layers. `parameters` are those of the refinement, and then those
/// of the last one. Charges the phase "mend".
///
/// Each refinement begins with all cells on lists, as the first one did, and applies the same rules with
/// smaller deltas. The proof of rules.h covers all of them at once. They end: each lowers a number of a
/// finite set, as it halves it or reaches the least.
void mend_topology(Construction& construction, Parameters& parameters);

/// Compares the topologies of the finished mesh, whose cells have labels. `thin` is the report of the layers
/// and of the mending; only what is compared changes.
void compare_again(const Mesh& mesh, const LabelImage& image, TopologyReport& report);

}  // namespace podm
