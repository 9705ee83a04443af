// What the fuzz targets of all formats do with their bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace podm::verify {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Writes `bytes` as a file of this name, in a folder held until the process ends.
void write_fuzz_file(const char* name, std::string_view bytes);

/// The file of this name either is a mesh that keeps what Mesh promises, and no larger than the bytes
/// (inflated) can tell, or is refused with an InputError that begins with the folder. Anything else aborts.
void read_fuzz_file(const char* name, std::size_t num_bytes);

}  // namespace podm::verify
