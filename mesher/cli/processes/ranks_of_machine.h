// Which ranks share a machine, and what of it each may take.
#pragma once

#include <string>
#include <vector>

#include "distributed/communication.h"

namespace podm::cli {

class RanksOfMachine {
 public:
  /// Collective. Throws InternalError where the system does not tell.
  explicit RanksOfMachine(Communication& ranks);

  int num_machines() const { return static_cast<int>(machines_.size()); }
  /// By rank.
  const std::string& host(std::size_t rank) const { return places_[rank].host; }
  /// On the machine of this rank.
  int num_ranks_here() const { return here().num_ranks; }
  /// An even share of the processors that its ranks may use, and no more than this one may.
  int share_of_processors() const;
  /// One line for each machine that has fewer processors than its ranks have threads. Collective.
  std::vector<std::string> warnings(int threads) const;

 private:
  struct Place {
    std::string boot_id, host;
    std::vector<int> processors;  // those that the rank may use
    std::size_t machine = 0;
  };
  struct Machine {
    int num_ranks = 0;
    std::vector<int> processors;  // of all its ranks, each once
  };
  const Machine& here() const { return machines_[places_[own_].machine]; }

  Communication& ranks_;
  std::size_t own_;
  std::vector<Place> places_;  // by rank
  std::vector<Machine> machines_;
};

}  // namespace podm::cli
