#include "distributed/write_pieces.h"

#include "io/write_pvtu.h"

namespace podm {

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

}  // namespace podm
