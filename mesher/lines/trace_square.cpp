#include "lines/trace_square.h"

#include <algorithm>

#include "lines/curve_points.h"

namespace podm {

namespace {

constexpr double kMiddle = 0.5;  // of the block that is constant along its third axis
constexpr unsigned kAlongU = 1, kAlongV = 2, kDiagonal = 3;

int& along(Voxel& v, std::size_t axis) { return axis == 0 ? v.i : axis == 1 ? v.j : v.k; }

// Beyond the last voxels along an axis, at the lower or the upper end.
int beyond(const BlockGrid& grid, std::size_t axis, bool is_upper) { return is_upper ? grid.size(axis) : -1; }

// The coordinate of a side's plane.
double plane(const BlockGrid& grid, std::size_t axis, bool is_upper) {
  return is_upper ? grid.size(axis) - 0.5 : -0.5;
}

double& along(Point& p, std::size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

// The voxel at (u,v) on a side, moved beyond the grid.
Voxel voxel_on(const BlockGrid& grid, const BoxSide& side, int u, int v) {
  Voxel voxel;
  along(voxel, side.axis) = beyond(grid, side.axis, side.is_upper);
  along(voxel, side.u()) = u;
  along(voxel, side.v()) = v;
  return voxel;
}

// Where the label changes between two neighboring voxels of different labels, as a share of the way.
double share_to_change(const BlockGrid& grid, const Voxel& from, const Voxel& to) {
  const double a = grid.weight(from), b = grid.weight(to);
  return a / (a + b);
}

}  // namespace

BlockCorners corners_of_square(const BlockGrid& grid, const BoxSide& side, int p, int q) {
  BlockCorners corners;
  for (int c = 0; c < 8; ++c) {
    const Voxel v = voxel_on(grid, side, p + (c & 1), q + (c >> 1 & 1));
    corners.labels[static_cast<std::size_t>(c)] = grid.nearest_label(v);
    corners.weights[static_cast<std::size_t>(c)] = grid.weight(v);
  }
  return corners;
}

Point SquareTracer::in_index_coordinates(const Point& uv) const {
  Point p;
  along(p, side_.axis) = plane(grid_, side_.axis, side_.is_upper);
  along(p, side_.u()) = place_[0] + uv.x;
  along(p, side_.v()) = place_[1] + uv.y;
  return p;
}

std::int16_t SquareTracer::edge(std::size_t vertex, unsigned step) {
  std::int16_t& index = index_of_edge_[4 * vertex + step];
  if (index < 0) {
    index = static_cast<std::int16_t>(edges_.size());
    const auto labels =
        static_cast<SlotMask>(lattice_.winner(vertex) | lattice_.winner(vertex + lattice_offset(step)));
    edges_.push_back({{}, static_cast<std::uint16_t>(vertex), static_cast<std::uint8_t>(step), labels});
  }
  return index;
}

// Adds the triangle from a lattice point along `middle_step` and then the other axis.
void SquareTracer::add_triangle(std::size_t vertex, unsigned middle_step) {
  const std::size_t middle = vertex + lattice_offset(middle_step);
  const SlotMask a = lattice_.winner(vertex), b = lattice_.winner(middle),
                 c = lattice_.winner(vertex + lattice_offset(kDiagonal));
  const auto labels = static_cast<SlotMask>(a | b | c);
  if (num_slots(labels) < 2) return;
  std::vector<std::int16_t> cut;
  if (a != b) cut.push_back(edge(vertex, middle_step));
  if (b != c) cut.push_back(edge(middle, kDiagonal ^ middle_step));
  if (a != c) cut.push_back(edge(vertex, kDiagonal));
  const auto at = [&](std::size_t i) -> Edge& { return edges_[static_cast<std::size_t>(cut[i])]; };
  if (cut.size() == 2) {
    at(0).add(cut[1]);
    at(1).add(cut[0]);
    return;
  }
  for (std::size_t i = 0; i < 3; ++i) at(i).add(link_to_hub(triangles_.size()));
  triangles_.push_back({static_cast<std::uint8_t>(lattice_steps(vertex, 0)),
                        static_cast<std::uint8_t>(lattice_steps(vertex, 1)), middle_step == kAlongV,
                        static_cast<std::uint16_t>(triangles_.size()), labels_of(labels)});
}

void SquareTracer::find_edges() {
  for (int y = range_.low[1]; y < range_.high[1]; ++y)
    for (int x = range_.low[0]; x < range_.high[0]; ++x)
      for (const unsigned middle_step : {kAlongU, kAlongV}) add_triangle(lattice_index(x, y, 0), middle_step);
}

FewLabels SquareTracer::labels_of(SlotMask slots) const {
  FewLabels labels;
  for (std::size_t s = 0; s < forms_.size(); ++s)
    if ((slots >> s & 1) != 0) labels.insert(forms_.label(s));
  return labels;
}

// A curve leaves the square between two voxels, where their weights tie, or half a voxel outside of them, on
// an edge of the box.
void SquareTracer::add_joint_on_border(Edge& edge) {
  const std::size_t across = edge.step == kAlongV ? 0 : 1;  // of the square's two axes
  const std::size_t axis_across = across == 0 ? side_.u() : side_.v(),
                    axis_along = across == 0 ? side_.v() : side_.u();
  const int steps = lattice_steps(edge.vertex, across);
  const bool is_on_box_edge = steps == kLatticeSteps / 2, is_upper_voxel = steps != range_.low[across];
  Voxel from = voxel_on(grid_, side_, place_[0], place_[1]);
  if (is_on_box_edge)
    along(from, axis_across) = beyond(grid_, axis_across, is_upper_voxel);
  else
    along(from, axis_across) = place_[across] + (is_upper_voxel ? 1 : 0);
  Voxel to = from;
  ++along(to, axis_along);
  Point p = in_index_coordinates({});
  along(p, axis_along) = along(from, axis_along) + share_to_change(grid_, from, to);
  along(p, axis_across) =
      is_on_box_edge ? plane(grid_, axis_across, is_upper_voxel) : along(from, axis_across);
  auto sides = side_.bit();
  if (is_on_box_edge) sides |= BoxSide{axis_across, is_upper_voxel}.bit();
  edge.joint = static_cast<int>(chains_.joints.size());
  chains_.joints.push_back(
      {{keys_(JointKind::kOnEdge, axis_along, from, 0), p, sides, labels_of(edge.labels)},
       !is_on_box_edge && !is_upper_voxel});
}

void SquareTracer::find_joints() {
  const std::vector<FacePoint> points = face_points(forms_, range_.box(), triangles_);
  joint_of_triangle_.assign(triangles_.size(), -1);
  for (std::size_t n = 0; n < points.size(); ++n) {
    for (const std::uint16_t t : points[n].triangles)
      joint_of_triangle_[t] = static_cast<int>(chains_.joints.size());
    const Point p = in_index_coordinates(points[n].uv);
    if (!points[n].is_confirmed) unconfirmed_.push_back(p);
    chains_.joints.push_back(
        {{keys_(JointKind::kOnFace, side_.axis, voxel_on(grid_, side_, place_[0], place_[1]), n), p,
          side_.bit(), points[n].labels},
         true});
  }
  for (Edge& edge : edges_)
    if (edge.is_end()) add_joint_on_border(edge);
}

// The point of a joint in the square, if the chain has one.
std::vector<Point> SquareTracer::end_of(int joint) const {
  if (joint < 0) return {};
  Point p = chains_.joints[static_cast<std::size_t>(joint)].joint.point;
  return {{along(p, side_.u()) - place_[0], along(p, side_.v()) - place_[1], kMiddle}};
}

// The middle of a lattice edge.
Point SquareTracer::place_of(const Edge& edge) const {
  const Point a = lattice_point(edge.vertex), b = lattice_point(edge.vertex + lattice_offset(edge.step));
  const Point middle = a + 0.5 * (b - a);
  return {middle.x, middle.y, kMiddle};
}

void SquareTracer::add_chain(const WalkedChain& walked) {
  Chain chain;
  if (!walked.is_closed)
    chain.ends = {
        is_hub(walked.before) ? joint_of_triangle_[hub_of(walked.before)]
                              : edges_[walked.items.front()].joint,
        is_hub(walked.after) ? joint_of_triangle_[hub_of(walked.after)] : edges_[walked.items.back()].joint};
  const SlotMask slots = edges_[walked.items.front()].labels;
  LatticeCurve curve{slots, {}, end_of(chain.ends[0]), end_of(chain.ends[1]), walked.is_closed};
  for (const std::uint16_t e : walked.items)
    if (edges_[e].joint < 0) curve.places.push_back(place_of(edges_[e]));
  const CurvePoints found = curve_points(forms_, range_.box(), curve);
  chain.labels = labels_of(slots);
  if (!chain.labels.contains(kBackground))  // otherwise it is no line
    for (const Point& uv : found.unconfirmed) unconfirmed_.push_back(in_index_coordinates(uv));
  for (const Point& uv : found.points) chain.points.push_back(in_index_coordinates(uv));
  chains_.chains.push_back(std::move(chain));
}

void SquareTracer::trace(const BoxSide& side, int p, int q, Pieces& pieces) {
  side_ = side;
  place_ = {p, q};
  chains_.sides = side.bit();
  const Voxel lowest = voxel_on(grid_, side, p, q);
  forms_ = WeightForms(corners_of_square(grid_, side, p, q));
  if (forms_.size() < 2) return;
  const LatticeRange of_block = grid_.range(lowest);
  range_ = {{of_block.low[side.u()], of_block.low[side.v()], 0},
            {of_block.high[side.u()], of_block.high[side.v()], kLatticeSteps}};
  lattice_.sample(forms_);
  find_edges();
  find_joints();
  for_each_chain(edges_, walked_, [&](const WalkedChain& walked) { add_chain(walked); });
  const RemovedCurves removed = merge_chains(
      chains_, [&](std::size_t n) { return keys_(JointKind::kInSquare, side_.axis, lowest, n); });
  append(chains_, true, pieces);
  using enum UndecidedPlace::Reason;
  for (const Point& point : unconfirmed_) pieces.undecided.push_back({lowest, point, kUnconfirmed});
  append(removed, lowest, pieces);
  for (const Edge& e : edges_) index_of_edge_[4 * e.vertex + e.step] = -1;
  edges_.clear();
  triangles_.clear();
  chains_.clear();
  unconfirmed_.clear();
}

namespace {

// One edge of the box, along an axis.
class BoxEdge {
 public:
  /// The edge is at the upper end of the axis after the next, and after that, where `is_upper` says so.
  BoxEdge(const BlockGrid& grid, std::size_t axis, const std::array<bool, 2>& is_upper)
      : grid_(grid), keys_(grid.image().size), axis_(axis) {
    for (std::size_t n = 0; n < 2; ++n) {
      const std::size_t across = (axis + 1 + n) % 3;
      along(lowest_, across) = beyond(grid, across, is_upper[n]);
      along(point_, across) = plane(grid, across, is_upper[n]);
      sides_ |= BoxSide{across, is_upper[n]}.bit();
    }
  }

  /// Appends the pieces of foreground and the joints at places where labels change.
  void trace(Pieces& pieces) const {
    Joint before = corner(false);
    for (int i = 0; i < grid_.size(axis_); ++i) {
      const bool is_last = i + 1 == grid_.size(axis_);
      const LabelIndex label = grid_.nearest_label(voxel(i));
      if (!is_last && grid_.nearest_label(voxel(i + 1)) == label) continue;
      const Joint after = is_last ? corner(true) : change(i);
      if (label != kBackground) add(before, after, label, pieces);
      if (!is_last) pieces.joints.push_back(after);
      before = after;
    }
  }

 private:
  Voxel voxel(int i) const {
    Voxel v = lowest_;
    along(v, axis_) = i;
    return v;
  }
  Joint corner(bool is_upper) const {
    const Voxel place = voxel(beyond(grid_, axis_, is_upper));
    Joint joint{keys_(JointKind::kCorner, 0, place, 0), point_, 0, {}};
    along(joint.point, axis_) = plane(grid_, axis_, is_upper);
    joint.sides = static_cast<std::uint8_t>(sides_ | BoxSide{axis_, is_upper}.bit());
    return joint;
  }
  // The joint between the i-th voxel and the next.
  Joint change(int i) const {
    Joint joint{keys_(JointKind::kOnEdge, axis_, voxel(i), 0), point_, sides_, {}};
    along(joint.point, axis_) = i + share_to_change(grid_, voxel(i), voxel(i + 1));
    for (const LabelIndex label :
         {grid_.nearest_label(voxel(i)), grid_.nearest_label(voxel(i + 1)), kBackground})
      joint.labels.insert(label);
    return joint;
  }
  void add(const Joint& from, const Joint& to, LabelIndex label, Pieces& pieces) const {
    Piece piece{{from.key, to.key}, false, sides_, {}, 2};
    piece.labels.insert(label);
    piece.labels.insert(kBackground);
    pieces.pieces.push_back(piece);
    pieces.points.push_back(from.point);
    pieces.points.push_back(to.point);
  }

  const BlockGrid& grid_;
  JointKeys keys_;
  std::size_t axis_;
  Voxel lowest_;
  Point point_;
  std::uint8_t sides_ = 0;
};

void add_corners(const BlockGrid& grid, Pieces& pieces) {
  const JointKeys keys(grid.image().size);
  for (unsigned c = 0; c < 8; ++c) {
    Voxel place;
    Joint joint{};
    for (std::size_t a = 0; a < 3; ++a) {
      const bool is_upper = (c >> a & 1) != 0;
      along(place, a) = beyond(grid, a, is_upper);
      along(joint.point, a) = plane(grid, a, is_upper);
      joint.sides |= BoxSide{a, is_upper}.bit();
    }
    joint.key = keys(JointKind::kCorner, 0, place, 0);
    joint.labels.insert(grid.nearest_label(place));
    joint.labels.insert(kBackground);
    pieces.joints.push_back(joint);
  }
}

}  // namespace

void trace_box_edges(const BlockGrid& grid, Pieces& pieces) {
  add_corners(grid, pieces);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const bool first : {false, true})
      for (const bool second : {false, true}) BoxEdge(grid, axis, {first, second}).trace(pieces);
}

}  // namespace podm
