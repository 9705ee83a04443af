#include "extract_mesh.h"

#include <algorithm>
#include <utility>

namespace podm {

namespace {

double determinant(const std::array<double, 12>& a) {
  return a[0] * (a[5] * a[10] - a[6] * a[9]) - a[1] * (a[4] * a[10] - a[6] * a[8]) +
         a[2] * (a[4] * a[9] - a[5] * a[8]);
}

// A mirroring affine turns every cell inside out; swapping two vertices turns it back.
void turn_around(TetMesh& mesh) {
  for (auto& cell : mesh.cells) std::swap(cell[2], cell[3]);
  for (auto& facet : mesh.facets) std::swap(facet[1], facet[2]);
}

class Extractor {
 public:
  Extractor(Mesh& mesh, const Isosurface& isosurface, TetMesh& out)
      : mesh_(mesh), isosurface_(isosurface), out_(out), out_ids_(mesh.vertex_bound(), kNoVertex) {}

  // Counts first, so that the cells are not copied while growing; facets are few.
  void reserve() {
    std::size_t cells = 0;
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) cells += label_of(c) != kBackground;
    out_.cells.reserve(cells);
    out_.cell_labels.reserve(cells);
  }

  std::uint64_t add_all() {
    std::uint64_t facets_off_isosurface = 0;
    for (CellId c = 0; c < mesh_.cell_bound(); ++c) {
      prefetch_around(c + kLookahead);
      const LabelIndex label = label_of(c);
      if (label == kBackground) continue;
      const auto& v = mesh_.cell(c).vertices;
      out_.cells.push_back({out_id(v[0]), out_id(v[1]), out_id(v[2]), out_id(v[3])});
      out_.cell_labels.push_back(label);
      for (unsigned k = 0; k < 4; ++k) {
        if (is_written_here(c, k)) facets_off_isosurface += add_facet(c, k);
      }
    }
    return facets_off_isosurface;
  }

 private:
  static constexpr CellId kLookahead = 8;
  void prefetch_around(CellId c) const {
    if (c >= mesh_.cell_bound()) return;
    for (const FacetId mirror : mesh_.cell(c).mirrors) {
      if (mirror != kNoFacet) mesh_.prefetch(cell_of(mirror));
    }
    for (const VertexId v : mesh_.cell(c).vertices) {
      if (v != kNoVertex) __builtin_prefetch(&out_ids_[v]);
    }
  }
  // Dead cells count as background.
  LabelIndex label_of(CellId c) {
    if (!mesh_.cell(c).is_alive()) return kBackground;
    LabelIndex& label = mesh_.label(c);
    if (label == kUnknownLabel) label = isosurface_.label_at(mesh_.cell(c).sphere.center);
    return label;
  }
  LabelIndex label_across(CellId c, unsigned k) {
    const FacetId mirror = mesh_.cell(c).mirrors[k];
    return mirror == kNoFacet ? kBackground : label_of(cell_of(mirror));
  }
  // The cell of the larger label writes the facet.
  bool is_written_here(CellId c, unsigned k) { return label_across(c, k) < label_of(c); }

  bool add_facet(CellId c, unsigned k) {
    bool is_off = false;
    std::array<std::uint32_t, 3> facet{};
    for (unsigned i = 0; i < 3; ++i) {
      // kFacetVertices turns towards the cell; outwards is the other way round.
      const VertexId v = mesh_.cell(c).vertices[static_cast<unsigned>(kFacetVertices[k][2 - i])];
      facet[i] = out_id(v);
      is_off = is_off || mesh_.vertex(v).kind != VertexKind::kIsosurface;
    }
    out_.facets.push_back(facet);
    out_.facet_labels.push_back({label_across(c, k), label_of(c)});
    return is_off;
  }

  std::uint32_t out_id(VertexId v) {
    if (out_ids_[v] == kNoVertex) {
      out_ids_[v] = static_cast<std::uint32_t>(out_.vertices.size());
      const Point& p = mesh_.point(v);
      out_.vertices.push_back({p.x, p.y, p.z});
    }
    return out_ids_[v];
  }

  Mesh& mesh_;
  const Isosurface& isosurface_;
  TetMesh& out_;
  std::vector<std::uint32_t> out_ids_;
};

void convert_to_world(TetMesh& mesh, const LabelImage& image, Space space) {
  const auto& a = image.voxel_to_ras;
  const double flip = space == Space::kLps ? -1 : 1;
  for (auto& v : mesh.vertices) {
    const double i = v[0] / image.spacing[0], j = v[1] / image.spacing[1], k = v[2] / image.spacing[2];
    v = {flip * (a[0] * i + a[1] * j + a[2] * k + a[3]), flip * (a[4] * i + a[5] * j + a[6] * k + a[7]),
         a[8] * i + a[9] * j + a[10] * k + a[11]};
  }
  if (determinant(a) < 0) turn_around(mesh);
  mesh.space = space;
}

}  // namespace

std::uint64_t count_labelled_cells(Mesh& mesh, const Isosurface& isosurface) {
  std::uint64_t count = 0;
  for (CellId c = 0; c < mesh.cell_bound(); ++c) {
    if (!mesh.cell(c).is_alive()) continue;
    const LabelIndex label = mesh.label(c);
    const LabelIndex known = label != kUnknownLabel ? label : isosurface.label_at(mesh.cell(c).sphere.center);
    count += known != kBackground;
  }
  return count;
}

TetMesh extract_mesh(Mesh& mesh, const Isosurface& isosurface, const LabelImage& image, Space space,
                     std::uint64_t& facets_off_isosurface) {
  TetMesh out;
  out.labels = image.labels;
  Extractor extractor(mesh, isosurface, out);
  extractor.reserve();
  facets_off_isosurface = extractor.add_all();
  convert_to_world(out, image, space);
  return out;
}

void convert_to_voxel_space(TetMesh& mesh, const LabelImage& image) {
  const auto& a = image.voxel_to_ras;
  const double det = determinant(a);
  for (auto& v : mesh.vertices) {
    const double x = v[0] - a[3], y = v[1] - a[7], z = v[2] - a[11];
    v = {((a[5] * a[10] - a[6] * a[9]) * x + (a[2] * a[9] - a[1] * a[10]) * y +
          (a[1] * a[6] - a[2] * a[5]) * z) /
             det,
         ((a[6] * a[8] - a[4] * a[10]) * x + (a[0] * a[10] - a[2] * a[8]) * y +
          (a[2] * a[4] - a[0] * a[6]) * z) /
             det,
         ((a[4] * a[9] - a[5] * a[8]) * x + (a[1] * a[8] - a[0] * a[9]) * y +
          (a[0] * a[5] - a[1] * a[4]) * z) /
             det};
  }
  if (det < 0) turn_around(mesh);
  mesh.space = Space::kVoxel;
}

}  // namespace podm
