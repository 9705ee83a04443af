// A directory of the ranks that hold the points of a mesh in pieces. The rank `id % size` knows all about a
// point.
#pragma once

#include <vector>

#include "mesh.h"
#include "ranks/part.h"

namespace podm::verify {

/// A point of a piece. Pieces are numbered as the index names them.
struct PointOfPiece {
  GlobalId id = 0;
  Point point{};
  std::uint32_t piece = 0;
};

struct Holder {
  GlobalId id = 0;
  std::uint32_t rank = 0;

  bool operator<(const Holder& other) const { return id < other.id; }
};

inline constexpr std::uint32_t kNoRank = kNone;

class PointDirectory {
 public:
  explicit PointDirectory(Communication& ranks) : ranks_(ranks) {}

  /// Collective. Enters this rank's points, each id once. Returns the other ranks that hold them, by id.
  std::vector<Holder> enter(const std::vector<PointOfPiece>& points);

  struct Difference {
    PointOfPiece first, other;
  };
  /// The points of one id that differ, as far as this rank knows.
  const std::vector<Difference>& differences() const { return differences_; }
  /// Collective. Returns the number of ids, and the first that no rank holds.
  GlobalId num_ids() const;
  GlobalId first_gap() const;
  /// Collective. Returns the first rank that holds each point; kNoRank: none holds this id at this place.
  std::vector<std::uint32_t> find_owners(const std::vector<PointOfPiece>& points) const;

 private:
  struct Entry {
    PointOfPiece point;
    std::uint32_t rank;  // the first that holds it
  };
  std::size_t rank_for(GlobalId id) const { return id % static_cast<GlobalId>(ranks_.size()); }
  const Entry* find(const PointOfPiece& point) const;

  Communication& ranks_;
  std::vector<Entry> entries_;  // ascending
  std::vector<Difference> differences_;
};

}  // namespace podm::verify
