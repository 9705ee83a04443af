#include "readers/vtu_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace podm::verify {
namespace {

constexpr std::uint8_t kBad = 255, kPad = 254, kBlank = 253;  // other values: the six bits of a character

constexpr std::array<std::uint8_t, 256> make_table() {
  std::array<std::uint8_t, 256> table{};
  table.fill(kBad);
  std::uint8_t value = 0;
  for (const char c : std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"))
    table[static_cast<unsigned char>(c)] = value++;
  for (const char c : std::string_view(" \t\r\n")) table[static_cast<unsigned char>(c)] = kBlank;
  table['='] = kPad;
  return table;
}
constexpr std::array<std::uint8_t, 256> kBits = make_table();

}  // namespace

std::string_view VtuBytes::take(std::uint64_t size, ByteBuffer& bytes) {
  if (size > most_left()) refuse_end(size);
  if (!is_base64_) {
    const std::string_view view = file_.bytes().substr(next_, size);
    next_ += size;
    return view;
  }
  char* to = bytes.extend(size);
  decode(to, size);
  return {to, static_cast<std::size_t>(size)};
}

std::uint64_t VtuBytes::most_left() const {
  return is_base64_ ? (end_ - next_) / 4 * 3 + static_cast<unsigned>(group_end_ - group_begin_)
                    : end_ - next_;
}

void VtuBytes::decode(char* to, std::size_t size) {
  const auto* text = reinterpret_cast<const unsigned char*>(file_.bytes().data());
  while (size > 0) {
    if (group_begin_ < group_end_) {
      *to++ = group_[group_begin_++];
      --size;
      continue;
    }
    for (; size >= 3 && end_ - next_ >= 4; size -= 3, next_ += 4, to += 3) {  // groups without blank or pad
      const std::uint8_t a = kBits[text[next_]], b = kBits[text[next_ + 1]], c = kBits[text[next_ + 2]],
                         d = kBits[text[next_ + 3]];
      if ((a | b | c | d) >= 64) break;
      to[0] = static_cast<char>(a << 2 | b >> 4);
      to[1] = static_cast<char>(b << 4 | c >> 2);
      to[2] = static_cast<char>(c << 6 | d);
    }
    if (size > 0) decode_group();
  }
}

void VtuBytes::decode_group() {
  std::array<std::uint8_t, 4> bits{};
  int num_read = 0, num_pads = 0;
  while (num_read < 4) {
    if (next_ == end_) refuse_end(1);
    const auto c = static_cast<unsigned char>(file_.bytes()[next_]);
    const std::uint8_t value = kBits[c];
    const bool may_pad = num_read >= 2;
    if (value == kBad || (value == kPad && !may_pad) || (value < 64 && num_pads > 0))
      file_.refuse(MeshFile::byte_at(next_),
                   fmt::format("character {:#x} is out of place in base64 data", c));
    ++next_;
    if (value == kBlank) continue;
    if (value == kPad) ++num_pads;
    bits[num_read++] = value == kPad ? std::uint8_t{0} : value;
  }
  group_[0] = static_cast<char>(bits[0] << 2 | bits[1] >> 4);
  group_[1] = static_cast<char>(bits[1] << 4 | bits[2] >> 2);
  group_[2] = static_cast<char>(bits[2] << 6 | bits[3]);
  group_begin_ = 0;
  group_end_ = 3 - num_pads;
}

void VtuBytes::refuse_end(std::uint64_t size) const {
  file_.refuse(MeshFile::byte_at(next_), fmt::format("{} bytes of data are needed, fewer are left", size));
}

}  // namespace podm::verify
