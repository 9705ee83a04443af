#include "sample_pages.h"

#include <algorithm>

#include "runtime/numa_memory.h"

namespace podm {

PageSamples sample_pages(const Mesh& mesh, const Topology& machine) {
  constexpr CellId kMostSamples = 1000;
  PageSamples samples;
  if (!machine.is_this_machine()) samples.unavailable = "the machine is a described one";
  if (machine.num_nodes() == 1) samples.unavailable = "the machine has one NUMA node";
  if (!samples.unavailable.empty()) return samples;
  const CellId step = std::max<CellId>(1, mesh.cell_bound() / kMostSamples);
  for (CellId c = 0; c < mesh.cell_bound(); c += step) {
    if (!mesh.cell(c).is_alive()) continue;
    const PageNode page = node_of_page(&mesh.cell(c));
    if (!page.os_index) {
      samples.unavailable = page.unavailable;
      return samples;
    }
    ++(*page.os_index == machine.node_os_index(mesh.node_of_cell(c)) ? samples.as_claimed
                                                                     : samples.elsewhere);
  }
  return samples;
}

}  // namespace podm
