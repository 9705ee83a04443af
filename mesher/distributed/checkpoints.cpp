#include "distributed/checkpoints.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "distributed/messages.h"
#include "files/atomic_file.h"

namespace podm {

namespace {

constexpr std::string_view kPiecePrefix = "vertices_";

// Returns the number of the checkpoint to which a file of this name belongs; 0: it is no piece.
std::uint64_t number_of(std::string_view name) {
  if (!name.starts_with(kPiecePrefix)) return 0;
  name.remove_prefix(kPiecePrefix.size());
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  return error == std::errc() && end != name.data() + name.size() && *end == '_' ? number : 0;
}

// Calls visit(path, number) for each piece in the folder, also for those of checkpoints that are not whole.
template <class Visit>
void for_each_piece(const std::string& folder, const Visit& visit) {
  std::error_code error;
  for (auto entry = std::filesystem::directory_iterator(folder, error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
    if (const std::uint64_t number = number_of(entry->path().filename().string()); number > 0)
      visit(entry->path(), number);
}

struct PieceSent {
  std::uint64_t vertices, bytes;
  std::array<char, 64> sha256;
};

PieceSent sent(const CheckpointPiece& piece) {
  PieceSent sent{piece.vertices, piece.bytes, {}};
  piece.sha256.copy(sent.sha256.data(), sent.sha256.size());
  return sent;
}

CheckpointPiece received(const PieceSent& sent) {
  return {sent.vertices, sent.bytes, std::string(sent.sha256.data(), sent.sha256.size())};
}

void expect_same(const std::string& path, const std::vector<Fact>& ours, const std::vector<Fact>& theirs) {
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const auto& [name, value] = ours[i];
    if (i >= theirs.size() || theirs[i].first != name)
      throw InputError(fmt::format("{}: the checkpoint lacks the {} of its run", path, name));
    if (theirs[i].second != value)
      throw InputError(fmt::format("{}: the checkpoint does not have the {} of this run: {}, not {}", path,
                                   name, theirs[i].second, value));
  }
}

}  // namespace

Checkpoints::Checkpoints(const CheckpointOptions& options, const std::vector<Fact>& facts,
                         Communication& ranks)
    : folder_(options.folder), seconds_(options.seconds), facts_(facts), ranks_(ranks) {
  const auto look = [&] {
    if (options.is_resumed) expect_text();
  };
  do_collectively(look, ranks_);  // before the lock makes the folder
  const auto lock = [&] {
    if (ranks_.rank() == 0) lock_.emplace(folder_);
  };
  do_collectively(lock, ranks_);
  const auto read = [&] {
    if (options.is_resumed) last_ = read_text();
  };
  do_collectively(read, ranks_);
  std::array<std::uint64_t, 1> number{largest_number()};
  ranks_.maximum(number);
  number_ = number[0];
}

std::string Checkpoints::piece_path(std::uint64_t number, std::uint64_t rank) const {
  return fmt::format("{}/{}{}_{}.bin", folder_, kPiecePrefix, number, rank);
}

void Checkpoints::expect_text() const {
  std::error_code error;
  if (std::filesystem::exists(text_path(), error)) return;
  throw InputError(error ? fmt::format("{}: cannot read: {}", text_path(), error.message())
                         : fmt::format("{}: the folder has no whole checkpoint", folder_));
}

CheckpointText Checkpoints::read_text() const {
  CheckpointText text = read_checkpoint_text(text_path(), bytes_of_file(text_path()));
  expect_same(text_path(), facts_, text.facts);
  return text;
}

std::uint64_t Checkpoints::largest_number() const {
  std::uint64_t largest = last_ ? last_->number : 0;
  for_each_piece(folder_, [&](const auto&, std::uint64_t number) { largest = std::max(largest, number); });
  return largest;
}

bool Checkpoints::is_due() const {
  const std::chrono::duration<double> since = Clock::now() - written_;
  std::array<std::uint64_t, 1> is_due{since.count() >= seconds_ ? 1u : 0u};
  ranks_.maximum(is_due);
  return is_due[0] > 0;
}

void Checkpoints::write(const std::vector<LearntVertex>& vertices, std::uint64_t rounds_of_run) {
  ++number_;
  const std::string path = piece_path(number_, static_cast<std::uint64_t>(ranks_.rank()));
  CheckpointPiece own;
  try {
    do_collectively([&] { own = write_checkpoint_piece(path, vertices); }, ranks_);
  } catch (const RefusedByAll&) {
    std::error_code error;
    std::filesystem::remove(path, error);
    throw;
  }
  Bytes message;
  append(message, std::vector<PieceSent>{sent(own)});
  std::vector<CheckpointPiece> pieces;
  for (const Bytes& one : ranks_.all_gather(std::move(message)))
    pieces.push_back(received(values_of<PieceSent>(one).at(0)));
  // If this fails, the pieces stay: the text may have its name already. A later checkpoint removes them.
  const auto write_on_first = [&] {
    if (ranks_.rank() == 0) write_text(pieces, (last_ ? last_->rounds : 0) + rounds_of_run);
  };
  do_collectively(write_on_first, ranks_);
  if (ranks_.rank() == 0) remove_other_pieces();
  written_ = Clock::now();
}

void Checkpoints::write_text(const std::vector<CheckpointPiece>& pieces, std::uint64_t rounds) {
  for (std::size_t rank = 0; rank < pieces.size(); ++rank) {
    std::error_code error;
    const std::string path = piece_path(number_, rank);
    if (const auto size = std::filesystem::file_size(path, error); error || size != pieces[rank].bytes)
      throw InputError(
          fmt::format("{}: rank {} wrote it, but rank 0 does not see it whole; all ranks must see "
                      "the folder of checkpoints",
                      path, rank));
  }
  AtomicFile file(text_path());
  file.write(file_of({.facts = facts_, .number = number_, .rounds = rounds, .pieces = pieces}));
  file.publish();
}

void Checkpoints::remove_other_pieces() const {
  for_each_piece(folder_, [&](const std::filesystem::path& path, std::uint64_t number) {
    std::error_code error;
    if (number != number_) std::filesystem::remove(path, error);
  });
}

std::vector<LearntVertex> Checkpoints::read() const {
  std::vector<LearntVertex> vertices;
  const auto read = [&] {
    const auto size = static_cast<std::size_t>(ranks_.size());
    for (auto rank = static_cast<std::size_t>(ranks_.rank()); rank < last_->pieces.size(); rank += size) {
      const auto more = read_checkpoint_piece(piece_path(last_->number, rank), last_->pieces[rank]);
      vertices.insert(vertices.end(), more.begin(), more.end());
    }
  };
  do_collectively(read, ranks_);
  return vertices;
}

}  // namespace podm
