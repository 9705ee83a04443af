// What makes two runs of the mesher the same measurement, so that a run may be resumed.
#pragma once

#include <string>

#include "options/schedule.h"
#include "trials/peer.h"
#include "trials/preparation.h"

namespace podm::bench {

/// Names a turn by all that can change its outcome: the mesher's bytes, the input's bytes, the options with
/// the radius that was found, the machine and the number of the repeat. Not by paths, limits or the verifier,
/// and of trials in virtual time not by the machine that plays them.
class TrialKeys {
 public:
  /// `podm` is the mesher's file, which podm-mpi is beside.
  TrialKeys(std::string mesher_sha256, MachineRecord machine, Peers peers = {}, std::string podm = {})
      : mesher_sha256_(std::move(mesher_sha256)),
        machine_(std::move(machine)),
        peers_(std::move(peers)),
        podm_(std::move(podm)) {}

  /// 64 hexadecimal digits. Throws InputError when a topology cannot be read or a peer is unknown.
  std::string of(const Trial& trial, const Turn& turn, const Preparation& preparation);

 private:
  std::string mesher_sha256_;
  MachineRecord machine_;
  Peers peers_;
  std::string podm_;
  FileHashes hashes_;
};

}  // namespace podm::bench
