// Meshers other than podm: each a folder with a program `run` that keeps the contract of peers/README.md.
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
  std::string absence;  ///< why it cannot run here; empty: it can

  /// The hash is that of its bytes and version, and of what the adapters share, the *.py beside their
  /// folders.
  std::string sha256() const;
};

/// Whether a mesher other than podm runs the trial.
bool is_of_peer(const Trial& trial);

/// The peers of a folder. Each is asked once for its version.
class Peers {
 public:
  Peers() = default;  ///< none
  /// `podm` is the program that makes surfaces for them.
  Peers(std::string folder, std::string podm) : folder_(std::move(folder)), podm_(std::move(podm)) {}

  /// The one of the trial. Throws InputError when there is none of this name.
  const Peer& of(const Trial& trial);

 private:
  std::string folder_, podm_;
  std::map<std::string, Peer> peers_;
};

/// What runs the trial; mesh and record go to `folder`.
std::vector<std::string> peer_command(const Trial& trial, const Preparation& preparation, const Peer& peer,
                                      const std::string& podm, const std::string& folder);

/// A peer's record, as it wrote it, with what a MeshRecord has and a peer need not tell.
Json complete_record(const Trial& trial, const Preparation& preparation, Json record);

}  // namespace podm::bench
