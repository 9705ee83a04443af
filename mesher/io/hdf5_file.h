// HDF5 files of datasets whose sizes and places are known at creation. The library makes the file. Afterwards
// any number of processes write rows of its datasets at once, without the library (io/shared_rows.h).
#pragma once

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "io/shared_rows.h"

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
  /// `path` must exist; its content is replaced. Messages contain `shown_path`.
  Hdf5File(const std::string& path, const std::string& shown_path);

  /// Allocates a dataset with rows of `num_columns` numbers (0: one number per row, in one dimension).
  /// Returns its place in the file. The values are written later.
  RowsInFile make_dataset(const std::string& name, hid_t type, std::uint64_t num_rows,
                          std::uint64_t num_columns);
  void write_strings(const std::string& name, const std::vector<std::string>& texts);
  /// Writes texts of variable length without a declared character set, which is the only kind that VTK reads.
  void write_texts_for_vtk(const std::string& name, const std::vector<std::string>& texts);
  void make_group(const std::string& name);
  void write_attribute(const std::string& group, const std::string& name, const std::string& text);
  void write_attribute(const std::string& group, const std::string& name,
                       std::array<std::int64_t, 2> numbers);

  /// Makes a dataset as make_dataset() does, with the values value_at(row, column). It is a small one.
  template <class Value, class ValueAt>
  void write_numbers(const std::string& name, std::uint64_t num_rows, std::uint64_t num_columns,
                     const ValueAt& value_at);

  /// Flushes everything to the system. No write may follow.
  void close();

 private:
  void write_attribute(const std::string& group, const std::string& name, hid_t type, hid_t space,
                       const void* value);
  void write_all(const std::string& name, hid_t type, const void* values) const;
  hid_t check(hid_t result) const;

  std::string path_;
  Hdf5Handle file_;
};

inline hid_t hdf5_type(std::int64_t) { return H5T_STD_I64LE; }
inline hid_t hdf5_type(std::uint32_t) { return H5T_STD_U32LE; }

template <class Value, class ValueAt>
void Hdf5File::write_numbers(const std::string& name, std::uint64_t num_rows, std::uint64_t num_columns,
                             const ValueAt& value_at) {
  std::vector<Value> values;
  for (std::uint64_t row = 0; row < num_rows; ++row)
    for (std::uint64_t column = 0; column < std::max<std::uint64_t>(1, num_columns); ++column)
      values.push_back(static_cast<Value>(value_at(row, column)));
  make_dataset(name, hdf5_type(Value()), num_rows, num_columns);
  write_all(name, hdf5_type(Value()), values.data());
}

}  // namespace podm
