// Pieces of curves within one block, and the joints at which pieces of different blocks meet. Points are in
// index coordinates: the center of voxel (i,j,k) is (i,j,k).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/point.h"
#include "image/voxel.h"
#include "lines/few_labels.h"
#include "lines/line_network.h"

namespace podm {

/// Names a joint. All blocks that meet there give it the same name.
using JointKey = std::uint64_t;

enum class JointKind : std::uint8_t {
  kOnFace,    ///< on the lower face of a block, across an axis
  kInBlock,   ///< where curves meet inside a block
  kOnEdge,    ///< on a side of the box, between two voxels along an axis
  kInSquare,  ///< inside a block's square on a side of the box, which is across an axis
  kCorner,    ///< a corner of the box
};

/// Names joints of an image.
class JointKeys {
 public:
  explicit JointKeys(const std::array<int, 3>& size) : size_(size) {}
  /// `place` is a block or a voxel, each coordinate from -1 to the size; `axis` may be 0 if it has no
  /// meaning, and `number` distinguishes joints of one place.
  JointKey operator()(JointKind kind, std::size_t axis, const Voxel& place, std::size_t number) const {
    const auto along = [&](int at, std::size_t a) {
      return static_cast<std::uint64_t>(at + 1) % (static_cast<std::uint64_t>(size_[a]) + 2);
    };
    const std::uint64_t nx = static_cast<std::uint64_t>(size_[0]) + 2,
                        ny = static_cast<std::uint64_t>(size_[1]) + 2;
    const std::uint64_t index = (along(place.k, 2) * ny + along(place.j, 1)) * nx + along(place.i, 0);
    return ((index << 13 | number) << 3 | static_cast<std::uint64_t>(kind)) << 2 | axis;
  }

 private:
  std::array<int, 3> size_;
};

struct Joint {
  JointKey key;
  Point point;
  std::uint8_t sides = 0;
  FewLabels labels;
};

struct Piece {
  std::array<JointKey, 2> ends;
  bool is_closed;
  std::uint8_t sides;
  FewLabels labels;
  std::uint32_t num_points;  // the ends' points included
};

/// Lines that are too short or too close to others to be kept.
struct RemovedCurves {
  std::vector<Point> points;  // one of each
  double length_voxels = 0;   // of all
};

/// The pieces of some blocks, in their order.
struct Pieces {
  std::vector<Piece> pieces;
  std::vector<Point> points;  // of all pieces
  std::vector<Joint> joints;
  std::vector<UndecidedPlace> undecided;  // points in index coordinates
  double removed_voxels = 0;              // length of lines removed in blocks
};

}  // namespace podm
