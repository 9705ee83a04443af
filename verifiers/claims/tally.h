// Counts of the threads of a check, each over its own range, added up in the order of ranges, and then over
// ranks.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "claim.h"
#include "claims/worst_witnesses.h"
#include "parallel.h"
#include "ranks/part.h"
#include "ranks/tree_sum.h"

namespace podm::verify {

/// A histogram that is being filled.
class Bins {
 public:
  Bins() = default;
  Bins(std::string name, std::string unit, double low, double high, std::size_t num_bins) {
    histogram_.name = std::move(name);
    histogram_.unit = std::move(unit);
    histogram_.low = low;
    histogram_.high = high;
    histogram_.counts.assign(num_bins, 0);
    histogram_.minimum = std::numeric_limits<double>::infinity();
    histogram_.maximum = -std::numeric_limits<double>::infinity();
  }
  void add(double value) {
    histogram_.minimum = std::min(histogram_.minimum, value);
    histogram_.maximum = std::max(histogram_.maximum, value);
    const double last = static_cast<double>(histogram_.counts.size()) - 1;
    const double bin = (value - histogram_.low) / (histogram_.high - histogram_.low) * (last + 1);
    ++histogram_.counts[bin >= 0 ? static_cast<std::size_t>(std::min(bin, last)) : 0];
  }
  void add(const Bins& other) {
    histogram_.minimum = std::min(histogram_.minimum, other.histogram_.minimum);
    histogram_.maximum = std::max(histogram_.maximum, other.histogram_.maximum);
    for (std::size_t b = 0; b < histogram_.counts.size(); ++b)
      histogram_.counts[b] += other.histogram_.counts[b];
  }
  const Histogram& histogram() const { return histogram_; }
  template <class Stream>
  void transfer(Stream& stream) {
    stream(histogram_);
  }

 private:
  Histogram histogram_;
};

/// Returns bins for angles, one per degree.
inline Bins bins_of_degrees(std::string name) { return {std::move(name), "degrees", 0, 180, 180}; }

struct Tally {
  std::uint64_t num_checked = 0, num_exact = 0, num_violations = 0, num_ties = 0;
  WorstWitnesses worst, closest;  // of violations; of all if the check adds them, reported on a pass
  std::vector<GlobalId> bad_cells;
  std::vector<Bins> bins;

  void violation(Witness witness) {
    ++num_violations;
    bad_cells.insert(bad_cells.end(), witness.cells.begin(), witness.cells.end());
    worst.add(std::move(witness));
  }
  void add(const Tally& other) {
    num_checked += other.num_checked;
    num_exact += other.num_exact;
    num_violations += other.num_violations;
    num_ties += other.num_ties;
    worst.add(other.worst);
    closest.add(other.closest);
    bad_cells.insert(bad_cells.end(), other.bad_cells.begin(), other.bad_cells.end());
    for (std::size_t b = 0; b < bins.size(); ++b) bins[b].add(other.bins[b]);
  }
  template <class Stream>
  void transfer(Stream& stream) {
    stream(num_checked, num_exact, num_violations, num_ties, worst, closest, bins);
  }
};

/// Calls body(i, tally) for every i in the range, on several threads. Each thread begins with a copy of
/// `empty`.
template <class Sum = Tally, class Body>
Sum tally_over(const IdRange& range, int threads, const Sum& empty, const Body& body) {
  const std::size_t first = range.begin;
  return sum_over_ranges(range.size(), threads, empty, [&](std::size_t begin, std::size_t end, Sum& part) {
    for (std::size_t i = first + begin; i < first + end; ++i) body(i, part);
  });
}

/// Collective. Returns the sum of the ranks' tallies by their add(), the same on all ranks except
/// `bad_cells`, of which each rank gets its own.
template <class Sum>
Sum over_ranks(const Mesh& mesh, Sum own) {
  std::vector<GlobalId> bad_cells = std::move(own.bad_cells);
  own.bad_cells.clear();
  own = tree_sum(ranks_of(mesh), std::move(own));
  own.bad_cells = own_of(mesh, std::move(bad_cells));
  return own;
}

inline Witness cell_witness(const Mesh& mesh, CellId c, std::string statement, double value,
                            double severity) {
  Witness witness{.statement = std::move(statement),
                  .cells = {global_cell(mesh, c)},
                  .vertices = global_vertices(mesh, mesh.cells[c]),
                  .value = value,
                  .severity = severity,
                  .label = mesh.cell_labels.empty() ? 0 : mesh.cell_labels[c]};
  for (const VertexId v : mesh.cells[c]) witness.points.push_back(mesh.vertices[v]);
  return witness;
}

/// Returns the result of a claim from its tally over_ranks(), without method, reason and details.
inline ClaimResult result_of(const std::string& claim, const Tally& tally) {
  ClaimResult result;
  result.claim = claim;
  result.verdict = verdict_on(tally.num_violations);
  result.num_checked = tally.num_checked;
  result.num_exact = tally.num_exact;
  result.num_violations = tally.num_violations;
  result.worst = (tally.num_violations == 0 ? tally.closest : tally.worst).worst_first();
  result.bad_cells = ascending(tally.bad_cells);  // of several tallies
  for (const Bins& bins : tally.bins) result.histograms.push_back(bins.histogram());
  return result;
}

}  // namespace podm::verify
