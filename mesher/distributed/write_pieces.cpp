#include "distributed/write_pieces.h"

#include <array>
#include <memory>

#include "distributed/collective_errors.h"
#include "distributed/messages.h"
#include "io/write_pvtu.h"
#include "io/write_vtkhdf.h"
#include "io/write_vtu.h"
#include "io/write_xdmf.h"

namespace podm {
namespace {

// Returns the label pairs of all ranks, so that a pair has the same number on each rank.
LabelPairs gathered(const LabelPairs& own, Communication& ranks) {
  std::vector<LabelPair> pairs;
  for (std::size_t i = 0; i < own.size(); ++i) pairs.push_back(own[i]);
  Bytes message;
  append(message, pairs);
  pairs.clear();
  for (const Bytes& received : ranks.all_gather(message)) {
    const auto theirs = MessageReader(received).read<LabelPair>();
    pairs.insert(pairs.end(), theirs.begin(), theirs.end());
  }
  return LabelPairs(pairs);
}

template <class Value>
Value value_of_first_rank(const Value& value, Communication& ranks) {
  std::vector<Value> own;
  if (ranks.rank() == 0) own.push_back(value);
  Bytes message;
  append(message, own);
  return MessageReader(ranks.all_gather(std::move(message)).front()).read<Value>().front();
}

std::vector<VtkhdfSize> sizes_of_pieces(const VtkhdfSize& own, Communication& ranks) {
  Bytes message;
  append(message, std::span<const VtkhdfSize>(&own, 1));
  std::vector<VtkhdfSize> sizes;
  for (const Bytes& received : ranks.all_gather(std::move(message)))
    sizes.push_back(MessageReader(received).read<VtkhdfSize>().front());
  return sizes;
}

// Rank 0 makes a file of arrays without values by create(file), which returns their places. All ranks then
// write their rows by write_own(file, arrays), at once. Returns the file on rank 0. Collective.
template <class Arrays, class Create, class WriteOwn>
std::unique_ptr<TemporaryFile> write_together(const std::string& path, const Create& create,
                                              const WriteOwn& write_own, Communication& ranks) {
  std::unique_ptr<TemporaryFile> made;
  Arrays arrays;
  const auto make = [&] {
    if (ranks.rank() != 0) return;
    made = std::make_unique<TemporaryFile>(path);
    arrays = create(made->temporary_path());
  };
  do_collectively(make, ranks);
  const std::string file = text_of_first_rank(made ? made->temporary_path() : "", ranks);
  arrays = value_of_first_rank(arrays, ranks);
  do_collectively([&] { write_own(file, arrays); }, ranks);
  return made;
}

}  // namespace

std::string text_of_first_rank(const std::string& text, Communication& ranks) {
  Bytes message;
  append(message, std::span<const char>(text));
  const std::vector<Bytes> all = ranks.all_gather(message);
  const std::vector<char> first = MessageReader(all.front()).read<char>();
  return {first.begin(), first.end()};
}

void check_pieces_path(const std::string& path) {
  if (!path.ends_with(".pvtu") && !path.ends_with(".xdmf") && !path.ends_with(".vtkhdf"))
    throw InputError(fmt::format("cannot write {}: ranks write .pvtu, .xdmf or .vtkhdf", path));
  const AtomicFile trial(path);  // the first step of writing; leaves nothing behind
}

void write_pieces(const MeshPiece& piece, const std::string& path, Communication& ranks) {
  check_pieces_path(path);
  if (path.ends_with(".pvtu")) return write_pvtu(piece, path, ranks);
  return path.ends_with(".xdmf") ? write_xdmf(piece, path, ranks) : write_vtkhdf(piece, path, ranks);
}

void write_pvtu(const MeshPiece& piece, const std::string& path, Communication& ranks) {
  const auto on_first = [&](const auto& action) {
    do_collectively(
        [&] {
          if (piece.rank == 0) action();
        },
        ranks);
  };
  std::deque<AtomicFile> files;
  const auto write_aside = [&] {
    files = write_pvtu_piece(piece, path);
    for (AtomicFile& file : files) file.finish();
  };
  do_collectively(write_aside, ranks);
  int num_earlier_pieces = 0;
  on_first([&] { num_earlier_pieces = withdraw_pvtu_index(path, piece.num_pieces); });
  do_collectively([&] { publish_together(files); }, ranks);
  on_first([&] { write_pvtu_index(path, piece.num_pieces, num_earlier_pieces); });
}

void write_xdmf(const MeshPiece& piece, const std::string& path, Communication& ranks) {
  const XdmfPart part(piece);
  const LabelPairs pairs = gathered(LabelPairs(piece.mesh.facet_labels), ranks);
  const std::string arrays_path = hdf5_path_of(path);
  const auto create = [&](const std::string& file) {
    return create_xdmf_arrays(file, arrays_path, part, pairs);
  };
  const auto write_own = [&](const std::string& file, const XdmfArrays& arrays) {
    write_xdmf_part(file, arrays_path, part, pairs, arrays);
  };
  const auto made = write_together<XdmfArrays>(arrays_path, create, write_own, ranks);
  const auto publish = [&] {
    if (made) publish_xdmf(path, part, *made);
  };
  do_collectively(publish, ranks);
}

void write_vtkhdf(const MeshPiece& piece, const std::string& path, Communication& ranks) {
  std::vector<std::unique_ptr<TemporaryFile>> files;
  for (const auto kind : {VtkhdfPart::Kind::kCells, VtkhdfPart::Kind::kFacets}) {
    const std::string own_path = kind == VtkhdfPart::Kind::kCells ? path : facets_path_of(path);
    const VtkhdfPart part(piece, kind);
    const std::vector<VtkhdfSize> sizes = sizes_of_pieces(part.size(), ranks);
    const auto create = [&](const std::string& file) { return create_vtkhdf(file, own_path, part, sizes); };
    const auto write_own = [&](const std::string& file, const VtkhdfArrays& arrays) {
      write_vtkhdf_part(file, own_path, part, sizes, piece.rank, arrays);
    };
    files.push_back(write_together<VtkhdfArrays>(own_path, create, write_own, ranks));
  }
  const auto publish = [&] {
    if (piece.rank == 0) TemporaryFile::publish(std::array{files[0].get(), files[1].get()});
  };
  do_collectively(publish, ranks);
}

}  // namespace podm
