// Whether memory is where its owners say, and where workers' accesses went.
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

/// Some addresses that a worker read or wrote, and the node that it stood on.
struct SampledAccesses {
  int node = 0;
  std::vector<const void*> addresses;
};

class PageSampler {
 public:
  /// `owners` may be unknown; then the image is not sampled.
  PageSampler(const Topology& machine, const ImageOwners& owners, PageQuery query)
      : machine_(machine), owners_(owners), query_(std::move(query)) {}

  /// Asks where some pages of the store, the image and the transform are, and those of `accesses`, and adds
  /// the answers to `samples`. Once the system has refused it is not asked again.
  void sample(const std::string& phase, const Mesh& mesh, std::span<const SampledAccesses> accesses,
              PageSamples& samples) const;

 private:
  const Topology& machine_;
  const ImageOwners& owners_;
  PageQuery query_;
};

}  // namespace podm
