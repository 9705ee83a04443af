#include "readers/cursor.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace podm::verify {
namespace {

constexpr std::size_t kMostQuoted = 40;  // characters quoted of a wrong word in a message

std::string quoted(std::string_view word) {
  std::string text;
  for (const char c : word.substr(0, kMostQuoted)) text += c >= ' ' && c < 0x7f ? c : '?';
  return "'" + text + (word.size() > kMostQuoted ? "...'" : "'");
}

}  // namespace

Cursor::Cursor(const MeshFile& file, std::size_t begin, std::size_t end)
    : file_(file), next_(file.bytes().data() + begin), end_(file.bytes().data() + end), last_(next_) {}

void Cursor::skip_comments(std::function<void(std::string_view)> on_comment) {
  has_comments_ = true;
  on_comment_ = std::move(on_comment);
}

void Cursor::move_to(std::size_t position) {
  const char* begin = file_.bytes().data();
  if (position > static_cast<std::size_t>(end_ - begin))
    refuse(fmt::format("a position ({}) lies outside the file", position));
  last_ = next_ = begin + position;
}

void Cursor::skip_blanks() {
  while (next_ != end_) {
    if (is_blank(*next_)) {
      ++next_;
    } else if (has_comments_ && *next_ == '#') {
      const char* line_end = std::find(next_, end_, '\n');
      if (on_comment_) on_comment_({next_ + 1, line_end});
      next_ = line_end;
    } else {
      break;
    }
  }
  last_ = next_;
}

bool Cursor::is_at_last_word() {
  skip_blanks();
  return is_at_end();
}

bool Cursor::is_at_end_of_line() {
  while (next_ != end_ && *next_ != '\n' && is_blank(*next_)) ++next_;
  return next_ == end_ || *next_ == '\n' || (has_comments_ && *next_ == '#');
}

std::string_view Cursor::peek_word() {
  skip_blanks();
  return {next_, std::find_if(next_, end_, is_blank)};
}

std::string_view Cursor::word(const char* what) {
  const std::string_view text = peek_word();
  if (text.empty()) refuse(fmt::format("the file ends where {} is expected", what));
  next_ += text.size();
  return text;
}

std::string_view Cursor::rest_of_line() {
  last_ = next_;
  const char* line_end = std::find(next_, end_, '\n');
  std::string_view line(next_, line_end);
  next_ = line_end == end_ ? end_ : line_end + 1;
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::string_view Cursor::start_of_number(const char* what) {
  skip_blanks();
  if (next_ == end_) refuse(fmt::format("the file ends where {} is expected", what));
  const bool has_plus = *next_ == '+' && end_ - next_ > 1 && next_[1] != '-';  // from_chars takes no plus
  return {next_ + has_plus, end_};
}

std::size_t Cursor::count(const char* what, std::size_t least_bytes) {
  const auto value = number<std::int64_t>(what);
  if (value < 0) refuse(fmt::format("{} is negative ({})", what, value));
  expect_room(static_cast<std::uint64_t>(value), least_bytes, what);
  return static_cast<std::size_t>(value);
}

std::string_view Cursor::raw(std::uint64_t size, const char* what) {
  last_ = next_;
  if (size > bytes_left())
    refuse(fmt::format("the file ends within {} ({} bytes needed, {} left)", what, size, bytes_left()));
  next_ += size;
  return {last_, static_cast<std::size_t>(size)};
}

void Cursor::expect_room(std::uint64_t count, std::size_t least_bytes, const char* what) const {
  if (count > bytes_left() / least_bytes + 1)
    refuse(fmt::format("{} is {}, more than the {} bytes left can hold", what, count, bytes_left()));
}

void Cursor::refuse(const std::string& fault) const {
  const auto position = static_cast<std::size_t>(last_ - file_.bytes().data());
  file_.refuse(names_bytes_ ? MeshFile::byte_at(position) : file_.line_at(position), fault);
}

void Cursor::refuse_word(const char* fault, std::string_view word) const {
  refuse(fmt::format("{} {}", quoted(word), fault));
}

void Cursor::refuse_number(const char* what, const char* fault) {
  refuse(fmt::format("{} {} ({})", quoted(peek_word()), fault, what));
}

}  // namespace podm::verify
