// Property: the text of a checkpoint is read and, written again, is read as the same, or it is refused with
// an InputError that begins with its path. So is a piece. The hashes are those of the input: otherwise every
// input would be refused by its hash alone.
#include <algorithm>
#include <cstring>
#include <span>

#include "distributed/checkpoint_files.h"
#include "distributed/vertex_source.h"
#include "fuzz_scratch.h"
#include "io/sha256.h"
#include "podm/errors.h"

namespace podm {
namespace {

using fuzz::check;

constexpr std::string_view kTextHead = "podm-mpi checkpoint, format: 1\n", kPieceHead = "PODMCKP1";

std::string sha256_of(std::string_view bytes) {
  Sha256 hash;
  hash.update(std::span<const char>(bytes));
  return hash.hexadecimal();
}

// Calls read(), which may refuse a file with an InputError that begins with its path.
template <class Read>
void check_read(const std::string& path, const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    check(std::string_view(error.what()).starts_with(path + ": "));
  }
}

void check_text(const std::string& file) {
  check_read("a.txt", [&] {
    const CheckpointText text = read_checkpoint_text("a.txt", file);
    check(read_checkpoint_text("a.txt", file_of(text)) == text);
  });
}

void check_piece(const fuzz::ScratchFolder& folder, const std::string& bytes) {
  std::uint64_t vertices = 0;
  if (bytes.size() >= kPieceHead.size() + sizeof vertices)
    std::memcpy(&vertices, bytes.data() + kPieceHead.size(), sizeof vertices);
  const std::string path = folder.write("a.bin", bytes);
  check_read(path, [&] {
    const auto read = read_checkpoint_piece(path, {vertices, bytes.size(), sha256_of(bytes)});
    check(read.size() == vertices);
    check(std::all_of(read.begin(), read.end(), [](const auto& vertex) { return is_shared(vertex.kind); }));
    check(write_checkpoint_piece(folder / "b.bin", read).sha256 == sha256_of(bytes));
  });
}

}  // namespace
}  // namespace podm

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace podm;
  static const fuzz::ScratchFolder folder;
  const std::string input(fuzz::text_of(data, size));
  const std::string lines = std::string(kTextHead) + input;
  check_text(input);
  check_text(lines + "SHA-256 of the lines above: " + sha256_of(lines) + "\n");
  check_piece(folder, input);
  check_piece(folder, std::string(kPieceHead) + input);
  return 0;
}
