// Keeps the worst few of many witnesses; among equals the first cells, vertices and points.
#pragma once

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

#include "claim.h"

namespace podm::verify {

class WorstWitnesses {
 public:
  /// False if a witness of this severity would not be kept, provided that witnesses come in the order of
  /// cells.
  bool wants(double severity) const { return severity > least_kept() || kept_.size() < kMaxWitnesses; }
  /// Returns the severity below which no witness is kept; 0 if all are kept.
  double least_kept() const { return kept_.size() < kMaxWitnesses ? 0 : kept_.back().severity; }
  void add(Witness witness) {
    kept_.insert(std::upper_bound(kept_.begin(), kept_.end(), witness, is_before), std::move(witness));
    if (kept_.size() > kMaxWitnesses) kept_.pop_back();
  }
  void add(const WorstWitnesses& other) {
    for (const Witness& witness : other.kept_) add(witness);
  }
  const std::vector<Witness>& worst_first() const { return kept_; }
  template <class Stream>
  void transfer(Stream& stream) {
    stream(kept_);
  }

 private:
  static bool is_before(const Witness& a, const Witness& b) {
    if (a.severity != b.severity) return a.severity > b.severity;
    return std::tie(a.cells, a.vertices, a.points) < std::tie(b.cells, b.vertices, b.points);
  }
  std::vector<Witness> kept_;
};

}  // namespace podm::verify
