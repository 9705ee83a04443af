#include "distributed/write_pieces.h"

#include <optional>

#include "distributed/collective_errors.h"
#include "distributed/messages.h"
#include "io/write_pvtu.h"
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

}  // namespace

std::string text_of_first_rank(const std::string& text, Communication& ranks) {
  Bytes message;
  append(message, std::span<const char>(text));
  const std::vector<Bytes> all = ranks.all_gather(message);
  const std::vector<char> first = MessageReader(all.front()).read<char>();
  return {first.begin(), first.end()};
}

void check_pieces_path(const std::string& path) {
  if (!path.ends_with(".pvtu") && !path.ends_with(".xdmf"))
    throw InputError(fmt::format("cannot write {}: ranks write .pvtu or .xdmf", path));
  const AtomicFile trial(path);  // the first step of writing; leaves nothing behind
}

void write_pieces(const MeshPiece& piece, const std::string& path, Communication& ranks) {
  check_pieces_path(path);
  return path.ends_with(".pvtu") ? write_pvtu(piece, path, ranks) : write_xdmf(piece, path, ranks);
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
  on_first([&] { num_earlier_pieces = withdraw_pvtu_index(path); });
  do_collectively([&] { publish_together(files); }, ranks);
  on_first([&] { write_pvtu_index(path, piece.num_pieces, num_earlier_pieces); });
}

void write_xdmf(const MeshPiece& piece, const std::string& path, Communication& ranks) {
  const XdmfPart part(piece);
  const LabelPairs pairs = gathered(LabelPairs(piece.mesh.facet_labels), ranks);
  const std::string arrays_path = hdf5_path_of(path);
  std::optional<TemporaryFile> arrays;
  const auto make_arrays = [&] {
    if (piece.rank != 0) return;
    arrays.emplace(arrays_path);
    create_xdmf_arrays(arrays->temporary_path(), arrays_path, part, pairs);
  };
  do_collectively(make_arrays, ranks);
  const std::string file = text_of_first_rank(arrays ? arrays->temporary_path() : "", ranks);
  for (int turn = 0; turn < piece.num_pieces; ++turn) {
    const auto add_rows = [&] {
      if (turn == piece.rank) write_xdmf_part(file, arrays_path, part, pairs);
    };
    do_collectively(add_rows, ranks);
  }
  const auto publish = [&] {
    if (arrays) publish_xdmf(path, part, *arrays);
  };
  do_collectively(publish, ranks);
}

}  // namespace podm
