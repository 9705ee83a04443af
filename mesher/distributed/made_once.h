// What each rank needs and all make alike, so that ranks of one process may share it.
#pragma once

#include <functional>
#include <memory>
#include <mutex>

#include "distributed/communication.h"

namespace podm {

/// The first rank that asks for it makes it; the clocks of those that come later go on as if they had.
template <class T>
class MadeOnce {
 public:
  /// Not collective. What make() throws goes to the rank that called it, and the next one tries.
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
