// A position in a mesh file that advances over words, numbers, lines and raw bytes.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>

#include "readers/mesh_file.h"
#include "readers/number_array.h"

namespace podm::verify {

class Cursor {
 public:
  explicit Cursor(const MeshFile& file) : Cursor(file, 0, file.bytes().size()) {}
  /// Reads the bytes [begin, end) of the file.
  Cursor(const MeshFile& file, std::size_t begin, std::size_t end);

  /// From here on '#' begins a comment that runs to the end of its line.
  void skip_comments(std::function<void(std::string_view)> on_comment);
  /// From here on messages name bytes instead of lines.
  void name_bytes() { names_bytes_ = true; }

  bool is_at_end() const { return next_ == end_; }
  std::size_t position() const { return static_cast<std::size_t>(next_ - file_.bytes().data()); }
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - next_); }
  void move_to(std::size_t position);  ///< refuses a position outside the file

  bool is_at_last_word();    ///< true if only blanks (and comments) are left; skips them
  bool is_at_end_of_line();  ///< true if only blanks are left on the line; skips them but not the line's end
  std::string_view peek_word();  ///< empty at the end
  std::string_view word(const char* what);
  std::string_view rest_of_line();  ///< without the line's end, which is skipped

  /// Reads the next word as a number. Integers must fit the type; reals may be NaN or infinite.
  template <class Number>
  Number number(const char* what) {
    const std::string_view text = start_of_number(what);
    Number value{};
    const auto [after, error] = std::from_chars(text.data(), end_, value);
    if constexpr (std::is_floating_point_v<Number>) {
      if (error == std::errc::result_out_of_range) value = rounded<Number>({text.data(), after});
    } else {
      if (error == std::errc::result_out_of_range) refuse_number(what, "is out of range");
    }
    if (error == std::errc::invalid_argument || !is_word_end(after)) refuse_number(what, "is not a number");
    next_ = after;
    return value;
  }
  /// Reads a count of items of at least `least_bytes` each. Refuses a count that the rest of the file cannot
  /// hold.
  std::size_t count(const char* what, std::size_t least_bytes);

  std::string_view raw(std::uint64_t size, const char* what);
  template <class Number>
  Number raw_number(bool is_swapped, const char* what) {
    return load_number<Number>(raw(sizeof(Number), what).data(), is_swapped);
  }

  void expect_room(std::uint64_t count, std::size_t least_bytes, const char* what) const;
  /// Throws InputError with the position of the last word or bytes.
  [[noreturn]] void refuse(const std::string& fault) const;
  [[noreturn]] void refuse_word(const char* fault,
                                std::string_view word) const;  ///< "'abc' is not a keyword"

 private:
  static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  bool is_word_end(const char* place) const { return place == end_ || is_blank(*place) || *place == '#'; }
  void skip_blanks();
  std::string_view start_of_number(const char* what);
  /// Converts a real that is out of range: to infinity if it is too large, to the nearest value if too small.
  template <class Number>
  static Number rounded(const std::string& text) {
    if constexpr (std::is_same_v<Number, float>)
      return std::strtof(text.c_str(), nullptr);
    else
      return std::strtod(text.c_str(), nullptr);
  }
  [[noreturn]] void refuse_number(const char* what, const char* fault);

  const MeshFile& file_;
  const char *next_, *end_, *last_;  // last_: where the item read last began
  bool names_bytes_ = false, has_comments_ = false;
  std::function<void(std::string_view)> on_comment_;
};

}  // namespace podm::verify
