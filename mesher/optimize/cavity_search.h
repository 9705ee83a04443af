// The last resort: any cells that fill a small cavity and are all good enough, found by search (idea: Liu,
// Sun, Chen, "The small polyhedron reconnection for mesh improvement and its implementation", 2009).
//
// The search takes the open facet on which the fewest cells may stand, and tries these cells in turn, best
// first. Cells are positive, so they cover the cavity once when no facet is open (cavity.h): no intersections
// have to be computed. A filling that would cover a place twice is cut off early by three signs: a cell on
// the wrong side of a facet, a boundary vertex inside a cell, and more volume than the cavity has. Vertices
// inside the cavity may be left out.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "optimize/cavity.h"

namespace podm {

class CavitySearch {
 public:
  static constexpr std::size_t kMaxPoints = 28;

  explicit CavitySearch(const OptimizationQuality& quality);

  /// Starts a new set of points. Until the next begin() each point has the same number in every fill().
  void begin(const LabelBound& bound);
  /// Fills the inside of the boundary with cells that are better than `floor`. The facets of the boundary are
  /// counter-clockwise seen from inside. Returns false if there are no such cells, or if they were not found
  /// in `max_steps` steps. The points are `points` and, if given, `added`, which has the last number.
  bool fill(const std::vector<Point>& points, const std::optional<Point>& added,
            const std::vector<LocalFacet>& boundary, double floor, unsigned max_steps);
  const std::vector<LocalCell>& cells() const { return cells_; }
  /// The number of steps of the last search.
  unsigned num_steps() const { return num_steps_; }

 private:
  struct Candidate {
    float quality;
    Local apex;
  };
  struct Change {
    LocalFacet facet;
    bool is_opened;
  };
  // Data of four points: the quality of their cell, with the sign of its orientation in the order of their
  // numbers, or 0 if it violates a bound; and whether a boundary vertex lies inside. Each value is valid for
  // the begin() or fill() in which it was found.
  struct Known {
    std::uint32_t quality_since = 0, holds_since = 0;
    float quality = 0;
    bool holds_vertex = false;
  };

  bool fill();
  std::uint32_t apexes_on(const LocalFacet& facet);
  std::uint32_t good_apexes_on(const LocalFacet& facet);
  bool fits(const LocalFacet& facet, Local apex) const;
  void put(const LocalFacet& facet, Local apex);
  void open(const LocalFacet& facet);
  void close(std::size_t key);
  void undo(std::size_t num_changes);
  float quality_on(const LocalFacet& facet, Local apex);
  float find_quality(const std::array<Local, 4>& ascending) const;
  bool holds_vertex(const std::array<Local, 4>& own) const;
  double six_volumes(const LocalCell& c) const;

  const OptimizationQuality& quality_;
  std::vector<Point> points_;
  std::vector<char> is_on_boundary_;
  LabelBound bound_;
  double floor_ = 0, volume_ = 0, filled_ = 0;
  unsigned max_steps_ = 0, num_steps_ = 0;
  std::size_t num_kept_ = 0;  // points except the added one
  std::uint32_t calls_ = 0, begun_at_ = 0;
  std::vector<Known> known_;           // indexed by the rank of four numbers
  std::vector<LocalFacet> open_;       // counter-clockwise seen from inside
  std::vector<std::uint16_t> opened_;  // indexed by key: 0, or 1 + 2 * position in open_ + is_ascending
  struct Apexes {
    std::uint32_t since = 0, set = 0;
  };
  std::vector<Apexes> apexes_;  // that make good cells on a facet; indexed by 2 * key + is_ascending
  std::vector<Change> changes_;
  std::vector<LocalCell> cells_;
};

}  // namespace podm
