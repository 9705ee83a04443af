#include "claims/near_lines.h"

#include "claims/lines_of_mesh.h"
#include "parallel.h"

namespace podm::verify {

NearLines::NearLines(const Mesh& mesh, const Adjacency& adjacency, const Options& options)
    : are_kept_(options.lines_delta_mm || mesh.promised_lines_delta_mm) {
  if (!are_kept_) return;
  is_end_.assign(mesh.vertices.size(), 0);
  for (const LineEdge& edge : lines_of_mesh(mesh, adjacency, num_threads(options.threads)))
    for (const VertexId v : edge.vertices) is_end_[v] = 1;
}

}  // namespace podm::verify
