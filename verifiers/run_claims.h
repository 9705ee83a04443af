// The list of claims, the claims that a run checks, and the run itself.
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

/// The input that a claim needs in addition to the mesh.
enum class Needs {
  kNothing,
  kImage,
  kBound,
  kDihedralBound,
  kPromisedImage,  ///< an image, and a file that promises the claim, or a request by name
  kFlatBox,        ///< an image, and a flat box: an option or a file that promises it
  kLines,          ///< an image, and the distance at which the mesh samples lines; not on ranks
};

/// Throws InputError if an unknown claim is asked for.
void check_claims(const Options& options);
/// Returns the claims asked for by name. Without names, returns all claims whose inputs were given, except
/// those that the mesh file states not to make.
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
/// Returns all claims, in the order in which they run.
const std::vector<Claim>& all_claims();

/// Reads the files that `options` name beside the mesh. Throws InputError.
Inputs read_inputs(const Options& options, Mesh mesh);

/// Returns one result per name. A claim that cannot be decided is not_run, with the reason. Calls `announce`
/// with each claim that begins. Collective; all ranks get the same results except `bad_cells`.
std::vector<ClaimResult> run_claims(const Inputs& inputs, const Options& options,
                                    const std::vector<std::string>& names,
                                    const std::function<void(const std::string&)>& announce);

}  // namespace podm::verify
