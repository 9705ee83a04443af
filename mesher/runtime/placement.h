// Which processor each worker runs on, and the binding of threads to processors.
#pragma once

#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "runtime/topology.h"

namespace podm {

/// A pin plan, a number of workers or a binding that cannot be had; the message says what can.
class PlacementError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct PinPlan {
  enum class Kind { kCompact, kScatter, kNone, kList };

  Kind kind = Kind::kCompact;
  std::vector<int> os_indices;  // of kList, in the order of the workers; none twice

  /// compact, scatter, none, or processors such as 0,2,4-7. Throws PlacementError naming the bad piece.
  static PinPlan parse(std::string_view text);
};

struct Place {
  std::optional<int> processor;  // os_index of the processor to bind to; empty: bound to none
  int node = 0;                  // where a worker bound to none counts as being, too
  int socket = 0;
};

/// A place for each worker. compact fills node after node, in each a hardware thread of every core before
/// their siblings; scatter deals the cores of all nodes in turn, siblings after all cores; none binds nobody
/// and spreads the workers' nodes as scatter does; a list is taken as it stands.
/// Throws PlacementError when there are fewer processors than workers, unless they may share
/// (`oversubscribe`), and when the plan lists a processor that the machine lacks.
std::vector<Place> place_workers(const Topology& machine, const PinPlan& plan, int num_workers,
                                 bool oversubscribe);

/// Binds the calling thread to one processor. Throws PlacementError when the system refuses.
void pin_this_thread(int os_index);

/// Binds the calling thread as long as it lives, then gives it back the processors that it had.
class ScopedBinding {
 public:
  /// Empty: leaves the thread as it is. Throws as pin_this_thread does.
  explicit ScopedBinding(std::optional<int> os_index);
  ~ScopedBinding();
  ScopedBinding(const ScopedBinding&) = delete;
  ScopedBinding& operator=(const ScopedBinding&) = delete;

 private:
  std::vector<int> before_;  // empty: nothing to give back
};

struct ThreadProcessor {
  std::optional<int> bound_to;  // empty: the system may choose between several
  int running_on = 0;           // at this moment
};

/// What the system says of the calling thread; os indices.
ThreadProcessor processor_of_this_thread();

}  // namespace podm
