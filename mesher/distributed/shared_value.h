// A value that each rank needs and all ranks make alike. Ranks of one process may share it.
#pragma once

#include <functional>
#include <memory>
#include <mutex>

#include "distributed/communication.h"

namespace podm {

/// The first rank that requests the value makes it. The clocks of ranks that come later advance as if they
/// had made it.
template <class T>
class SharedValue {
 public:
  /// Returns the value. Not collective. An exception of make() goes to the rank that called it, and the next
  /// rank tries again.
  std::shared_ptr<const T> get(const std::function<std::shared_ptr<const T>()>& make, Communication& rank) {
    const std::scoped_lock lock(mutex_);
    if (made_ != nullptr) {
      rank.charge(seconds_);
    } else {
      const double start_s = rank.seconds();
      made_ = make();
      seconds_ = rank.seconds() - start_s;
    }
    return made_;
  }

 private:
  std::mutex mutex_;
  std::shared_ptr<const T> made_;
  double seconds_ = 0;
};

}  // namespace podm
