#include "io/vertex_subset.h"

#include <algorithm>

namespace podm {

void VertexSubset::clear() {
  for (const std::uint32_t vertex : vertices_) position_[vertex] = kUnused;
  vertices_.clear();
}

void VertexSubset::number() {
  if (vertices_.size() > position_.size() / kSparse) {  // a scan is then cheaper than a sort
    vertices_.clear();
    for (std::size_t v = 0; v < position_.size(); ++v)
      if (position_[v] != kUnused) vertices_.push_back(static_cast<std::uint32_t>(v));
  } else {
    std::sort(vertices_.begin(), vertices_.end());
  }
  for (std::size_t i = 0; i < vertices_.size(); ++i) position_[vertices_[i]] = static_cast<std::uint32_t>(i);
}

}  // namespace podm
