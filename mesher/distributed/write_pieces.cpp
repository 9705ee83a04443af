#include "distributed/write_pieces.h"

#include <optional>

#include "distributed/messages.h"
#include "io/write_pvtu.h"
#include "io/write_xdmf.h"

namespace podm {
namespace {

// Those of all ranks, so that a pair has the same number on each.
LabelPairs gathered(const LabelPairs& own, Communication& ranks) {
  std::vector<LabelPair> pairs;
  for (std::size_t i = 0; i < own.size(); ++i) pairs.push_back(own[i]);
  Bytes message;
  append(message, pairs);
  pairs.clear();
  for (const Bytes& told : ranks.all_gather(message)) {
    const auto theirs = MessageReader(told).read<LabelPair>();
    pairs.insert(pairs.end(), theirs.begin(), theirs.end());
  }
  return LabelPairs(pairs);
}

// What the first rank tells.
std::string told_by_first(const std::string& text, Communication& ranks) {
  Bytes message;
  append(message, std::span<const char>(text));
  const std::vector<Bytes> all = ranks.all_gather(message);
  const std::vector<char> told = MessageReader(all.front()).read<char>();
  return {told.begin(), told.end()};
}

}  // namespace

void write_pvtu(const MeshPiece& piece, const std::string& path, Communication& ranks) {
  std::deque<AtomicFile> files = write_pvtu_piece(piece, path);
  for (AtomicFile& file : files) file.finish();
  ranks.barrier();
  const int num_earlier_pieces = piece.rank == 0 ? withdraw_pvtu_index(path) : 0;
  ranks.barrier();
  publish_together(files);
  ranks.barrier();
  if (piece.rank == 0) write_pvtu_index(path, piece.num_pieces, num_earlier_pieces);
  ranks.barrier();
}

void write_xdmf(const MeshPiece& piece, const std::string& path, Communication& ranks) {
  const XdmfPart part(piece);
  const LabelPairs pairs = gathered(LabelPairs(piece.mesh.facet_labels), ranks);
  const std::string arrays_path = hdf5_path_of(path);
  std::optional<TemporaryFile> arrays;
  if (piece.rank == 0) {
    arrays.emplace(arrays_path);
    create_xdmf_arrays(arrays->temporary_path(), arrays_path, part, pairs);
  }
  const std::string file = told_by_first(arrays ? arrays->temporary_path() : "", ranks);
  for (int turn = 0; turn < piece.num_pieces; ++turn) {
    if (turn == piece.rank) write_xdmf_part(file, arrays_path, part, pairs);
    ranks.barrier();
  }
  if (arrays) publish_xdmf(path, part, *arrays);
  ranks.barrier();
}

}  // namespace podm
