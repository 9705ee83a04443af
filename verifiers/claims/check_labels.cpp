// Claim labels.
//   Statements  First, each cell's label is the image's label at its circumcenter: the label with the
//               greatest trilinear weight among the eight voxels around that point, the smaller label if
//               there is a tie, background (0) outside the grid. In a smoothed image, weights take the
//               voxel weights into account (image/smoothing.h). The flat cells of a mesh that does not
//               claim to be Delaunay have their circumcenters far away. For such a mesh, the label is the
//               image's at the cell's centroid, or a voxel of that label is within reach. The reach is a
//               voxel's diagonal plus the longer of 2 delta (--delta) and another diagonal; interfaces of
//               mesh and image are no nearer each other than that. Second, each label of the mesh is one of
//               the image's. Third, each label that has more than 1000 voxels in the image has a cell.
//   Rests on    Weights are continuous and change by at most 1 per voxel along each axis. The order of two
//               weights at a point therefore holds for all points nearer than half their difference
//               (label_function.h). The circumcenter is known up to a bound (check_labels_circumcenter.h). If
//               weights are as close as that, rational arithmetic decides the label at the circumcenter of
//               the written coordinates. A cell with another label than that one is still right if its label
//               wins within the bound: a mesher computes a circumcenter in rounded arithmetic, possibly in
//               other coordinates than the file's. Such cells are counted ("within_rounding") and not judged.
//               The bound allows for slopes of 1 per voxel; where voxel weights of S make them as small, it
//               forgives up to 1/S times the rounding. Voxel weights are taken to be right: smoothing.cpp
//               computes them and is tested against its definition.
//   Cost        Linear in the cells, and a pass over the voxels; 24 bytes per vertex, 8 per voxel of the
//               mesh's box.
//   Not proved  That the label is the image's elsewhere in the cell. Volume and overlap (Dice, by voxel
//               centers within the grid) of each label are reported for that, not judged. The first statement
//               is the promise of meshers of the PODM family; a mesh of another mesher need not keep it.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "claims/check_labels_circumcenter.h"
#include "claims/check_labels_overlap.h"
#include "claims/check_labels_reach.h"
#include "claims/claims.h"
#include "claims/tally.h"
#include "image/label_function.h"
#include "parallel.h"

namespace podm::verify {

namespace {

constexpr std::uint64_t kVoxelsThatMustBeMeshed = 1000;

struct LabelTally : Tally {
  std::uint64_t within_rounding = 0, within_reach = 0;

  void add(const LabelTally& other) {
    Tally::add(other);
    within_rounding += other.within_rounding;
    within_reach += other.within_reach;
  }
  template <class Stream>
  void transfer(Stream& stream) {
    Tally::transfer(stream);
    stream(within_rounding, within_reach);
  }
};

class CellLabels {
 public:
  CellLabels(const Mesh& mesh, const Image& image, Space space, double delta_mm, int threads)
      : mesh_(mesh),
        frame_(image, space),
        locator_(mesh, image, frame_, threads),
        exact_label_(mesh, image, space),
        label_function_(image),
        reach_(image, std::max(2 * delta_mm, LabelReach(image, 0).mm())) {}

  void check(CellId cell, LabelTally& tally) const {
    if (is_by_centroid()) return check_centroid(cell, tally);
    const LocatedPoint center = locator_.circumcenter(cell);
    const LabelWeights weights = label_function_.weights_at(center.voxels);
    const std::size_t best = weights.best();
    const LabelValue stated = mesh_.cell_labels[cell];
    const double lead = lead_of(stated, weights, best);
    const double slack = 2 * (center.error + LabelFunction::kWeightError);
    if (label_function_.is_at_side(center.voxels, center.error)) {
      decide_exactly(cell, center, tally);
    } else if (lead > slack) {
      keep(tally.closest, cell, center, lead, -lead);
    } else if (-lead > slack) {
      add_wrong(tally, cell, center, lead, -lead);
    } else {
      decide_exactly(cell, center, tally);
    }
  }

  bool is_by_centroid() const { return mesh_.unclaimed.contains("delaunay"); }
  double reach_mm() const { return reach_.mm(); }
  const ImageFrame& frame() const { return frame_; }
  const std::vector<Point>& points() const { return locator_.points(); }

 private:
  // A label that wins is that of one of the eight voxels around the point. A case that rounding leaves open
  // is therefore within reach.
  void check_centroid(CellId cell, LabelTally& tally) const {
    const LocatedPoint center = locator_.centroid(cell);
    const LabelWeights weights = label_function_.weights_at(center.voxels);
    const double lead = lead_of(mesh_.cell_labels[cell], weights, weights.best());
    if (lead > 0) {
      keep(tally.closest, cell, center, lead, -lead);
    } else if (reach_.has(static_cast<std::uint32_t>(mesh_.cell_labels[cell]), center.voxels)) {
      ++tally.within_reach;
    } else {
      add_wrong(tally, cell, center, lead, -lead);
    }
  }

  // Returns by how much the stated label's weight exceeds every other weight.
  static double lead_of(LabelValue stated, const LabelWeights& weights, std::size_t best) {
    double own = 0, other = 0;
    for (std::size_t i = 0; i < weights.count; ++i) {
      const bool is_own = static_cast<LabelValue>(weights.labels[i]) == stated;
      (is_own ? own : other) = std::max(is_own ? own : other, weights.weights[i]);
    }
    return static_cast<LabelValue>(weights.labels[best]) == stated ? own - other
                                                                   : own - weights.weights[best];
  }

  void decide_exactly(CellId cell, const LocatedPoint& center, LabelTally& tally) const {
    ++tally.num_exact;
    const std::optional<std::uint32_t> label = exact_label_(cell);
    if (!label) {  // no circumcenter
      add_wrong(tally, cell, center, -1, 1);
    } else if (static_cast<LabelValue>(*label) != mesh_.cell_labels[cell]) {
      ++tally.within_rounding;
    } else {
      keep(tally.closest, cell, center, 0, 0);
    }
  }

  void add_wrong(LabelTally& tally, CellId cell, const LocatedPoint& center, double lead,
                 double severity) const {
    ++tally.num_violations;
    tally.bad_cells.push_back(global_cell(mesh_, cell));
    keep(tally.worst, cell, center, lead, severity);
  }

  void keep(WorstWitnesses& list, CellId cell, const LocatedPoint& center, double lead,
            double severity) const {
    if (!list.wants(severity)) return;
    Witness witness;
    witness.statement = is_by_centroid() ? "the label is the image's at the centroid or within reach of it"
                                         : "the label is the image's at the circumcentre";
    witness.cells = {global_cell(mesh_, cell)};
    witness.vertices = global_vertices(mesh_, mesh_.cells[cell]);
    witness.points = {frame_.voxels_to_mesh(center.voxels)};
    witness.value = lead;
    witness.severity = severity;
    witness.label = mesh_.cell_labels[cell];
    list.add(witness);
  }

  const Mesh& mesh_;
  ImageFrame frame_;
  CircumcenterLocator locator_;
  ExactCircumcenterLabel exact_label_;
  LabelFunction label_function_;
  LabelReach reach_;
};

// Judges statements 2 and 3, and reports the table of volumes and overlaps.
void judge_labels(const Mesh& mesh, const std::map<LabelValue, LabelOverlap>& overlaps, double voxel_mm3,
                  ClaimResult& result) {
  auto table = nlohmann::json::array(), absent = nlohmann::json::array(), unknown = nlohmann::json::array();
  for (const auto& [label, overlap] : overlaps) {
    const auto name = mesh.label_names.find(label);
    const bool is_meshed = overlap.mesh_mm3 > 0;
    table.push_back({{"label", label},
                     {"name", name == mesh.label_names.end() ? "" : name->second},
                     {"image_voxels", overlap.image_voxels},
                     {"mesh_voxels", overlap.mesh_voxels},
                     {"dice", overlap.image_voxels + overlap.mesh_voxels == 0 ? 0 : overlap.dice()},
                     {"image_mm3", static_cast<double>(overlap.image_voxels) * voxel_mm3},
                     {"mesh_mm3", overlap.mesh_mm3}});
    Witness witness;
    witness.label = label;
    if (overlap.image_voxels == 0) {
      unknown.push_back(label);
      witness.statement = "the image has each label of the mesh";
      witness.value = overlap.mesh_mm3;
    } else if (!is_meshed) {
      absent.push_back({{"label", label}, {"voxels", overlap.image_voxels}});
      if (overlap.image_voxels <= kVoxelsThatMustBeMeshed) {
        ++result.num_warnings;
        continue;
      }
      witness.statement = "each label of more than 1000 voxels has a cell";
      witness.value = static_cast<double>(overlap.image_voxels);
    } else {
      continue;
    }
    witness.severity = 1 + witness.value;
    ++result.num_violations;
    result.worst.push_back(witness);
  }
  result.details()["labels"] = table;
  result.details()["labels_absent_in_mesh"] = absent;
  result.details()["labels_unknown_to_image"] = unknown;
}

}  // namespace

ClaimResult check_labels(const Mesh& mesh, const Image& image, const Options& options) {
  ClaimResult result;
  result.claim = "labels";
  result.method = "trilinear weights within a derived error bound, then exact rationals";
  result.reason = lack_of_cell_labels(mesh);
  if (!result.reason.empty()) return result;
  const int threads = num_threads(options.threads);
  const Space space = options.space.value_or(mesh.space);
  const CellLabels labels(mesh, image, space, options.delta_mm.value_or(0), threads);
  const LabelTally tally = over_ranks(
      mesh, tally_over(own_cells(mesh), threads, LabelTally{}, [&](std::size_t cell, LabelTally& part) {
        labels.check(static_cast<CellId>(cell), part);
      }));

  const double voxel_mm3 = labels.frame().voxel_volume_mm3();
  judge_labels(mesh, find_overlaps(mesh, image, labels.points(), voxel_mm3, threads), voxel_mm3, result);
  result.num_checked = num_cells(mesh);
  result.num_exact = tally.num_exact;
  result.num_violations += tally.num_violations;
  result.bad_cells = tally.bad_cells;
  result.details()["space"] = describe(space);
  result.details()["within_rounding"] = tally.within_rounding;
  result.details()["within_reach"] = tally.within_reach;
  result.reason =
      labels.is_by_centroid()
          ? fmt::format(
                "{} of {} cells have a label that the image has neither at their centroid nor within {:.3g} "
                "mm "
                "({} within)",
                tally.num_violations, num_cells(mesh), labels.reach_mm(), tally.within_reach)
          : fmt::format(
                "{} of {} cells have another label than the image at their circumcentre ({} within rounding)",
                tally.num_violations, num_cells(mesh), tally.within_rounding);
  const auto& witnesses = result.num_violations > 0 ? tally.worst : tally.closest;
  result.worst.insert(result.worst.end(), witnesses.worst_first().begin(), witnesses.worst_first().end());
  result.worst.resize(std::min(result.worst.size(), kMaxWitnesses));
  result.verdict = verdict_on(result.num_violations);
  return result;
}

}  // namespace podm::verify
