#include <fmt/format.h>

#include <random>

#include "experiments/image_folder.h"
#include "process/sha256.h"
#include "process/stop_request.h"
#include "submissions/archive.h"
#include "submissions/commands.h"
#include "submissions/remesh.h"
#include "submissions/rules.h"

namespace podm::bench {
namespace {

std::map<std::string, std::string> images_by_hash(const std::vector<std::string>& images) {
  std::map<std::string, std::string> by_hash;
  for (const std::string& image : with_images_of_folders(images))
    by_hash.emplace(sha256_of_file(image), image);
  return by_hash;
}

std::uint64_t random_seed() {
  std::random_device source;
  return source();
}

}  // namespace

int check_submission(const CheckCommand& command) {
  const PackedFiles files = unpack(command.archive);
  Faults faults;
  const Submission submission = read_submission(files, command.archive, faults);
  const ExperimentsOn experiments = experiments_in(command.experiments_folder);
  check_rules(submission, experiments, faults);
  Remeshing remeshing;
  if (faults.empty()) {  // rows that break a rule need no mesh
    const RemeshSettings settings{command.programs, command.num_meshes, command.seed.value_or(random_seed()),
                                  images_by_hash(command.images)};
    if (command.num_meshes > 0) fmt::print(stderr, "meshing again, with --sample-seed {}\n", settings.seed);
    const StopQuery is_interrupted = stop_on_signals();
    remeshing = remesh_sample(submission, experiments, settings, is_interrupted, faults);
    if (is_interrupted()) return kExitMissed;
  }
  for (const std::string& line : remeshing.made) fmt::print("meshed again: {}\n", line);
  for (const std::string& line : remeshing.not_made) fmt::print("not meshed again: {}\n", line);
  const bool needs_mesh = submission.manifest.division == Division::kClosed && command.num_meshes > 0;
  if (faults.empty() && needs_mesh && remeshing.made.empty())
    faults.push_back({"meshed again", "no mesh of it can be made here"});
  fmt::print("{}", describe(faults));
  fmt::print("{}: {}\n", faults.empty() ? "VALID" : "NOT VALID", describe(submission));
  return faults.empty() ? 0 : kExitMissed;
}

}  // namespace podm::bench
