// Choices and outcomes by name, as the command line and the records have them.
#include "podm/errors.h"
#include "podm/mesh_image.h"

namespace podm {

std::string to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kComplete:
      return "complete";
    case StopReason::kCancelled:
      return "cancelled";
    case StopReason::kElementLimit:
      return "element limit";
    case StopReason::kTimeLimit:
      return "time limit";
    case StopReason::kMemoryLimit:
      return "memory limit";
    case StopReason::kNumberLimit:
      return "limit of 2^30 cells in the store";
  }
  throw InternalError("unknown stop reason");
}

std::string to_string(Algorithm algorithm) {
  switch (algorithm) {
    case Algorithm::kAuto:
      return "auto";
    case Algorithm::kPodm:
      return "podm";
    case Algorithm::kPdr:
      return "pdr";
    case Algorithm::kPdrPodm:
      return "pdr-podm";
  }
  throw InternalError("unknown algorithm");
}

std::string to_string(Contention contention) {
  switch (contention) {
    case Contention::kAggressive:
      return "aggressive";
    case Contention::kRandom:
      return "random";
    case Contention::kGlobal:
      return "global";
    case Contention::kLocal:
      return "local";
  }
  throw InternalError("unknown contention manager");
}

std::string to_string(Executor executor) { return executor == Executor::kThreads ? "threads" : "virtual"; }

std::string to_string(VirtualCost cost) { return cost == VirtualCost::kUnit ? "unit" : "measured"; }

std::string to_string(Begging begging) { return begging == Begging::kRandom ? "random" : "hierarchical"; }

}  // namespace podm
