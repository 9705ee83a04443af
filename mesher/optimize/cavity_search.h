// The last resort: any cells at all that fill a small cavity and are all good enough, found by search (idea:
// Liu, Sun, Chen, "The small polyhedron reconnection for mesh improvement and its implementation", 2009).
//
// From the facets that are still open it takes the one that the fewest cells may stand on, and tries these
// in turn, best first. Cells are positive, so that when no facet is open they cover the cavity once
// (cavity.h): nothing has to be intersected. What would cover a place twice is cut off early by three signs:
// a cell on a facet from the wrong side, one with a vertex of the boundary inside, and more volume than there
// is. Vertices inside the cavity may be left out.
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

  explicit CavitySearch(const CellQuality& quality);

  /// Points that are given from now on have nothing to do with those before. Until then each has the same
  /// number whenever it is given.
  void begin(const LabelBound& bound);
  /// Fills the inside of the boundary, whose facets turn counter-clockwise seen from there, with cells that
  /// are better than `floor`. False: there are none, or they were not found in so many steps. The points are
  /// `points` and, if there is one, `added`, which is numbered as the last.
  bool fill(const std::vector<Point>& points, const std::optional<Point>& added,
            const std::vector<LocalFacet>& boundary, double floor, unsigned max_steps);
  const std::vector<LocalCell>& cells() const { return cells_; }
  /// Steps of the last search.
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
  // Of four points: the quality of their cell, with the sign of its orientation in the order of their
  // numbers, 0: it breaks a bound; and whether a vertex of the boundary lies inside. Each is known since some
  // begin() or fill().
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

  const CellQuality& quality_;
  std::vector<Point> points_;
  std::vector<char> is_on_boundary_;
  LabelBound bound_;
  double floor_ = 0, volume_ = 0, filled_ = 0;
  unsigned max_steps_ = 0, num_steps_ = 0;
  std::size_t num_kept_ = 0;  // points that are no added one
  std::uint32_t calls_ = 0, begun_at_ = 0;
  std::vector<Known> known_;           // by the rank of four numbers
  std::vector<LocalFacet> open_;       // turned to the inside
  std::vector<std::uint16_t> opened_;  // by key: 1 + 2 * the place in open_ + whether it turns with its key
  struct Apexes {
    std::uint32_t since = 0, set = 0;
  };
  std::vector<Apexes>
      apexes_;  // with which a facet makes a good cell: by 2 * key + whether it turns with that
  std::vector<Change> changes_;
  std::vector<LocalCell> cells_;
};

}  // namespace podm
