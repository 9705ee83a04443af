#include "run/extract_mesh.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>
#include <vector>

#include "image/working_frame.h"
#include "run/delaunay_when_turned.h"
#include "run/facets_of_sides.h"
#include "run/mend_turned_cells.h"
#include "runtime/huge_array.h"
#include "runtime/parallel_for.h"
#include "runtime/parallel_resize.h"

namespace podm {

namespace {

// Threads share the work in chunks of ids.
constexpr std::size_t kChunk = 1 << 11;

std::size_t num_chunks(std::uint32_t num_ids) { return (num_ids + kChunk - 1) / kChunk; }

/// Calls work(chunk, begin, end) for every chunk of the ids from `first`, which begins a chunk, to `last`.
template <class Work>
void for_each_chunk(std::uint32_t first, std::uint32_t last, std::size_t threads, const Work& work) {
  parallel_for_ranges(last - first, kChunk, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    work((first + begin) / kChunk, first + static_cast<std::uint32_t>(begin),
         first + static_cast<std::uint32_t>(end));
  });
}

/// Calls work(begin, end) for about sixteen slices of the ids below `num_ids`, one after another. Each slice
/// consists of whole chunks.
template <class Work>
void for_each_slice(std::uint32_t num_ids, const Work& work) {
  const auto length = static_cast<std::uint32_t>(kChunk * std::max<std::size_t>(1, num_chunks(num_ids) / 16));
  for (std::uint32_t begin = 0; begin < num_ids; begin += std::min(length, num_ids - begin))
    work(begin, begin + std::min(length, num_ids - begin));
}

// One number per chunk: the number of items that it adds to the output. After sum_up() it is the position in
// the output where they begin.
class Starts {
 public:
  explicit Starts(std::uint32_t num_ids) : starts_(num_chunks(num_ids) + 1) {}
  std::size_t& operator[](std::size_t chunk) { return starts_[chunk]; }
  /// The number of items of all chunks before `id`, which must end a chunk.
  std::size_t before(std::uint32_t id) const { return starts_[num_chunks(id)]; }
  void sum_up() { std::exclusive_scan(starts_.begin(), starts_.end(), starts_.begin(), std::size_t{0}); }
  std::size_t total() const { return starts_.back(); }

 private:
  std::vector<std::size_t> starts_;
};

// Queries the image if the label is unknown. Dead cells are background.
LabelIndex label_of(Mesh& mesh, const Isosurface& isosurface, CellId c) {
  LabelIndex& label = mesh.label(c);
  if (label == kUnknownLabel)
    label = mesh.cell(c).is_alive() ? isosurface.label_at(mesh.cell(c).center) : kBackground;
  return label;
}

// A facet of the output, with vertices by their ids in the store.
struct BoundaryFacet {
  std::array<VertexId, 3> vertices;
  std::array<LabelIndex, 2> labels;
};

// A first pass over the cells labels and counts them. A second pass writes the cells with vertices by their
// ids in the store, finds the facets and the vertices in use, and frees the memory of the store that it has
// passed. Then the vertices are numbered in the order of their ids, and the cells and facets get these
// numbers.
class Extractor {
 public:
  Extractor(Mesh& mesh, const Isosurface& isosurface, std::size_t threads, const CellFilter& is_wanted,
            TetMesh& out)
      : mesh_(mesh),
        is_wanted_(is_wanted),
        isosurface_(isosurface),
        to_world_(working_to_world(isosurface.image())),
        threads_(threads),
        out_(out),
        labels_(mesh.cell_bound()),
        out_ids_(mesh.vertex_bound(), kNoVertex),
        facets_(num_chunks(mesh.cell_bound())) {}

  std::uint64_t operator()() {
    Starts cells(mesh_.cell_bound());
    for_each_chunk(0, mesh_.cell_bound(), threads_, [&](std::size_t chunk, CellId begin, CellId end) {
      cells[chunk] = label_cells(begin, end);
    });
    cells.sum_up();
    out_.cells.reserve(cells.total());
    out_.cell_labels.reserve(cells.total());
    for_each_slice(mesh_.cell_bound(), [&](CellId first, CellId last) {
      parallel_resize(out_.cells, cells.before(last), threads_);
      parallel_resize(out_.cell_labels, cells.before(last), threads_);
      for_each_chunk(first, last, threads_, [&](std::size_t chunk, CellId begin, CellId end) {
        write_cells(begin, end, cells[chunk], facets_[chunk]);
      });
      mesh_.release_cells(first, last);
    });
    write_vertices();
    number_vertices_of_cells();
    for (auto& edge : out_.lines.edges)
      for (std::uint32_t& v : edge) v = out_id(v);
    return write_facets();
  }

 private:
  // The marks are in out_ids_, which facets read anyway. Reading the vertices themselves would double the
  // time.
  static constexpr std::uint32_t kUsed = 0, kOffIsosurface = 1u << 31;

  std::uint32_t out_id(VertexId v) const { return out_ids_[v] & ~kOffIsosurface; }
  bool is_off_isosurface(VertexId v) const { return (out_ids_[v] & kOffIsosurface) != 0; }

  // Labels the cells and returns the number of those in the mesh.
  std::size_t label_cells(CellId begin, CellId end) {
    std::size_t count = 0;
    for (CellId c = begin; c < end; ++c) {
      labels_[c] = label_of(mesh_, isosurface_, c);
      count += is_wanted(c);
    }
    return count;
  }

  bool is_wanted(CellId c) const { return labels_[c] != kBackground && (!is_wanted_ || is_wanted_(c)); }

  // Prefetches what a cell needs besides its own cache line.
  static constexpr CellId kLookahead = 32;
  void prefetch_around(CellId c) const {
    if (c >= mesh_.cell_bound() || labels_[c] == kBackground) return;
    for (const FacetId mirror : mesh_.cell(c).mirrors) {
      if (mirror != kNoFacet) __builtin_prefetch(&labels_[cell_of(mirror)]);
    }
    for (const VertexId v : mesh_.cell(c).vertices) __builtin_prefetch(&out_ids_[v]);
  }

  void write_cells(CellId begin, CellId end, std::size_t at, std::vector<BoundaryFacet>& facets) {
    for (CellId c = begin; c < end; ++c) {
      prefetch_around(c + kLookahead);
      if (!is_wanted(c)) continue;
      const LabelIndex label = labels_[c];
      const Cell& cell = mesh_.cell(c);
      for (const VertexId v : cell.vertices) {
        if (load(out_ids_[v], std::memory_order_relaxed) != kUsed)
          store(out_ids_[v], kUsed, std::memory_order_relaxed);
      }
      for (unsigned k = 0; k < 4; ++k) {
        const LabelIndex across =
            cell.mirrors[k] == kNoFacet ? kBackground : labels_[cell_of(cell.mirrors[k])];
        if (across < label)
          add_facet(cell, k, {across, label}, facets);  // once, from the side of the larger label
      }
      out_.cells[at] = cell.vertices;
      if (is_mirrored_) std::swap(out_.cells[at][2], out_.cells[at][3]);
      out_.cell_labels[at++] = label;
    }
  }

  void add_facet(const Cell& cell, unsigned k, const std::array<LabelIndex, 2>& labels,
                 std::vector<BoundaryFacet>& facets) {
    // kFacetVertices are oriented towards the cell. The output is oriented outwards.
    const auto vertex = [&](std::size_t i) {
      return cell.vertices[static_cast<unsigned>(kFacetVertices[k][2 - i])];
    };
    std::array<VertexId, 3> vertices{vertex(0), vertex(1), vertex(2)};
    if (is_mirrored_) std::swap(vertices[1], vertices[2]);
    facets.push_back({vertices, labels});
  }

  void write_vertices() {
    Starts vertices(mesh_.vertex_bound());
    for_each_chunk(0, mesh_.vertex_bound(), threads_, [&](std::size_t chunk, VertexId begin, VertexId end) {
      for (VertexId v = begin; v < end; ++v) vertices[chunk] += out_ids_[v] == kUsed;
    });
    vertices.sum_up();
    out_.vertices.reserve(vertices.total());
    for_each_slice(mesh_.vertex_bound(), [&](VertexId first, VertexId last) {
      parallel_resize(out_.vertices, vertices.before(last), threads_);
      if (out_.is_box_flat) parallel_resize(out_.vertex_sides, vertices.before(last), threads_);
      for_each_chunk(first, last, threads_, [&](std::size_t chunk, VertexId begin, VertexId end) {
        write_vertices(begin, end, vertices[chunk]);
      });
      mesh_.release_vertices(first, last);
    });
  }

  void write_vertices(VertexId begin, VertexId end, std::size_t at) {
    for (VertexId v = begin; v < end; ++v) {
      if (out_ids_[v] != kUsed) continue;
      out_ids_[v] = static_cast<std::uint32_t>(at);
      if (!is_on_isosurface(mesh_.vertex(v).kind)) out_ids_[v] |= kOffIsosurface;
      if (out_.is_box_flat) out_.vertex_sides[at] = mesh_.vertex(v).sides;
      const Point p =
          is_turned_ ? turned(isosurface_.image(), mesh_.point(v)) : map(to_world_, mesh_.point(v));
      out_.vertices[at++] = {flip_ * p.x, flip_ * p.y, p.z};
    }
  }

  void number_vertices_of_cells() {
    parallel_for_ranges(out_.cells.size(), kChunk, threads_,
                        [&](std::size_t begin, std::size_t end, std::size_t) {
                          for (std::size_t c = begin; c < end; ++c) {
                            for (const VertexId v : out_.cells[std::min(c + kLookahead, end - 1)])
                              __builtin_prefetch(&out_ids_[v]);
                            for (std::uint32_t& v : out_.cells[c]) v = out_id(v);
                          }
                        });
  }

  // Returns the number of facets with a vertex off the isosurface.
  std::uint64_t write_facets() {
    std::vector<std::size_t> begin(facets_.size() + 1);
    for (std::size_t chunk = 0; chunk < facets_.size(); ++chunk)
      begin[chunk + 1] = begin[chunk] + facets_[chunk].size();
    parallel_resize(out_.facets, begin.back(), threads_);
    parallel_resize(out_.facet_labels, begin.back(), threads_);
    std::atomic<std::uint64_t> off_isosurface = 0;
    parallel_for(facets_.size(), threads_, [&](std::size_t chunk, std::size_t) {
      std::size_t at = begin[chunk];
      std::uint64_t count = 0;
      for (const auto& [vertices, labels] : facets_[chunk]) {
        out_.facets[at] = {out_id(vertices[0]), out_id(vertices[1]), out_id(vertices[2])};
        out_.facet_labels[at++] = labels;
        count +=
            std::any_of(vertices.begin(), vertices.end(), [&](VertexId v) { return is_off_isosurface(v); });
      }
      off_isosurface += count;
    });
    return off_isosurface;
  }

  Mesh& mesh_;
  const CellFilter& is_wanted_;
  const Isosurface& isosurface_;
  const Affine to_world_;
  const bool is_turned_ = is_turned_for_output(isosurface_.image());
  const bool is_mirrored_ =
      determinant(to_world_) < 0;  // a swap of two vertices of each cell restores its orientation
  std::size_t threads_;
  TetMesh& out_;
  const double flip_ = out_.space == Space::kLps ? -1 : 1;
  HugeArray<LabelIndex> labels_;  // of the store's cells; they outlive the cells and are denser in memory
  std::vector<std::uint32_t> out_ids_;  // by id in the store: unused or used, then the position in the output
  std::vector<std::vector<BoundaryFacet>> facets_;  // by chunk of cells
};

}  // namespace

std::uint64_t label_cells(Mesh& mesh, const Isosurface& isosurface, int threads) {
  std::atomic<std::uint64_t> labelled = 0;
  for_each_chunk(0, mesh.cell_bound(), num_threads(threads), [&](std::size_t, CellId begin, CellId end) {
    std::uint64_t count = 0;
    for (CellId c = begin; c < end; ++c) count += label_of(mesh, isosurface, c) != kBackground;
    labelled += count;
  });
  return labelled;
}

TetMesh extract_mesh(Mesh& mesh, const Isosurface& isosurface, Space space, int threads,
                     std::uint64_t& facets_off_isosurface, const CellFilter& is_wanted, MeshLines lines) {
  TetMesh out;
  out.lines = std::move(lines);
  out.labels = isosurface.image().labels;
  out.space = space;
  out.is_box_flat = isosurface.image().is_box_flat;
  facets_off_isosurface = Extractor(mesh, isosurface, num_threads(threads), is_wanted, out)();
  if (is_turned_for_output(isosurface.image()))
    out.num_mended_by_turning = mend_turned_cells(out, isosurface.image(), threads);
  return out;
}

void convert_to_voxel_space(TetMesh& mesh, const LabelImage& image, int threads) {
  const auto for_each = [&](auto& items, const auto& change) {
    parallel_for_ranges(items.size(), kChunk, num_threads(threads),
                        [&](std::size_t begin, std::size_t end, std::size_t) {
                          for (std::size_t i = begin; i < end; ++i) change(items[i]);
                        });
  };
  const Affine ras_to_voxel = inverse(image.voxel_to_ras);
  for_each(mesh.vertices, [&](auto& vertex) { vertex = map(ras_to_voxel, vertex); });
  if (determinant(image.voxel_to_ras) < 0) {
    for_each(mesh.cells, [](auto& cell) { std::swap(cell[2], cell[3]); });
    for_each(mesh.facets, [](auto& facet) { std::swap(facet[1], facet[2]); });
  }
  for (std::size_t v = 0; v < mesh.vertex_sides.size(); ++v)
    for (std::size_t side = 0; side < kNumSides; ++side)
      if ((mesh.vertex_sides[v] >> side & 1) != 0)
        mesh.vertices[v][side / 2] = side % 2 == 0 ? -0.5 : image.size[side / 2] - 0.5;
  mesh.space = Space::kVoxel;
}

}  // namespace podm
