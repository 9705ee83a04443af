// Keys that identify a measurement. Two runs with the same key are the same measurement, and a run can be
// resumed.
#pragma once

#include <string>

#include "options/schedule.h"
#include "trials/peer.h"
#include "trials/preparation.h"

namespace podm::bench {

/// The parts of a key. A row holds all of them, so that a reader of rows can compute its key again.
struct KeyParts {
  std::string mesher;  ///< hash of the mesher; "none" if the trial makes no mesh
  std::string input;   ///< hash of the image
  std::string trial;   ///< name
  Json options;        ///< as the trial gives them, with the radius found and the hash of a topology
  MachineRecord machine;
  int repeat = 1;
  bool is_warmup = false;
};
/// Returns 64 hexadecimal digits.
std::string key_of(const KeyParts& parts);

/// Names a turn by everything that can change its outcome: the mesher's bytes, the input's bytes, the options
/// with the radius found, the machine and the number of the repeat. Paths, limits and the verifier do not
/// count, nor does the machine that runs a trial in virtual time.
class TrialKeys {
 public:
  /// `podm` is the file of the mesher; podm-mpi is beside it.
  TrialKeys(std::string mesher_sha256, MachineRecord machine, Peers peers = {}, std::string podm = {})
      : mesher_sha256_(std::move(mesher_sha256)),
        machine_(std::move(machine)),
        peers_(std::move(peers)),
        podm_(std::move(podm)) {}

  /// Returns the key_of() the turn. Throws InputError when a topology cannot be read or a peer is unknown.
  std::string of(const Trial& trial, const Turn& turn, const Preparation& preparation);

 private:
  std::string mesher_sha256_;
  MachineRecord machine_;
  Peers peers_;
  std::string podm_;
  FileHashes hashes_;
};

}  // namespace podm::bench
