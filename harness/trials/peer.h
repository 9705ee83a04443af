// Peers are meshers other than podm. Each is a folder with a program `run` that keeps the contract of
// peers/README.md.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "options/trial_settings.h"
#include "trials/preparation.h"

namespace podm::bench {

struct Peer {
  std::string program;
  std::string version;  ///< and licence, in one line
  std::string absence;  ///< the reason why it cannot run here; empty: it can

  /// Hashes the program's bytes, its version, and the code that adapters share: the *.py beside their
  /// folders.
  std::string sha256() const;
};

/// True if a mesher other than podm runs the trial.
bool is_of_peer(const Trial& trial);

/// The peers of a folder. Each is asked for its version once.
class Peers {
 public:
  Peers() = default;  ///< no peers
  /// `podm` is the program that makes surfaces for the peers.
  Peers(std::string folder, std::string podm) : folder_(std::move(folder)), podm_(std::move(podm)) {}

  /// Returns the peer of the trial. Throws InputError when there is none of this name.
  const Peer& of(const Trial& trial);

 private:
  std::string folder_, podm_;
  std::map<std::string, Peer> peers_;
};

/// Returns the command line of the trial; it writes mesh and record to `folder`.
std::vector<std::string> peer_command(const Trial& trial, const Preparation& preparation, const Peer& peer,
                                      const std::string& podm, const std::string& folder);

/// Returns a peer's record with the members of a MeshRecord that a peer need not write.
Json complete_record(const Trial& trial, const Preparation& preparation, Json record);

}  // namespace podm::bench
