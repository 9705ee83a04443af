// SHA-256 of values and files.
#pragma once

#include <memory>
#include <string>
#include <type_traits>

namespace podm::verify {

class Sha256 {
 public:
  Sha256();
  void add(const void* bytes, std::size_t count);
  /// Adds the bytes of the list's items.
  template <class List>
  void add(const List& list) {
    static_assert(std::has_unique_object_representations_v<typename List::value_type> ||
                  std::is_floating_point_v<typename List::value_type>);
    add(list.data(), list.size() * sizeof(typename List::value_type));
  }
  /// Returns the hash of all that was added, as hexadecimal digits. The last call.
  std::string hex();

 private:
  std::unique_ptr<void, void (*)(void*)> context_;
};

/// Throws InputError if the file cannot be read.
std::string sha256_of(const std::string& path);

}  // namespace podm::verify
