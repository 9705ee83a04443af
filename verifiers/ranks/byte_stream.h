// Values as bytes of a message, and back. Both ends run the same program on the same kind of processor.
//
// A type that is not trivially copyable lists its members once, for both directions:
//   template <class Stream> void transfer(Stream& stream) { stream(name, counts); }
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace podm::verify {

using Bytes = std::vector<std::byte>;

class ByteWriter {
 public:
  template <class... Values>
  void operator()(Values&... values) {
    (write(values), ...);
  }
  Bytes take() { return std::move(bytes_); }

 private:
  void append(const void* begin, std::size_t count) {
    const auto* first = static_cast<const std::byte*>(begin);
    bytes_.insert(bytes_.end(), first, first + count);
  }
  template <class Value>
  void write(Value& value) {
    if constexpr (requires { value.transfer(*this); }) {
      value.transfer(*this);
    } else {
      static_assert(std::is_trivially_copyable_v<Value>);
      append(&value, sizeof value);
    }
  }
  void write(std::string& text) { write_list(text); }
  template <class Item>
  void write(std::vector<Item>& items) {
    write_list(items);
  }
  template <class Key, class Value>
  void write(std::map<Key, Value>& items) {
    std::uint64_t size = items.size();
    write(size);
    for (auto& [key, value] : items) {
      Key copy = key;
      (*this)(copy, value);
    }
  }
  template <class List>
  void write_list(List& items) {
    std::uint64_t size = items.size();
    write(size);
    if constexpr (std::is_trivially_copyable_v<typename List::value_type>) {
      append(items.data(), size * sizeof(typename List::value_type));
    } else {
      for (auto& item : items) write(item);
    }
  }

  Bytes bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(const Bytes& bytes) : next_(bytes.data()), num_left_(bytes.size()) {}
  template <class... Values>
  void operator()(Values&... values) {
    (read(values), ...);
  }
  void expect_end() const {
    if (num_left_ > 0) throw std::runtime_error("a message between ranks is longer than its values");
  }

 private:
  void expect_left(std::uint64_t count, std::size_t least_size) const {
    if (count > num_left_ / least_size) throw std::runtime_error("a message between ranks ends early");
  }
  void take(void* place, std::size_t count) {
    expect_left(count, 1);
    std::copy_n(next_, count, static_cast<std::byte*>(place));
    next_ += count;
    num_left_ -= count;
  }
  template <class Value>
  void read(Value& value) {
    if constexpr (requires { value.transfer(*this); }) {
      value.transfer(*this);
    } else {
      static_assert(std::is_trivially_copyable_v<Value>);
      take(&value, sizeof value);
    }
  }
  void read(std::string& text) { read_list(text); }
  template <class Item>
  void read(std::vector<Item>& items) {
    read_list(items);
  }
  template <class Key, class Value>
  void read(std::map<Key, Value>& items) {
    std::uint64_t size = 0;
    read(size);
    items.clear();
    for (std::uint64_t i = 0; i < size; ++i) {
      Key key{};
      read(key);
      read(items[key]);
    }
  }
  template <class List>
  void read_list(List& items) {
    constexpr bool is_copied = std::is_trivially_copyable_v<typename List::value_type>;
    std::uint64_t size = 0;
    read(size);
    expect_left(size, is_copied ? sizeof(typename List::value_type) : 1);
    items.resize(size);
    if constexpr (is_copied) {
      take(items.data(), size * sizeof(typename List::value_type));
    } else {
      for (auto& item : items) read(item);
    }
  }

  const std::byte* next_;
  std::size_t num_left_;
};

template <class Value>
Bytes bytes_of(Value value) {
  ByteWriter writer;
  writer(value);
  return writer.take();
}

/// Throws std::runtime_error unless the bytes are those of one value.
template <class Value>
void read_bytes(const Bytes& bytes, Value& value) {
  ByteReader reader(bytes);
  reader(value);
  reader.expect_end();
}

}  // namespace podm::verify
