// Which claims there are, which of them a run is asked for, and the run itself.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "claim.h"
#include "geometry/adjacency.h"
#include "image/image.h"
#include "image/size_image.h"
#include "options.h"
#include "schedule.h"

namespace podm::verify {

/// What a claim needs beside the mesh.
enum class Needs { kNothing, kImage, kBound, kDihedralBound };

/// Throws InputError where a claim is asked for that there is not.
void check_claims(const Options& options);
/// The claims asked for by name, or without names all whose inputs were given and that the mesh's file does
/// not say are not claimed.
std::vector<std::string> chosen_claims(const Options& options, const Mesh& mesh);

struct Inputs {
  Mesh mesh;
  std::optional<Image> image;
  std::optional<SizeImage> sizes;
  std::optional<Schedule> schedule;
};

struct Claim {
  std::string name;
  Needs needs;
  ClaimResult (*check)(const Inputs&, const Adjacency&, const Options&);
};
/// All claims, in the order in which they run.
const std::vector<Claim>& all_claims();

/// Reads the files that `options` name. Throws InputError.
Inputs read_inputs(const Options& options);

/// One result a name; a claim that cannot be decided is not_run with the reason. `announce` is
/// told of each claim that begins.
std::vector<ClaimResult> run_claims(const Inputs& inputs, const Options& options,
                                    const std::vector<std::string>& names,
                                    const std::function<void(const std::string&)>& announce);

}  // namespace podm::verify
