#include "lines/trace_block.h"

#include <algorithm>
#include <bit>
#include <optional>

#include "lines/curve_points.h"
#include "lines/tie_point.h"

namespace podm {

namespace {

constexpr std::size_t kNoFace = 6;

// The number of a triangle's type among the twelve pairs of steps that share no axis.
constexpr auto kTypeOfSteps = [] {
  std::array<std::uint8_t, 64> types{};
  std::uint8_t next = 0;
  for (unsigned first = 1; first < 8; ++first)
    for (unsigned second = 1; second < 8; ++second)
      if ((first & second) == 0) types[8 * first + second] = next++;
  return types;
}();

Point from_face(const Point& uv, std::size_t axis, double across) {
  std::array<double, 3> f{};
  f[axis] = across;
  f[(axis + 1) % 3] = uv.x;
  f[(axis + 2) % 3] = uv.y;
  return {f[0], f[1], f[2]};
}

Voxel moved_up(Voxel v, std::size_t axis) {
  ++(axis == 0 ? v.i : axis == 1 ? v.j : v.k);
  return v;
}

}  // namespace

std::int16_t BlockTracer::triangle(std::size_t vertex, unsigned first_step, unsigned second_step,
                                   SlotMask labels) {
  std::int16_t& index = index_of_triangle_[kTypes * vertex + kTypeOfSteps[8 * first_step + second_step]];
  if (index < 0) {
    index = static_cast<std::int16_t>(triangles_.size());
    triangles_.push_back({{},
                          {static_cast<std::uint16_t>(vertex), static_cast<std::uint8_t>(first_step),
                           static_cast<std::uint8_t>(second_step)},
                          labels});
  }
  return index;
}

// The tetrahedron's vertices are `lowest` and those that are higher by the sets of axes `second`, `third` and
// all three.
void BlockTracer::add_tetrahedron(std::size_t lowest, unsigned second, unsigned third) {
  constexpr unsigned kAll = 7;
  const SlotMask a = lattice_.winner(lowest), b = lattice_.winner(lowest + lattice_offset(second)),
                 c = lattice_.winner(lowest + lattice_offset(third)),
                 d = lattice_.winner(lowest + lattice_offset(kAll));
  const std::size_t num_labels = num_slots(a | b | c | d);
  if (num_labels < 3) return;
  std::array<std::int16_t, 4> found{};
  std::size_t num_found = 0;
  const auto add = [&](SlotMask labels, std::size_t vertex, unsigned first_step, unsigned second_step) {
    if (num_slots(labels) == 3) found[num_found++] = triangle(vertex, first_step, second_step, labels);
  };
  add(a | b | c, lowest, second, third ^ second);
  add(a | b | d, lowest, second, kAll ^ second);
  add(a | c | d, lowest, third, kAll ^ third);
  add(b | c | d, lowest + lattice_offset(second), third ^ second, kAll ^ third);
  const auto at = [&](std::size_t i) -> Triangle& { return triangles_[static_cast<std::size_t>(found[i])]; };
  if (num_labels == 3) {
    at(0).add(found[1]);
    at(1).add(found[0]);
    return;
  }
  for (std::size_t i = 0; i < 4; ++i) at(i).add(link_to_hub(hubs_.size()));
  hubs_.push_back(found);
}

void BlockTracer::find_triangles() {
  for (int z = range_.low[2]; z < range_.high[2]; ++z) {
    for (int y = range_.low[1]; y < range_.high[1]; ++y) {
      for (int x = range_.low[0]; x < range_.high[0]; ++x) {
        const std::size_t cube = lattice_index(x, y, z);
        if (num_slots(lattice_.winners_of_cube(cube)) < 3) continue;
        for (const unsigned first : {1u, 2u, 4u})
          for (const unsigned second : {1u, 2u, 4u})
            if (first != second) add_tetrahedron(cube, first, first | second);
      }
    }
  }
}

// The face that holds a triangle: 2 times its axis, and one more for the upper face.
std::size_t BlockTracer::face_of(const Triangle& t) const {
  const unsigned steps = t.place.first_step | t.place.second_step;
  const auto axis = static_cast<std::size_t>(std::countr_one(steps));
  if (axis > 2) return kNoFace;
  const int at = lattice_steps(t.place.vertex, axis);
  return at == range_.low[axis] ? 2 * axis : at == range_.high[axis] ? 2 * axis + 1 : kNoFace;
}

FaceTriangle BlockTracer::on_face(std::size_t index, std::size_t axis) const {
  const Triangle& t = triangles_[index];
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  return {static_cast<std::uint8_t>(lattice_steps(t.place.vertex, u)),
          static_cast<std::uint8_t>(lattice_steps(t.place.vertex, v)), (t.place.first_step >> v & 1) != 0,
          static_cast<std::uint16_t>(index), labels_of(t.labels)};
}

void BlockTracer::find_joints_on_faces() {
  std::array<std::vector<FaceTriangle>, 6> of_faces;
  for (std::size_t i = 0; i < triangles_.size(); ++i)
    if (const std::size_t face = face_of(triangles_[i]); face != kNoFace)
      of_faces[face].push_back(on_face(i, face / 2));
  for (std::size_t face = 0; face < 6; ++face)
    if (!of_faces[face].empty()) add_joints_on_face(face, std::move(of_faces[face]));
}

// The block above a face emits its joints. Those on a side of the box are emitted with the curves on it.
void BlockTracer::add_joints_on_face(std::size_t face, std::vector<FaceTriangle> triangles) {
  const std::size_t axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
  const bool is_upper = face % 2 != 0;
  const int steps = is_upper ? range_.high[axis] : range_.low[axis];
  const bool is_on_side = steps == kLatticeSteps / 2;
  const Box box{{range_.low[u] * kLatticeSide, range_.low[v] * kLatticeSide, 0},
                {range_.high[u] * kLatticeSide, range_.high[v] * kLatticeSide, 0}};
  const std::vector<FacePoint> points =
      face_points(forms_on_face(corners_, axis, is_upper), box, std::move(triangles));
  const Voxel above = is_upper ? moved_up(block_, axis) : block_;
  for (std::size_t n = 0; n < points.size(); ++n) {
    for (const std::uint16_t t : points[n].triangles)
      triangles_[t].joint = static_cast<int>(chains_.joints.size());
    const Point f = from_face(points[n].uv, axis, steps * kLatticeSide);
    if (!points[n].is_confirmed) unconfirmed_.push_back(in_index_coordinates(f));
    const auto side = static_cast<std::uint8_t>(is_on_side ? 1u << face : 0);
    chains_.joints.push_back(
        {{keys_(JointKind::kOnFace, axis, above, n), in_index_coordinates(f), side, points[n].labels},
         !is_upper && !is_on_side});
  }
}

// A hub's joint is where its four labels tie, or else amid its triangles.
void BlockTracer::add_joint_at_hub(std::size_t hub) {
  SlotMask labels = 0;
  Point middle;
  for (const std::int16_t t : hubs_[hub]) {
    const Triangle& triangle = triangles_[static_cast<std::size_t>(t)];
    labels |= triangle.labels;
    middle = middle + 0.25 * triangle.place.centroid();
  }
  const Point f = tie_point(forms_, labels, middle, range_.box(), kCurveReach).value_or(middle);
  joint_of_hub_.push_back(static_cast<int>(chains_.joints.size()));
  chains_.joints.push_back({{keys_(JointKind::kInBlock, 0, block_, chains_.joints.size()),
                             in_index_coordinates(f), 0, labels_of(labels)},
                            true});
}

// The point of a joint in the block, if the chain has one.
std::vector<Point> BlockTracer::end_of(int joint) const {
  if (joint < 0) return {};
  return {chains_.joints[static_cast<std::size_t>(joint)].joint.point - center(block_)};
}

void BlockTracer::add_chain(const WalkedChain& walked) {
  Chain chain;
  const SlotMask slots = triangles_[walked.items.front()].labels;
  if (num_slots(slots & counting_) < 3) return;
  if (!walked.is_closed) {
    chain.ends = {
        is_hub(walked.before) ? joint_of_hub_[hub_of(walked.before)] : triangles_[walked.items.front()].joint,
        is_hub(walked.after) ? joint_of_hub_[hub_of(walked.after)] : triangles_[walked.items.back()].joint};
  }
  LatticeCurve curve{slots, {}, end_of(chain.ends[0]), end_of(chain.ends[1]), walked.is_closed};
  for (const std::uint16_t t : walked.items)
    if (triangles_[t].joint < 0) curve.places.push_back(triangles_[t].place.centroid());
  const CurvePoints found = curve_points(forms_, range_.box(), curve);
  for (const Point& f : found.unconfirmed) unconfirmed_.push_back(in_index_coordinates(f));
  for (const Point& f : found.points) chain.points.push_back(in_index_coordinates(f));
  chain.labels = labels_of(slots);
  chains_.chains.push_back(std::move(chain));
}

FewLabels BlockTracer::labels_of(SlotMask slots) const {
  FewLabels labels;
  for (std::size_t s = 0; s < forms_.size(); ++s)
    if ((slots >> s & 1) != 0) labels.insert(forms_.label(s));
  return labels;
}

SlotMask BlockTracer::counting_slots() const {
  SlotMask slots = 0;
  for (std::size_t s = 0; s < forms_.size(); ++s)
    if (counts_.empty() || counts_[forms_.label(s)]) slots |= static_cast<SlotMask>(1u << s);
  return slots;
}

// Cubes where three labels may win, though none of the cubes around has a curve. One place is enough.
void BlockTracer::find_missed(Pieces& pieces) const {
  std::array<bool, kLatticePoints> is_near{};
  for (const Triangle& t : triangles_) {
    std::array<int, 3> low, high;
    for (std::size_t a = 0; a < 3; ++a) {
      const int at = lattice_steps(t.place.vertex, a);
      low[a] = std::max(at - 2, 0);
      high[a] = std::min(at + 2, kLatticeSteps);
    }
    for (int z = low[2]; z < high[2]; ++z)
      for (int y = low[1]; y < high[1]; ++y)
        for (int x = low[0]; x < high[0]; ++x) is_near[lattice_index(x, y, z)] = true;
  }
  for (int z = range_.low[2]; z < range_.high[2]; ++z)
    for (int y = range_.low[1]; y < range_.high[1]; ++y)
      for (int x = range_.low[0]; x < range_.high[0]; ++x) {
        const std::size_t cube = lattice_index(x, y, z);
        if (is_near[cube] || num_slots(lattice_.possible_in_cube(cube) & counting_) < 3) continue;
        if (const std::optional<Point> place = place_of_three(forms_, cube, counting_))
          pieces.undecided.push_back({block_, in_index_coordinates(*place), UndecidedPlace::Reason::kMissed});
      }
}

void BlockTracer::trace(const Voxel& block, Pieces& pieces) {
  block_ = block;
  corners_ = grid_.corners(block);
  forms_ = WeightForms(corners_);
  counting_ = counting_slots();
  range_ = grid_.range(block);
  lattice_.sample(forms_);
  if (lattice_.has_three_winners()) find_triangles();
  find_joints_on_faces();
  for (std::size_t h = 0; h < hubs_.size(); ++h) add_joint_at_hub(h);
  for_each_chain(triangles_, walked_, [&](const WalkedChain& walked) { add_chain(walked); });
  const RemovedCurves removed =
      merge_chains(chains_, [&](std::size_t n) { return keys_(JointKind::kInBlock, 0, block_, n); });
  append(chains_, false, pieces);
  using enum UndecidedPlace::Reason;
  for (const Point& p : unconfirmed_) pieces.undecided.push_back({block_, p, kUnconfirmed});
  append(removed, block_, pieces);
  lattice_.rule_out();
  find_missed(pieces);
  for (const Triangle& t : triangles_)
    index_of_triangle_[kTypes * t.place.vertex +
                       kTypeOfSteps[8u * t.place.first_step + t.place.second_step]] = -1;
  triangles_.clear();
  hubs_.clear();
  joint_of_hub_.clear();
  chains_.clear();
  unconfirmed_.clear();
}

}  // namespace podm
