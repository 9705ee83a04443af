// The traced lines of an image, ready to be sampled.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lines/arc.h"
#include "lines/exact_points.h"
#include "lines/line_network.h"

namespace podm {

class Lines {
 public:
  /// Keeps a reference to the image; `weights` as in ExactPoints.
  Lines(LineNetwork network, const LabelImage& image, std::shared_ptr<const VoxelWeights> weights)
      : network_(std::move(network)), exact_(image, std::move(weights)) {
    arcs_.reserve(network_.arcs.size());
    for (const LineArc& arc : network_.arcs) arcs_.emplace_back(arc);
  }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  const LineNetwork& network() const { return network_; }
  bool is_box_flat() const { return exact_.is_box_flat(); }
  std::size_t num_arcs() const { return arcs_.size(); }
  const Arc& arc(std::size_t a) const { return arcs_[a]; }
  /// The arc's point at a position, in the planes of the arc's sides.
  SurfacePoint point(std::size_t arc, double position) const {
    return exact_.on_sides(arcs_[arc].point_at(position), network_.arcs[arc].sides);
  }
  SurfacePoint node(std::size_t node) const {
    return exact_.on_sides(network_.nodes[node].point, network_.nodes[node].sides);
  }
  /// The line's point near the arc's at a position, on the same sides. None if it is not found.
  std::optional<SurfacePoint> exact_point(std::size_t arc, double position) const {
    return exact_.near(arcs_[arc].point_at(position), network_.arcs[arc].sides, network_.arcs[arc].labels,
                       ExactPoints::On::kCurve);
  }
  std::optional<SurfacePoint> exact_node(std::size_t node) const {
    return exact_.near(network_.nodes[node].point, network_.nodes[node].sides, network_.nodes[node].labels,
                       ExactPoints::On::kNode);
  }

 private:
  LineNetwork network_;
  std::vector<Arc> arcs_;
  ExactPoints exact_;
};

}  // namespace podm
