// The processor of each worker, and the binding of threads to processors.
#pragma once

#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "runtime/topology.h"

namespace podm {

/// A pin plan, a number of workers or a binding that is not possible; the message says what is possible.
class PlacementError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct PinPlan {
  enum class Kind { kCompact, kScatter, kNone, kList };

  Kind kind = Kind::kCompact;
  std::vector<int> os_indices;  // of kList, in the order of the workers; no duplicates

  /// Parses compact, scatter, none, or processors such as 0,2,4-7. Throws PlacementError that names the bad
  /// piece.
  static PinPlan parse(std::string_view text);
};

struct Place {
  std::optional<int> processor;  // os_index of the processor to bind to; empty: bound to none
  int node = 0;                  // also the assumed node of a worker that is not bound
  int socket = 0;
};

/// Returns a place for each worker. compact fills node after node, in each a hardware thread of every core
/// before the sibling threads. scatter deals the cores of all nodes in turn, siblings after all cores. none
/// binds no worker and spreads the workers' nodes as scatter does. A list is used as given. Throws
/// PlacementError if there are fewer processors than workers, unless they may share (`oversubscribe`), and if
/// the plan lists a processor that the machine lacks.
std::vector<Place> place_workers(const Topology& machine, const PinPlan& plan, int num_workers,
                                 bool oversubscribe);

/// Returns the processors that this thread may run on, in ascending order, by the numbers of the system.
std::vector<int> processors_of_this_thread();
/// Binds the calling thread to one processor. Throws PlacementError if the system refuses.
void pin_this_thread(int os_index);

/// Binds the calling thread during the object's lifetime, then restores the thread's previous processors.
class ScopedBinding {
 public:
  /// Leaves the thread as it is if `os_index` is empty. Throws the exceptions of pin_this_thread().
  explicit ScopedBinding(std::optional<int> os_index);
  ~ScopedBinding();
  ScopedBinding(const ScopedBinding&) = delete;
  ScopedBinding& operator=(const ScopedBinding&) = delete;

 private:
  std::vector<int> before_;  // empty: nothing to restore
};

struct ThreadProcessor {
  std::optional<int> bound_to;  // empty: the system may choose between several
  int running_on = 0;           // at this moment
};

/// Returns the system's data about the calling thread, as os indices.
ThreadProcessor processor_of_this_thread();

}  // namespace podm
