// The team of a run: how many refine, where in which machine they stand, and on which of its nodes the image
// lies.
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
  /// Throws InputError on a team that the machine cannot have. The options must outlive the team.
  explicit TeamOfRun(const MeshingOptions& options);
  TeamOfRun(const TeamOfRun&) = delete;
  TeamOfRun& operator=(const TeamOfRun&) = delete;

  /// Finds out whose memory is what, unless all is on one node. The image must outlive the team.
  void locate_memory(const LabelImage& image, const FeatureTransform& transform);

  /// A mesh begins: the caches of virtual workers' nodes have nothing of the image, whatever meshes of the
  /// run were made before.
  void forget_reads();

  const TeamSize& size() const { return size_; }
  /// The team as algorithms take it; it refers to this.
  Team team() const;
  /// Takes down who refined and where pages were.
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
