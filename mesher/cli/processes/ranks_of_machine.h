// The ranks that share a machine, and the share of the machine that each rank may use.
#pragma once

#include <string>
#include <vector>

#include "distributed/communication.h"

namespace podm::cli {

class RanksOfMachine {
 public:
  /// Collective. Throws InternalError if the system does not report the machine.
  explicit RanksOfMachine(Communication& ranks);

  int num_machines() const { return static_cast<int>(machines_.size()); }
  /// Returns the host name of a rank.
  const std::string& host(std::size_t rank) const { return places_[rank].host; }
  /// Returns the number of ranks on this rank's machine.
  int num_ranks_here() const { return here().num_ranks; }
  /// Returns an even share of the processors that the machine's ranks may use, and at most the number that
  /// this rank may use.
  int share_of_processors() const;
  /// Returns one line per machine that has fewer processors than its ranks have threads, and one line if a
  /// machine has several ranks. Collective.
  std::vector<std::string> warnings(int threads) const;

 private:
  struct Place {
    std::string boot_id, host;
    std::vector<int> processors;  // those that the rank may use
    std::size_t machine = 0;
  };
  struct Machine {
    int num_ranks = 0;
    std::vector<int> processors;  // those of all its ranks, each once
  };
  const std::string& host_of_machine(std::size_t machine) const;
  const Machine& here() const { return machines_[places_[own_].machine]; }

  Communication& ranks_;
  std::size_t own_;
  std::vector<Place> places_;  // by rank
  std::vector<Machine> machines_;
};

}  // namespace podm::cli
