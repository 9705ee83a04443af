// A rank first numbers the points of its pieces one after the other, then by their GlobalNodeIds. It gives
// the directory these points, learns from it the ranks that share them, and sends these ranks the cells that
// have a shared point. Nothing of the whole mesh is on one rank except the names of its pieces.
#include "readers/read_pvtu_part.h"

#include <fmt/format.h>

#include <filesystem>
#include <new>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "errors.h"
#include "readers/mesh_parts.h"
#include "readers/point_directory.h"
#include "readers/pvtu_pieces.h"
#include "readers/vtu_document.h"
#include "readers/vtu_grid.h"

namespace podm::verify {
namespace {

// Calls action() like do_on_all(). A file whose counts exceed the memory is at fault.
template <class Action>
void read_on_all(Communication& ranks, const std::string& path, const Action& action) {
  do_on_all(ranks, [&] {
    const auto refuse_size = [&] { throw InputError(path + ": needs more memory than the machine has"); };
    try {
      action();
    } catch (const std::bad_alloc&) {
      refuse_size();
    } catch (const std::length_error&) {
      refuse_size();
    }
  });
}

// The pieces of an index that one rank reads.
class OwnPieces {
 public:
  OwnPieces(const std::string& path, Communication& ranks) : path_(path), ranks_(ranks) {}

  // Collective.
  void read() {
    read_on_all(ranks_, path_, [&] {
      index_.emplace(path_);
      sources_ = parse_pvtu(*index_);
      const auto size = static_cast<std::size_t>(ranks_.size()),
                 rank = static_cast<std::size_t>(ranks_.rank());
      const auto first_of = [&](std::size_t r) { return (sources_.size() * r + size - 1) / size; };
      first_ = first_of(rank);
      const auto at = [&](std::size_t piece) {
        return sources_.begin() + static_cast<std::ptrdiff_t>(piece);
      };
      for_each_piece(*index_, {at(first_), at(first_of(rank + 1))}, [&](const MeshFile& file) { add(file); });
      points_.shrink_to_fit();  // they grew piece by piece
      mesh_.cells.shrink_to_fit();
      mesh_.cell_labels.shrink_to_fit();
    });
  }

  const MeshFile& index() const { return *index_; }
  const std::vector<PieceSource>& sources() const { return sources_; }
  const std::vector<PointOfPiece>& points() const { return points_; }
  std::vector<PointOfPiece>& points() { return points_; }
  /// Its corners are positions in points(); it has no vertices.
  Mesh& mesh() { return mesh_; }
  const std::string& format_of_first() const { return format_of_first_; }

  // Throws unless this rank's pieces name the same labels and space as `first`.
  void check_head(const Mesh& first) const {
    if (ids_places_.empty()) return;
    for_each_piece(*index_, {sources_[first_]},
                   [&](const MeshFile& file) { check_labels_and_space(file, mesh_, first); });
  }

  // Throws an error about a point of one of this rank's pieces.
  [[noreturn]] void refuse_point(std::size_t position, const std::string& fault) const {
    const PieceSource& source = sources_[points_[position].piece];
    const std::size_t first = first_points_[points_[position].piece - first_];
    index_->refuse(source.place(),
                   fmt::format("{}: {}: point {}{}", source.path,
                               ids_places_[points_[position].piece - first_], position - first, fault));
  }

 private:
  void add(const MeshFile& file) {
    const VtuGrid grid = read_vtu_grid(file, kGlobalIds);
    check_counts(file, "Points", points_.size() + grid.point_ids.size(), 0);
    if (ids_places_.empty()) {
      take_head(grid.mesh, mesh_);
      format_of_first_ = grid.mesh.format;
    }
    check_labels_and_space(file, grid.mesh, mesh_);
    const auto piece = static_cast<std::uint32_t>(first_ + ids_places_.size());
    ids_places_.push_back(grid.ids_place);
    first_points_.push_back(points_.size());
    std::vector<VertexId> vertex_of(grid.point_ids.size());
    std::iota(vertex_of.begin(), vertex_of.end(), static_cast<VertexId>(points_.size()));
    for (std::size_t i = 0; i < vertex_of.size(); ++i)
      points_.push_back({grid.point_ids[i], grid.mesh.vertices[i], piece});
    append_cells(file, grid, vertex_of, mesh_);
    append_facets(file, grid, vertex_of, mesh_);
    for (const auto& [kind, count] : grid.mesh.other_cells) mesh_.other_cells[kind] += count;
  }

  std::string path_;
  Communication& ranks_;
  std::optional<MeshFile> index_;
  std::vector<PieceSource> sources_;
  std::size_t first_ = 0;  // of this rank's pieces
  std::vector<std::string> ids_places_;
  std::vector<std::size_t> first_points_;  // position of each piece's first point
  std::vector<PointOfPiece> points_;
  Mesh mesh_;
  std::string format_of_first_;
};

// The facts that the first piece states about the whole mesh.
struct Head {
  std::string format;
  Space space = Space::kUnstated;
  std::map<LabelValue, std::string> label_names;
  std::map<LabelValue, std::array<std::uint8_t, 3>> label_colours;
  std::vector<std::string> unclaimed;
  std::optional<std::array<double, 2>> promised_dihedral_deg;
  std::optional<double> smoothing_mm, promised_lines_delta_mm;
  bool promises_flat_box = false;

  Head() = default;
  Head(const Mesh& mesh, const std::string& format_of_first)
      : format(format_of_first),
        space(mesh.space),
        label_names(mesh.label_names),
        label_colours(mesh.label_colours),
        unclaimed(mesh.unclaimed.begin(), mesh.unclaimed.end()),
        promised_dihedral_deg(mesh.promised_dihedral_deg),
        smoothing_mm(mesh.smoothing_mm),
        promised_lines_delta_mm(mesh.promised_lines_delta_mm),
        promises_flat_box(mesh.promises_flat_box) {}

  Mesh mesh() const {
    Mesh mesh;
    mesh.space = space;
    mesh.label_names = label_names;
    mesh.label_colours = label_colours;
    mesh.unclaimed = {unclaimed.begin(), unclaimed.end()};
    mesh.promised_dihedral_deg = promised_dihedral_deg;
    mesh.smoothing_mm = smoothing_mm;
    mesh.promised_lines_delta_mm = promised_lines_delta_mm;
    mesh.promises_flat_box = promises_flat_box;
    return mesh;
  }
  template <class Stream>
  void transfer(Stream& stream) {
    stream(format, space, label_names, label_colours, unclaimed, promised_dihedral_deg, smoothing_mm,
           promised_lines_delta_mm, promises_flat_box);
  }
};

// A cell on its way to another rank.
struct SentCell {
  GlobalId number = 0;
  std::array<GlobalId, 4> ids{};
  std::array<Point, 4> points{};
  LabelValue label = 0;
};

// A listed facet on its way to the rank that judges it.
struct SentFacet {
  GlobalId number = 0;
  std::array<GlobalId, 3> ids{};
  std::array<LabelValue, 2> labels{};
};

template <class Item>
void release(std::vector<Item>& items) {
  std::vector<Item>().swap(items);
}

class PartReader {
 public:
  PartReader(const std::string& path, Communication& ranks)
      : path_(path), ranks_(ranks), pieces_(path, ranks), directory_(std::in_place, ranks) {}

  Mesh read() {
    pieces_.read();
    agree_on_head();
    sort_points();
    number_cells();
    enter_points();
    send_facets();
    directory_.reset();
    send_cells();
    merge_vertices();
    assemble_cells();
    assemble_facets();
    check_size();
    part_.ranks = &ranks_;
    whole_.part = std::make_shared<const Part>(std::move(part_));
    return std::move(whole_);
  }

 private:
  std::size_t rank() const { return static_cast<std::size_t>(ranks_.rank()); }

  void agree_on_head() {
    Mesh& own = pieces_.mesh();
    const Head first = gather(ranks_, Head(own, pieces_.format_of_first()))[0];
    whole_ = first.mesh();
    whole_.path = path_;
    whole_.format = format_of_pieces(pieces_.sources().size(), first.format);
    if (pieces_.index().is_gzipped()) whole_.format += ", gzip";
    do_on_all(ranks_, [&] { pieces_.check_head(whole_); });
    std::map<std::string, std::uint64_t> others;
    for (const auto& [kind, count] : own.other_cells) others[kind] = count;
    for (const auto& part : gather(ranks_, others))
      for (const auto& [kind, count] : part) whole_.other_cells[kind] += count;
    agree_on_labels(own);
  }

  // Labels are in all pieces with cells, or in none, and likewise those of facets.
  void agree_on_labels(const Mesh& own) {
    std::optional<std::string> name_before;
    for (const auto& names :
         gather(ranks_, own.cells.empty() ? std::vector<std::string>{}
                                          : std::vector<std::string>{own.cell_label_array})) {
      for (const std::string& name : names) {
        if (name_before && *name_before != name)
          refuse_by_all("CellData", fmt::format("cell labels in array '{}', in the pieces before in '{}'",
                                                name, *name_before));
        name_before = name;
      }
    }
    whole_.cell_label_array = name_before.value_or("");
    part_.has_cell_labels = sum_over(ranks_, own.cell_labels.size()) > 0;
  }

  [[noreturn]] void refuse_by_all(const std::string& place, const std::string& fault) const {
    throw RefusedByAll(fmt::format("{}: {}: {}", path_, place, fault));
  }

  // Sorts the points by id, and has the corners name their places in this order.
  void sort_points() {
    const GlobalId num_points = sum_over(ranks_, pieces_.points().size());
    std::vector<PointOfPiece>& points = pieces_.points();
    std::vector<VertexId> order(points.size()), place(points.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](VertexId a, VertexId b) { return points[a].id < points[b].id; });
    do_on_all(ranks_, [&] { check_points(order, num_points); });
    std::vector<PointOfPiece> sorted;
    sorted.reserve(points.size());
    for (const VertexId p : order) {
      if (sorted.empty() || sorted.back().id != points[p].id) sorted.push_back(points[p]);
      place[p] = static_cast<VertexId>(sorted.size() - 1);
    }
    points = std::move(sorted);
    const auto rename = [&](auto& simplices) {
      for (auto& corners : simplices)
        for (VertexId& v : corners) v = v == kNone ? kNone : place[v];
    };
    rename(pieces_.mesh().cells);
    rename(pieces_.mesh().facets);
  }

  // `order` is that of the ids; points of one id have the order of their pieces.
  void check_points(const std::vector<VertexId>& order, GlobalId num_points) const {
    const std::vector<PointOfPiece>& points = pieces_.points();
    for (std::size_t p = 0; p < points.size(); ++p)
      if (points[p].id >= num_points)
        pieces_.refuse_point(
            p, fmt::format(": its number is not below {}, of points in all pieces: numbers from 0 "
                           "are left out",
                           num_points));
    for (std::size_t i = 1; i < order.size(); ++i) {
      const PointOfPiece &before = points[order[i - 1]], &point = points[order[i]];
      if (before.id != point.id) continue;
      if (before.piece == point.piece)
        pieces_.refuse_point(order[i], fmt::format(": vertex {} is twice in this piece", point.id));
      if (!is_same_point(before.point, point.point))
        pieces_.refuse_point(order[i], difference(before, point));
    }
  }

  std::string difference(const PointOfPiece& before, const PointOfPiece& point) const {
    return fmt::format(": vertex {} is at {}, in {} at {}", point.id, text_of(point.point),
                       pieces_.sources()[before.piece].path, text_of(before.point));
  }

  void enter_points() {
    const std::vector<Holder> holders = directory_->enter(pieces_.points());
    do_on_all(ranks_, [&] {
      if (directory_->differences().empty()) return;
      const auto& [first, other] = directory_->differences()[0];
      throw InputError(
          fmt::format("{}: {}", pieces_.sources()[other.piece].path, difference(first, other).substr(2)));
    });
    part_.num_vertices = directory_->num_ids();
    const GlobalId gap = directory_->first_gap();
    if (gap < part_.num_vertices)
      refuse_by_all(kGlobalIds, fmt::format("no piece has vertex {}, and they have {} vertices", gap,
                                            part_.num_vertices));
    holders_ = holders;
    owners_.assign(pieces_.points().size(), static_cast<std::uint32_t>(rank()));
    std::size_t v = 0;
    for (const Holder& holder : holders_) {
      while (pieces_.points()[v].id != holder.id) ++v;
      owners_[v] = std::min(owners_[v], holder.rank);
    }
  }

  void number_cells() {
    part_.first_cells = {0};
    for (const std::uint64_t count : gather(ranks_, std::uint64_t{pieces_.mesh().cells.size()}))
      part_.first_cells.push_back(part_.first_cells.back() + count);
  }

  // Sends each listed facet to the rank that owns its least vertex.
  void send_facets() {
    OwnPieces* lists_facets = &pieces_;
    std::vector<std::uint32_t> owners = owners_;
    std::optional<OwnPieces> beside;
    const std::string path = path_of_facets();
    std::error_code ignored;
    const bool is_beside = gather(ranks_, std::uint8_t{std::filesystem::exists(path, ignored)})[0] != 0;
    if (sum_over(ranks_, pieces_.mesh().facets.size()) == 0 && is_beside) {
      lists_facets = &beside.emplace(path, ranks_);
      beside->read();
      do_on_all(ranks_, [&] { beside->check_head(whole_); });
      owners = directory_->find_owners(beside->points());
      do_on_all(ranks_, [&] {
        for (std::size_t p = 0; p < owners.size(); ++p)
          if (owners[p] == kNoRank)
            beside->refuse_point(
                p, fmt::format(" is not at a vertex of {}: the files do not belong together", path_));
      });
    }
    send_facets_of(lists_facets->mesh(), lists_facets->points(), owners);
  }

  void send_facets_of(const Mesh& mesh, const std::vector<PointOfPiece>& points,
                      const std::vector<std::uint32_t>& owners) {
    const bool has_labels = !mesh.facet_labels.empty();
    const auto counts =
        gather(ranks_, std::array<std::uint64_t, 2>{mesh.facets.size(), mesh.facet_labels.size()});
    GlobalId number = 0;
    for (std::size_t r = 0; r < counts.size(); ++r) {
      if (r < rank()) number += counts[r][0];
      part_.num_facets += counts[r][0];
      part_.has_facet_labels = part_.has_facet_labels || counts[r][1] > 0;
    }
    for (const auto& [facets, labels] : counts)
      if (facets > 0 && (labels > 0) != part_.has_facet_labels)
        refuse_by_all("CellData", "label_a and label_b are missing in a piece that has triangles");
    auto lists = lists_for<SentFacet>(ranks_);
    auto points_for = lists_for<PointOfPiece>(ranks_);
    lists[rank()].reserve(mesh.facets.size());
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
      SentFacet facet{number + f, {}, {}};
      if (has_labels) facet.labels = mesh.facet_labels[f];
      for (std::size_t i = 0; i < 3; ++i) facet.ids[i] = id_of(mesh.facets[f][i], points);
      const auto least = std::min_element(facet.ids.begin(), facet.ids.end()) - facet.ids.begin();
      const VertexId first = mesh.facets[f][static_cast<std::size_t>(least)];
      const std::size_t to = first == kNone ? rank() : owners[first];
      lists[to].push_back(facet);
      for (const VertexId v : mesh.facets[f])
        if (v != kNone && (to != rank() || !holds(points[v].id))) points_for[to].push_back(points[v]);
    }
    facets_ = exchange_joined(ranks_, std::move(lists));
    points_of_facets_ = exchange_joined(ranks_, std::move(points_for));
  }

  static GlobalId id_of(VertexId position, const std::vector<PointOfPiece>& points) {
    return position == kNone ? kNoId : points[position].id;
  }
  bool holds(GlobalId id) const {
    return std::binary_search(pieces_.points().begin(), pieces_.points().end(), PointOfPiece{id, {}, 0},
                              is_before);
  }
  static bool is_before(const PointOfPiece& a, const PointOfPiece& b) { return a.id < b.id; }

  std::string path_of_facets() const {
    const std::string gzip = path_.ends_with(".gz") ? ".gz" : "";
    const std::string plain = path_.substr(0, path_.size() - gzip.size());
    const std::size_t dot = plain.size() - std::filesystem::path(plain).extension().string().size();
    const std::string stem = plain.substr(0, dot) + "_facets" + plain.substr(dot);
    std::error_code ignored;
    const std::string other = gzip.empty() ? ".gz" : "";
    return std::filesystem::exists(stem + gzip, ignored) ? stem + gzip : stem + other;
  }

  // Sends each cell to all other ranks that hold one of its vertices.
  void send_cells() {
    auto lists = lists_for<SentCell>(ranks_);
    const Mesh& own = pieces_.mesh();
    const std::vector<PointOfPiece>& points = pieces_.points();
    std::vector<std::uint8_t> is_shared(points.size(), 0);
    std::size_t v = 0;
    for (const Holder& holder : holders_) {
      while (points[v].id != holder.id) ++v;
      is_shared[v] = 1;
    }
    std::vector<std::uint32_t> to;
    for (std::size_t c = 0; c < own.cells.size(); ++c) {
      to.clear();
      for (const VertexId corner : own.cells[c]) {
        if (corner == kNone || !is_shared[corner]) continue;
        const auto [begin, end] =
            std::equal_range(holders_.begin(), holders_.end(), Holder{points[corner].id, 0});
        for (auto holder = begin; holder != end; ++holder) to.push_back(holder->rank);
      }
      std::sort(to.begin(), to.end());
      to.erase(std::unique(to.begin(), to.end()), to.end());
      if (to.empty()) continue;
      SentCell cell{part_.first_cells[rank()] + c, {}, {}, own.cell_labels.empty() ? 0 : own.cell_labels[c]};
      for (std::size_t i = 0; i < 4; ++i) {
        cell.ids[i] = id_of(own.cells[c][i], points);
        if (cell.ids[i] != kNoId) cell.points[i] = points[own.cells[c][i]].point;
      }
      for (const std::uint32_t r : to) lists[r].push_back(cell);
    }
    release(holders_);
    guests_ = exchange_joined(ranks_, std::move(lists));
  }

  // Adds the vertices of cells and facets of other ranks to the rank's own points.
  void merge_vertices() {
    std::vector<PointOfPiece> others = std::move(points_of_facets_);
    for (const SentCell& guest : guests_)
      for (std::size_t i = 0; i < 4; ++i)
        if (guest.ids[i] != kNoId) others.push_back({guest.ids[i], guest.points[i], 0});
    std::sort(others.begin(), others.end(), is_before);
    others.erase(std::unique(others.begin(), others.end(),
                             [](const PointOfPiece& a, const PointOfPiece& b) { return a.id == b.id; }),
                 others.end());
    std::vector<PointOfPiece>& own = pieces_.points();
    new_place_.reserve(own.size());
    part_.vertices.reserve(own.size() + others.size());
    part_.is_own_vertex.reserve(own.size() + others.size());
    whole_.vertices.reserve(own.size() + others.size());
    std::size_t v = 0;
    const auto append = [&](const PointOfPiece& point, bool is_own) {
      part_.vertices.push_back(point.id);
      part_.is_own_vertex.push_back(is_own ? 1 : 0);
      whole_.vertices.push_back(point.point);
    };
    for (const PointOfPiece& other : others) {
      for (; v < own.size() && own[v].id <= other.id; ++v) append_own(v, append);
      if (part_.vertices.empty() || part_.vertices.back() != other.id) append(other, false);  // not own
    }
    for (; v < own.size(); ++v) append_own(v, append);
    release(own);
    release(owners_);
  }

  template <class Append>
  void append_own(std::size_t v, const Append& append) {
    new_place_.push_back(static_cast<VertexId>(part_.vertices.size()));
    append(pieces_.points()[v], owners_[v] == rank());
  }

  VertexId place_of(GlobalId id) const {
    if (id == kNoId) return kNone;
    return static_cast<VertexId>(std::lower_bound(part_.vertices.begin(), part_.vertices.end(), id) -
                                 part_.vertices.begin());
  }

  // Other ranks' cells come before and after the rank's own, as in the whole mesh.
  void assemble_cells() {
    Mesh& own = pieces_.mesh();
    const auto first_after = std::find_if(guests_.begin(), guests_.end(), [&](const SentCell& guest) {
      return guest.number >= part_.first_cells[rank()];
    });
    const std::size_t num_cells = guests_.size() + own.cells.size();
    whole_.cells.reserve(num_cells);
    const auto add = [&](const SentCell& guest) {
      part_.other_cells.push_back(guest.number);
      whole_.cells.push_back(
          {place_of(guest.ids[0]), place_of(guest.ids[1]), place_of(guest.ids[2]), place_of(guest.ids[3])});
    };
    std::for_each(guests_.begin(), first_after, add);
    part_.own_cells = {whole_.cells.size(), whole_.cells.size() + own.cells.size()};
    for (std::array<VertexId, 4> corners : own.cells) {
      for (VertexId& v : corners) v = v == kNone ? kNone : new_place_[v];
      whole_.cells.push_back(corners);
    }
    std::for_each(first_after, guests_.end(), add);
    release(own.cells);
    release(new_place_);
    if (part_.has_cell_labels) {
      std::vector<LabelValue>& labels = whole_.cell_labels;
      labels.reserve(num_cells);
      const auto add_label = [&](const SentCell& guest) { labels.push_back(guest.label); };
      std::for_each(guests_.begin(), first_after, add_label);
      labels.insert(labels.end(), own.cell_labels.begin(), own.cell_labels.end());
      std::for_each(first_after, guests_.end(), add_label);
    }
    own = Mesh();
    release(guests_);
  }

  void assemble_facets() {
    for (const SentFacet& facet : facets_) {
      part_.facets.push_back(facet.number);
      whole_.facets.push_back({place_of(facet.ids[0]), place_of(facet.ids[1]), place_of(facet.ids[2])});
      if (part_.has_facet_labels) whole_.facet_labels.push_back(facet.labels);
    }
    release(facets_);
  }

  void check_size() const {
    do_on_all(ranks_, [&] {
      if (whole_.vertices.size() > kMostVertices || whole_.cells.size() > kMostCells)
        throw InputError(
            fmt::format("{}: a rank holds more than {} cells; use more ranks", path_, kMostCells));
    });
  }

  std::string path_;
  Communication& ranks_;
  OwnPieces pieces_;
  std::optional<PointDirectory> directory_;  // until facets are sent
  Mesh whole_;
  Part part_;
  std::vector<Holder> holders_;                 // of points that other ranks hold, too
  std::vector<std::uint32_t> owners_;           // of the rank's points
  std::vector<VertexId> new_place_;             // of the rank's points among all vertices that it holds
  std::vector<SentCell> guests_;                // ascending
  std::vector<SentFacet> facets_;               // ascending
  std::vector<PointOfPiece> points_of_facets_;  // those that the rank may not hold
};

}  // namespace

Mesh read_pvtu_part(const std::string& path, Communication& ranks) { return PartReader(path, ranks).read(); }

}  // namespace podm::verify
