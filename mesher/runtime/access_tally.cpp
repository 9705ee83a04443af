#include "runtime/access_tally.h"

namespace podm {

AccessTally::AccessTally(int num_nodes) {
  for (auto& by_node : by_node_) by_node.resize(static_cast<std::size_t>(num_nodes));
  samples_.reserve(kMostSamples);
}

void AccessTally::add(AccessKind kind, NodeIndex owner, const void* address) {
  ++by_node_[static_cast<std::size_t>(kind)][owner];
  if (--until_sample_ > 0) return;
  until_sample_ = kAccessesForOneSample;
  if (samples_.size() < kMostSamples) {
    samples_.push_back(address);
  } else {
    samples_[oldest_] = address;
    oldest_ = (oldest_ + 1) % kMostSamples;
  }
}

}  // namespace podm
