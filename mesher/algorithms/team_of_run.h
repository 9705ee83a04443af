// The team of a run: the number of workers, their places in a machine, and the nodes of the machine that hold
// the image.
#pragma once

#include <optional>

#include "algorithms/construction.h"
#include "algorithms/page_sampler.h"
#include "algorithms/placement_of_team.h"
#include "algorithms/team_size.h"
#include "isosurface/feature_transform.h"

namespace podm {

class TeamOfRun {
 public:
  /// Throws InputError on a team that the machine cannot have. The options must outlive this object.
  explicit TeamOfRun(const MeshingOptions& options);
  TeamOfRun(const TeamOfRun&) = delete;
  TeamOfRun& operator=(const TeamOfRun&) = delete;

  /// Determines the owners of image and transform, unless all memory is on one node. The image must outlive
  /// this object.
  void locate_memory(const LabelImage& image, const FeatureTransform& transform);

  /// Called when a mesh begins: the caches of virtual workers' nodes then hold nothing of the image, although
  /// the run may have made other meshes before.
  void forget_reads();

  const TeamSize& size() const { return size_; }
  /// Returns the team for the algorithms; it refers to this object.
  Team team() const;
  /// Records the team, and the nodes of sampled pages.
  void report_to(MeshingReport& report, PageSamples pages) const;

 private:
  std::string why_no_pages() const;

  const MeshingOptions& options_;
  const PlacementOfTeam placement_;
  const TeamSize size_;
  std::optional<ImageOwners> owners_;
  std::optional<PageSampler> pages_;
};

}  // namespace podm
