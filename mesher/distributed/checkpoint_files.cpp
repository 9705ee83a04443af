#include "distributed/checkpoint_files.h"

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "distributed/vertex_source.h"
#include "files/atomic_file.h"
#include "io/sha256.h"

namespace podm {

namespace {

constexpr std::string_view kTextMagic = "podm-mpi checkpoint, format: 1";
constexpr std::string_view kHashName = "SHA-256 of the lines above";
constexpr std::string_view kPieceMagic = "PODMCKP1";
constexpr std::size_t kHeadBytes = 16, kVertexBytes = 3 * sizeof(double) + 1;

std::string sha256_of(std::string_view bytes) {
  Sha256 hash;
  hash.update(std::span<const char>(bytes));
  return hash.hexadecimal();
}

[[noreturn]] void refuse(const std::string& path, const std::string& fault) {
  throw InputError(path + ": " + fault);
}

// Reads "name: value" lines one after the other.
class CheckedLines {
 public:
  CheckedLines(const std::string& path, std::string_view text) : path_(path), rest_(text) {}

  bool is_at_end() const { return rest_.empty(); }
  Fact next() {
    ++number_;
    const std::size_t end = rest_.find('\n');
    const std::string_view line = rest_.substr(0, end);
    const std::size_t colon = line.find(": ");
    if (end == std::string_view::npos || colon == std::string_view::npos) fail("a line \"name: value\"");
    rest_.remove_prefix(end + 1);
    return {std::string(line.substr(0, colon)), std::string(line.substr(colon + 2))};
  }
  std::string value(const std::string& name) {
    const Fact fact = next();
    if (fact.first != name) fail(fmt::format("\"{}\"", name));
    return fact.second;
  }
  std::uint64_t number(const std::string& name) { return number_in(value(name)); }
  std::uint64_t number_in(std::string_view text) const {
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) fail("a number");
    return number;
  }
  [[noreturn]] void fail(const std::string& expected) const {
    refuse(path_, fmt::format("line {}: {} expected", number_, expected));
  }

 private:
  const std::string& path_;
  std::string_view rest_;
  int number_ = 0;
};

CheckpointPiece piece_of(const std::string& text, const CheckedLines& lines) {
  const std::size_t first = text.find(' '), second = text.find(' ', first + 1);
  if (second == std::string::npos) lines.fail("\"vertices bytes SHA-256\"");
  const std::string_view all = text;
  return {.vertices = lines.number_in(all.substr(0, first)),
          .bytes = lines.number_in(all.substr(first + 1, second - first - 1)),
          .sha256 = text.substr(second + 1)};
}

// Returns the lines before the last one, which has their hash.
std::string_view checked_lines(const std::string& path, std::string_view file) {
  if (!file.starts_with(kTextMagic))
    refuse(path,
           fmt::format("it does not begin with \"{}\"; it is no checkpoint of this version", kTextMagic));
  const std::size_t last = file.rfind(kHashName);
  if (last == std::string_view::npos || last == 0) refuse(path, "its end is missing");
  const std::string_view lines = file.substr(0, last);
  if (file.substr(last) != fmt::format("{}: {}\n", kHashName, sha256_of(lines)))
    refuse(path, "it has changed since it was written: its SHA-256 differs");
  return lines;
}

}  // namespace

std::string file_of(const CheckpointText& text) {
  std::string lines = fmt::format("{}\n", kTextMagic);
  const auto add = [&](const std::string& name, const auto& value) {
    lines += fmt::format("{}: {}\n", name, value);
  };
  add("facts", text.facts.size());
  for (const auto& [name, value] : text.facts) add(name, value);
  add("number", text.number);
  add("rounds", text.rounds);
  add("pieces", text.pieces.size());
  for (const CheckpointPiece& piece : text.pieces)
    add("piece", fmt::format("{} {} {}", piece.vertices, piece.bytes, piece.sha256));
  return lines + fmt::format("{}: {}\n", kHashName, sha256_of(lines));
}

CheckpointText read_checkpoint_text(const std::string& path, std::string_view file) {
  CheckedLines lines(path, checked_lines(path, file));
  lines.next();  // the magic
  CheckpointText text;
  for (std::uint64_t left = lines.number("facts"); left > 0; --left) text.facts.push_back(lines.next());
  text.number = lines.number("number");
  text.rounds = lines.number("rounds");
  for (std::uint64_t left = lines.number("pieces"); left > 0; --left)
    text.pieces.push_back(piece_of(lines.value("piece"), lines));
  if (!lines.is_at_end()) refuse(path, "it has more lines than it announces");
  return text;
}

CheckpointPiece write_checkpoint_piece(const std::string& path, const std::vector<LearntVertex>& vertices) {
  std::string bytes(kPieceMagic);
  bytes.resize(kHeadBytes + vertices.size() * kVertexBytes);
  char* to = bytes.data() + kPieceMagic.size();
  const auto put = [&](const auto& value) {
    std::memcpy(to, &value, sizeof value);
    to += sizeof value;
  };
  put(std::uint64_t{vertices.size()});
  for (const LearntVertex& vertex : vertices) {
    put(vertex.point.x);
    put(vertex.point.y);
    put(vertex.point.z);
  }
  for (const LearntVertex& vertex : vertices) put(vertex.kind);
  AtomicFile file(path);
  file.write(bytes);
  file.publish();
  return {vertices.size(), bytes.size(), sha256_of(bytes)};
}

std::vector<LearntVertex> read_checkpoint_piece(const std::string& path, const CheckpointPiece& piece) {
  std::error_code error;
  if (const auto size = std::filesystem::file_size(path, error); !error && size != piece.bytes)
    refuse(path, fmt::format("it has {} bytes, not {}", size, piece.bytes));
  const std::string bytes = bytes_of_file(path);
  if (bytes.size() != piece.bytes || sha256_of(bytes) != piece.sha256)
    refuse(path, "it has changed since it was written: its SHA-256 differs");
  if (!bytes.starts_with(kPieceMagic) || bytes.size() < kHeadBytes ||
      (bytes.size() - kHeadBytes) % kVertexBytes != 0)
    refuse(path, "it is no piece of a checkpoint");
  std::uint64_t count = 0;
  std::memcpy(&count, bytes.data() + kPieceMagic.size(), sizeof count);
  if (const std::size_t in_file = (bytes.size() - kHeadBytes) / kVertexBytes;
      count != in_file || piece.vertices != in_file)
    refuse(path,
           fmt::format("it has {} vertices, not {}", in_file, count != in_file ? count : piece.vertices));
  std::vector<LearntVertex> vertices(piece.vertices);
  const char* const points = bytes.data() + kHeadBytes;
  const char* const kinds = points + piece.vertices * 3 * sizeof(double);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    std::array<double, 3> at;
    std::memcpy(at.data(), points + i * sizeof at, sizeof at);
    vertices[i] = {{at[0], at[1], at[2]}, static_cast<VertexKind>(kinds[i])};
    const bool is_finite = std::isfinite(at[0]) && std::isfinite(at[1]) && std::isfinite(at[2]);
    if (!is_finite || !is_shared(vertices[i].kind) || vertices[i].kind > VertexKind::kCircumcenter)
      refuse(path, fmt::format("vertex {} is impossible", i));
  }
  return vertices;
}

std::string bytes_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(path, fmt::format("cannot read: {}", std::strerror(errno)));
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (file.bad()) refuse(path, "cannot read it to its end");
  return bytes;
}

}  // namespace podm
