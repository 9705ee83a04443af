#include "extract_mesh.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <utility>
#include <vector>

#include "image/working_frame.h"
#include "runtime/parallel_for.h"
#include "runtime/parallel_resize.h"

namespace podm {

namespace {

// Threads share out chunks of ids.
constexpr std::size_t kChunk = 1 << 13;

std::size_t num_chunks(std::uint32_t num_ids) { return (num_ids + kChunk - 1) / kChunk; }

/// Calls work(chunk, begin, end) for every chunk of the ids from `first`, where one begins, to `last`.
template <class Work>
void for_each_chunk(std::uint32_t first, std::uint32_t last, std::size_t threads, const Work& work) {
  parallel_for_ranges(last - first, kChunk, threads, [&](std::size_t begin, std::size_t end, std::size_t) {
    work((first + begin) / kChunk, first + static_cast<std::uint32_t>(begin),
         first + static_cast<std::uint32_t>(end));
  });
}

/// Calls work(begin, end) for some sixteen slices of the ids below `num_ids`, chunks each, one after another.
template <class Work>
void for_each_slice(std::uint32_t num_ids, const Work& work) {
  const auto length = static_cast<std::uint32_t>(kChunk * std::max<std::size_t>(1, num_chunks(num_ids) / 16));
  for (std::uint32_t begin = 0; begin < num_ids; begin += std::min(length, num_ids - begin))
    work(begin, begin + std::min(length, num_ids - begin));
}

// How many a chunk adds to the output; summed up, where in the output they begin.
struct Share {
  std::size_t vertices = 0, cells = 0, facets = 0;
  Share operator+(const Share& b) const {
    return {vertices + b.vertices, cells + b.cells, facets + b.facets};
  }
};

// One share a chunk, and the total.
class Shares {
 public:
  explicit Shares(std::uint32_t num_ids) : shares_(num_chunks(num_ids) + 1) {}
  Share& operator[](std::size_t chunk) { return shares_[chunk]; }
  /// The share of all chunks before the id, where one ends.
  const Share& before(std::uint32_t id) const { return shares_[num_chunks(id)]; }
  void sum_up() { std::exclusive_scan(shares_.begin(), shares_.end(), shares_.begin(), Share{}); }
  const Share& total() const { return shares_.back(); }

 private:
  std::vector<Share> shares_;
};

// The labels of the mesh are known. Each thread counts what its chunks add, then knows where to write.
class Extractor {
 public:
  Extractor(Mesh& mesh, const Affine& to_world, std::size_t threads, TetMesh& out)
      : mesh_(mesh),
        to_world_(to_world),
        threads_(threads),
        out_(out),
        out_ids_(mesh.vertex_bound(), kNoVertex) {}

  std::uint64_t operator()() {
    Shares shares(mesh_.cell_bound());
    for_each_chunk(0, mesh_.cell_bound(), threads_, [&](std::size_t chunk, CellId begin, CellId end) {
      shares[chunk] = count_cells(begin, end);
    });
    shares.sum_up();
    write_vertices();
    reserve(shares.total());
    std::atomic<std::uint64_t> facets_off_isosurface = 0;
    for_each_slice(mesh_.cell_bound(), [&](CellId first, CellId last) {
      resize(shares.before(last));
      for_each_chunk(first, last, threads_, [&](std::size_t chunk, CellId begin, CellId end) {
        facets_off_isosurface += write_cells(begin, end, shares[chunk]);
      });
      mesh_.release_cells(first, last);
    });
    return facets_off_isosurface;
  }

 private:
  // The marks stand in out_ids_, which a facet reads anyway: looking at the vertices themselves would double
  // the time.
  static constexpr std::uint32_t kUsed = 0, kOffIsosurface = 1u << 31;

  std::uint32_t out_id(VertexId v) const { return out_ids_[v] & ~kOffIsosurface; }
  bool is_off_isosurface(VertexId v) const { return (out_ids_[v] & kOffIsosurface) != 0; }

  // What a cell needs besides its own line, early.
  static constexpr CellId kLookahead = 32;
  void prefetch_around(CellId c) const {
    if (c >= mesh_.cell_bound() || mesh_.label(c) == kBackground) return;
    for (const FacetId mirror : mesh_.cell(c).mirrors) {
      if (mirror != kNoFacet) mesh_.prefetch_label(cell_of(mirror));
    }
    for (const VertexId v : mesh_.cell(c).vertices) __builtin_prefetch(&out_ids_[v]);
  }

  LabelIndex label_across(CellId c, unsigned k) const {
    const FacetId mirror = mesh_.cell(c).mirrors[k];
    return mirror == kNoFacet ? kBackground : mesh_.label(cell_of(mirror));
  }
  // The cell of the larger label writes the facet.
  bool is_written_here(CellId c, unsigned k) const { return label_across(c, k) < mesh_.label(c); }

  // Addresses; memory comes with resize().
  void reserve(const Share& total) {
    out_.cells.reserve(total.cells);
    out_.cell_labels.reserve(total.cells);
    out_.facets.reserve(total.facets);
    out_.facet_labels.reserve(total.facets);
  }
  void resize(const Share& share) {
    parallel_resize(out_.cells, share.cells, threads_);
    parallel_resize(out_.cell_labels, share.cells, threads_);
    parallel_resize(out_.facets, share.facets, threads_);
    parallel_resize(out_.facet_labels, share.facets, threads_);
  }

  // Marks their vertices as used.
  Share count_cells(CellId begin, CellId end) {
    Share share;
    for (CellId c = begin; c < end; ++c) {
      prefetch_around(c + kLookahead);
      if (mesh_.label(c) == kBackground) continue;
      ++share.cells;
      for (unsigned k = 0; k < 4; ++k) share.facets += is_written_here(c, k);
      for (const VertexId v : mesh_.cell(c).vertices) {
        if (load(out_ids_[v], std::memory_order_relaxed) != kUsed)
          store(out_ids_[v], kUsed, std::memory_order_relaxed);
      }
    }
    return share;
  }

  void write_vertices() {
    Shares shares(mesh_.vertex_bound());
    for_each_chunk(0, mesh_.vertex_bound(), threads_, [&](std::size_t chunk, VertexId begin, VertexId end) {
      for (VertexId v = begin; v < end; ++v) shares[chunk].vertices += out_ids_[v] == kUsed;
    });
    shares.sum_up();
    out_.vertices.reserve(shares.total().vertices);
    for_each_slice(mesh_.vertex_bound(), [&](VertexId first, VertexId last) {
      parallel_resize(out_.vertices, shares.before(last).vertices, threads_);
      for_each_chunk(first, last, threads_, [&](std::size_t chunk, VertexId begin, VertexId end) {
        write_vertices(begin, end, shares[chunk].vertices);
      });
      mesh_.release_vertices(first, last);
    });
  }

  void write_vertices(VertexId begin, VertexId end, std::size_t at) {
    for (VertexId v = begin; v < end; ++v) {
      if (out_ids_[v] != kUsed) continue;
      out_ids_[v] = static_cast<std::uint32_t>(at);
      if (mesh_.vertex(v).kind != VertexKind::kIsosurface) out_ids_[v] |= kOffIsosurface;
      const Point p = map(to_world_, mesh_.point(v));
      out_.vertices[at++] = {flip_ * p.x, flip_ * p.y, p.z};
    }
  }

  // Returns how many facets have a vertex off the isosurface.
  std::uint64_t write_cells(CellId begin, CellId end, Share at) {
    std::uint64_t facets_off_isosurface = 0;
    for (CellId c = begin; c < end; ++c) {
      prefetch_around(c + kLookahead);
      const LabelIndex label = mesh_.label(c);
      if (label == kBackground) continue;
      auto& cell = out_.cells[at.cells];
      for (unsigned i = 0; i < 4; ++i) cell[i] = out_id(mesh_.cell(c).vertices[i]);
      if (is_mirrored_) std::swap(cell[2], cell[3]);
      out_.cell_labels[at.cells++] = label;
      for (unsigned k = 0; k < 4; ++k) {
        if (is_written_here(c, k)) facets_off_isosurface += write_facet(c, k, at.facets++);
      }
    }
    return facets_off_isosurface;
  }

  // Returns whether a vertex is off the isosurface.
  bool write_facet(CellId c, unsigned k, std::size_t at) {
    bool is_off = false;
    auto& facet = out_.facets[at];
    for (unsigned i = 0; i < 3; ++i) {
      // kFacetVertices turns towards the cell; outwards is the other way round.
      const VertexId v = mesh_.cell(c).vertices[static_cast<unsigned>(kFacetVertices[k][2 - i])];
      facet[i] = out_id(v);
      is_off = is_off || is_off_isosurface(v);
    }
    if (is_mirrored_) std::swap(facet[1], facet[2]);
    out_.facet_labels[at] = {label_across(c, k), mesh_.label(c)};
    return is_off;
  }

  Mesh& mesh_;
  const Affine to_world_;
  const bool is_mirrored_ = determinant(to_world_) < 0;  // swapping two vertices of a cell turns it back
  std::size_t threads_;
  TetMesh& out_;
  const double flip_ = out_.space == Space::kLps ? -1 : 1;
  std::vector<std::uint32_t> out_ids_;  // by id in the store: used or not, then the position in the output
};

}  // namespace

std::uint64_t label_cells(Mesh& mesh, const Isosurface& isosurface, int threads) {
  std::atomic<std::uint64_t> labelled = 0;
  for_each_chunk(0, mesh.cell_bound(), num_threads(threads), [&](std::size_t, CellId begin, CellId end) {
    std::uint64_t count = 0;
    for (CellId c = begin; c < end; ++c) {
      LabelIndex& label = mesh.label(c);
      if (label == kUnknownLabel)
        label = mesh.cell(c).is_alive() ? isosurface.label_at(mesh.cell(c).sphere.center) : kBackground;
      count += label != kBackground;
    }
    labelled += count;
  });
  return labelled;
}

TetMesh extract_mesh(Mesh& mesh, const Isosurface& isosurface, Space space, int threads,
                     std::uint64_t& facets_off_isosurface) {
  TetMesh out;
  out.labels = isosurface.image().labels;
  out.space = space;
  label_cells(mesh, isosurface, threads);
  facets_off_isosurface = Extractor(mesh, working_to_world(isosurface.image()), num_threads(threads), out)();
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
  mesh.space = Space::kVoxel;
}

}  // namespace podm
