// Samples that show if memory is where its owners claim, and where workers' accesses went.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "delaunay/mesh.h"
#include "isosurface/oracle_reads.h"
#include "podm/meshing_report.h"
#include "runtime/numa_memory.h"
#include "runtime/topology.h"

namespace podm {

/// Some addresses that a worker read or wrote, and the worker's node.
struct SampledAccesses {
  int node = 0;
  std::vector<const void*> addresses;
};

class PageSampler {
 public:
  /// `owners` may be unknown; the image is not sampled then.
  PageSampler(const Topology& machine, const ImageOwners& owners, PageQuery query)
      : machine_(machine), owners_(owners), query_(std::move(query)) {}

  /// Queries the nodes of some pages of the store, the image and the transform, and of `accesses`, and adds
  /// the results to `samples`. After the system has refused a query no more queries are made.
  void sample(const std::string& phase, const Mesh& mesh, std::span<const SampledAccesses> accesses,
              PageSamples& samples) const;

 private:
  const Topology& machine_;
  const ImageOwners& owners_;
  PageQuery query_;
};

}  // namespace podm
