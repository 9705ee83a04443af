// HDF5 files of datasets whose sizes are known at creation. Each writer holds some of the rows.
#pragma once

#include <hdf5.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace podm {

/// A handle of the HDF5 library, closed by the destructor.
class Hdf5Handle {
 public:
  Hdf5Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept : id_(other.release()), close_(other.close_) {}
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;
  ~Hdf5Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // for the library's functions
  hid_t release() { return std::exchange(id_, H5I_INVALID_HID); }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// An HDF5 file. Every member throws InputError "cannot write PATH: " and the reason.
class Hdf5File {
 public:
  enum class Mode { kMakeNew, kAddTo };
  /// `path` must exist; its content is replaced or extended. Messages contain `shown_path`.
  Hdf5File(const std::string& path, const std::string& shown_path, Mode mode);

  /// Allocates a dataset with rows of `num_columns` numbers (0: one number per row, in one dimension). The
  /// values are written later.
  void make_dataset(const std::string& name, hid_t type, std::uint64_t num_rows, std::uint64_t num_columns);
  void write_strings(const std::string& name, const std::vector<std::string>& texts);
  void make_group(const std::string& name);

  /// Writes rows [first_row, first_row + num_rows) of a dataset. `value_at(row, column)` counts rows from 0.
  template <class Value, class ValueAt>
  void write_rows(const std::string& name, std::uint64_t first_row, std::uint64_t num_rows, ValueAt value_at);

  /// Flushes everything to the system. No write may follow.
  void close();

 private:
  struct Dataset {
    Hdf5Handle dataset, space;
    std::uint64_t num_columns;
    int rank;
  };
  Dataset open(const std::string& name) const;
  void write_block(const Dataset& to, std::uint64_t first_row, std::uint64_t num_rows, hid_t type,
                   const void* values) const;
  hid_t check(hid_t result) const;

  std::string path_;
  Hdf5Handle file_;
};

inline hid_t hdf5_type(double) { return H5T_NATIVE_DOUBLE; }
inline hid_t hdf5_type(std::int64_t) { return H5T_NATIVE_INT64; }
inline hid_t hdf5_type(std::int32_t) { return H5T_NATIVE_INT32; }
inline hid_t hdf5_type(std::uint32_t) { return H5T_NATIVE_UINT32; }

template <class Value, class ValueAt>
void Hdf5File::write_rows(const std::string& name, std::uint64_t first_row, std::uint64_t num_rows,
                          ValueAt value_at) {
  constexpr std::uint64_t kBlockRows = 1 << 16;
  const Dataset to = open(name);
  std::vector<Value> block;
  for (std::uint64_t begin = 0; begin < num_rows; begin += kBlockRows) {
    const std::uint64_t end = std::min(begin + kBlockRows, num_rows);
    block.clear();
    for (std::uint64_t row = begin; row < end; ++row)
      for (std::uint64_t column = 0; column < to.num_columns; ++column)
        block.push_back(static_cast<Value>(value_at(row, column)));
    write_block(to, first_row + begin, end - begin, hdf5_type(Value()), block.data());
  }
}

}  // namespace podm
