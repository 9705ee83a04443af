// Closed surfaces of labels that no rank holds as a whole. Ranks number the vertices of a surface together,
// in the order of their numbers in the whole mesh, and write their parts of its file at once.
#include <algorithm>
#include <deque>
#include <numeric>
#include <optional>

#include "distributed/collective_errors.h"
#include "distributed/messages.h"
#include "distributed/write_pieces.h"
#include "files/temporary_file.h"
#include "io/surface_format.h"
#include "io/vertex_subset.h"

namespace podm {
namespace {

using Facets = std::vector<std::array<std::uint32_t, 3>>;

// A vertex as ranks send it.
struct SentVertex {
  std::uint64_t id;
  std::array<double, 3> point;
};

// The number of items of the ranks before this one, and of all ranks.
struct Share {
  std::uint64_t before, all;
};

// The part of one label's surface that this rank writes.
struct SurfacePart {
  std::string vertices, facets;  // bytes
  Share share_of_vertices, share_of_facets;
};

class SurfaceOfLabel {
 public:
  SurfaceOfLabel(const MeshPiece& piece, SurfaceFormat format, VertexSubset& subset, Communication& ranks)
      : piece_(piece), format_(format), subset_(subset), ranks_(ranks) {}

  // Collective. `facets` are those of this rank.
  SurfacePart part_of(const Facets& facets) {
    SurfacePart part;
    part.share_of_facets = share_of(facets.size());
    subset_.assign(facets);
    const std::vector<std::uint64_t> positions = number_vertices(part);
    for (const auto& facet : facets) {
      std::array<std::array<double, 3>, 3> points;
      std::array<std::uint32_t, 3> in_file{};
      for (std::size_t i = 0; i < 3; ++i) {
        points[i] = piece_.mesh.vertices[facet[i]];
        in_file[i] = static_cast<std::uint32_t>(positions[subset_.position(facet[i])]);
      }
      append_facet(format_, points, in_file, part.facets);
    }
    return part;
  }

 private:
  Share share_of(std::uint64_t count) const {
    std::vector<std::uint64_t> counts(static_cast<std::size_t>(ranks_.size()));
    counts[static_cast<std::size_t>(ranks_.rank())] = count;
    ranks_.sum(counts);
    const auto own = counts.begin() + ranks_.rank();
    return {std::accumulate(counts.begin(), own, std::uint64_t{0}),
            std::accumulate(counts.begin(), counts.end(), std::uint64_t{0})};
  }

  // Each rank numbers and writes the vertices whose numbers lie in its range.
  std::size_t rank_of(std::uint64_t id) const {
    const auto ranks = static_cast<std::uint64_t>(ranks_.size());
    return static_cast<std::size_t>(id / ((piece_.total_vertices + ranks - 1) / ranks));
  }

  // Returns the positions in the file of the subset's vertices.
  std::vector<std::uint64_t> number_vertices(SurfacePart& part) {
    std::vector<std::vector<SentVertex>> used(static_cast<std::size_t>(ranks_.size()));
    for (const std::uint32_t v : subset_.vertices())
      used[rank_of(piece_.vertex_ids[v])].push_back({piece_.vertex_ids[v], piece_.mesh.vertices[v]});
    std::vector<std::vector<std::uint64_t>> asked;
    std::vector<SentVertex> vertices;
    for (const Bytes& received : ranks_.all_to_all(messages_of(used))) {
      std::vector<std::uint64_t>& ids = asked.emplace_back();
      for (const SentVertex& vertex : values_of<SentVertex>(received)) {
        ids.push_back(vertex.id);
        vertices.push_back(vertex);
      }
    }
    std::sort(vertices.begin(), vertices.end(), is_before);
    vertices.erase(std::unique(vertices.begin(), vertices.end(), is_same), vertices.end());
    part.share_of_vertices = share_of(vertices.size());
    for (const SentVertex& vertex : vertices) append_vertex(format_, vertex.point, part.vertices);
    for (std::vector<std::uint64_t>& ids : asked)
      for (std::uint64_t& id : ids) {
        const auto at = std::lower_bound(vertices.begin(), vertices.end(), SentVertex{id, {}}, is_before);
        id = part.share_of_vertices.before + static_cast<std::uint64_t>(at - vertices.begin());
      }
    return in_order_of_subset(ranks_.all_to_all(messages_of(asked)));
  }

  std::vector<std::uint64_t> in_order_of_subset(const std::vector<Bytes>& answers) const {
    std::vector<std::vector<std::uint64_t>> by_rank;
    for (const Bytes& answer : answers) by_rank.push_back(values_of<std::uint64_t>(answer));
    std::vector<std::size_t> next(by_rank.size());
    std::vector<std::uint64_t> positions;
    for (const std::uint32_t v : subset_.vertices()) {
      const std::size_t rank = rank_of(piece_.vertex_ids[v]);
      positions.push_back(by_rank[rank].at(next[rank]++));
    }
    return positions;
  }

  static bool is_before(const SentVertex& a, const SentVertex& b) { return a.id < b.id; }
  static bool is_same(const SentVertex& a, const SentVertex& b) { return a.id == b.id; }

  const MeshPiece& piece_;
  const SurfaceFormat format_;
  VertexSubset& subset_;
  Communication& ranks_;
};

// The first rank makes the files, and publishes them together.
class SurfaceFiles {
 public:
  SurfaceFiles(SurfaceFormat format, Space space, Communication& ranks)
      : format_(format), space_(space), ranks_(ranks) {}

  // Collective.
  void write(const std::string& path, const Label& label, const SurfacePart& part) {
    const SurfaceSize size{part.share_of_vertices.all, part.share_of_facets.all};
    const std::string head = surface_head(format_, space_, label, size);
    const auto make = [&] {
      check_surface_size(format_, path, size);
      if (ranks_.rank() != 0) return;
      files_.emplace_back(path);
      files_.back().write(head.data(), head.size());
    };
    do_collectively(make, ranks_);
    const std::string file =
        text_of_first_rank(ranks_.rank() == 0 ? files_.back().temporary_path() : "", ranks_);
    const std::uint64_t vertices_at = head.size() + part.share_of_vertices.before * bytes_per_vertex(format_);
    const std::uint64_t facets_at = head.size() + size.vertices * bytes_per_vertex(format_) +
                                    part.share_of_facets.before * bytes_per_facet(format_);
    const auto write_own = [&] {
      SharedFile own(file, path);
      own.write(vertices_at, part.vertices);
      own.write(facets_at, part.facets);
      own.finish();
    };
    do_collectively(write_own, ranks_);
  }

  // Collective.
  void publish() {
    const auto name = [&] {
      std::vector<TemporaryFile*> files;
      for (TemporaryFile& file : files_) files.push_back(&file);
      TemporaryFile::publish(files);
    };
    do_collectively(name, ranks_);
  }

 private:
  const SurfaceFormat format_;
  const Space space_;
  Communication& ranks_;
  std::deque<TemporaryFile> files_;  // of the first rank
};

}  // namespace

void write_surfaces(const MeshPiece& piece, const std::string& path, Communication& ranks) {
  const SurfaceFormat format = surface_format_of(path);
  const std::vector<Facets> facets_of_label = outward_facets(piece.mesh);
  VertexSubset subset(piece.mesh.vertices.size());
  SurfaceFiles files(format, piece.mesh.space, ranks);
  for (std::size_t label = 1; label < piece.mesh.labels.size(); ++label) {
    const SurfacePart part = SurfaceOfLabel(piece, format, subset, ranks).part_of(facets_of_label[label]);
    if (part.share_of_facets.all == 0) continue;
    files.write(surface_path(path, piece.mesh.labels[label]), piece.mesh.labels[label], part);
  }
  files.publish();
}

}  // namespace podm
