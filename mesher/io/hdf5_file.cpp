#include "io/hdf5_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "podm/errors.h"

namespace podm {
namespace {

// Returns the system's message if the system refused, otherwise the message of the innermost failed function
// of the library.
std::string last_fault() {
  std::string fault = "the HDF5 library fails";
  const auto take = [](unsigned, const H5E_error2_t* error, void* text) -> herr_t {
    if (error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, take, &fault);
  constexpr std::string_view kMark = "error message = '";
  const std::size_t begin = fault.find(kMark);
  if (begin == std::string::npos) return fault;
  fault.erase(0, begin + kMark.size());
  return fault.substr(0, fault.find('\''));
}

// Must be called before any other call clears the library's error stack.
hid_t check_result(hid_t result, const std::string& path) {
  if (result < 0) throw InputError(fmt::format("cannot write {}: {}", path, last_fault()));
  return result;
}

Hdf5Handle make_file(const std::string& path, const std::string& shown_path) {
  // Disables the library's cleanup at exit. After a full disk the cleanup would retry the write and crash.
  static const herr_t unwanted_cleanup = H5dont_atexit();
  static_cast<void>(unwanted_cleanup);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // stops the library from printing errors
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access, 0, 1);  // another lock already protects the file (files/temporary_name.cpp)
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  return {check_result(file, shown_path), H5Fclose};
}

}  // namespace

Hdf5File::Hdf5File(const std::string& path, const std::string& shown_path)
    : path_(shown_path), file_(make_file(path, shown_path)) {}

hid_t Hdf5File::check(hid_t result) const { return check_result(result, path_); }

void Hdf5File::close() { check(H5Fclose(file_.release())); }

RowsInFile Hdf5File::make_dataset(const std::string& name, hid_t type, std::uint64_t num_rows,
                                  std::uint64_t num_columns) {
  const std::array<hsize_t, 2> sizes{num_rows, num_columns};
  const Hdf5Handle space(check(H5Screate_simple(num_columns == 0 ? 1 : 2, sizes.data(), nullptr)), H5Sclose);
  const Hdf5Handle creation(check(H5Pcreate(H5P_DATASET_CREATE)), H5Pclose);
  H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);  // otherwise it has no place yet
  H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
  H5Pset_obj_track_times(creation, 0);  // the same mesh must give the same bytes
  const Hdf5Handle dataset(
      check(H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT)), H5Dclose);
  return {num_rows == 0 ? 0 : H5Dget_offset(dataset), std::max<std::uint64_t>(1, num_columns)};
}

void Hdf5File::write_strings(const std::string& name, const std::vector<std::string>& texts) {
  std::size_t longest = 1;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  const Hdf5Handle type(check(H5Tcopy(H5T_C_S1)), H5Tclose);
  H5Tset_size(type, longest);
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  make_dataset(name, type, texts.size(), 0);
  std::string block;
  for (const std::string& text : texts) block += text + std::string(longest - text.size(), '\0');
  write_all(name, type, block.data());
}

void Hdf5File::write_texts_for_vtk(const std::string& name, const std::vector<std::string>& texts) {
  std::vector<const char*> pointers;
  for (const std::string& text : texts) pointers.push_back(text.c_str());
  const Hdf5Handle type(check(H5Tcopy(H5T_C_S1)), H5Tclose);
  H5Tset_size(type, H5T_VARIABLE);
  const hsize_t count = texts.size();
  const Hdf5Handle space(check(H5Screate_simple(1, &count, nullptr)), H5Sclose);
  const Hdf5Handle creation(check(H5Pcreate(H5P_DATASET_CREATE)), H5Pclose);
  H5Pset_obj_track_times(creation, 0);
  const Hdf5Handle dataset(
      check(H5Dcreate2(file_, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT)), H5Dclose);
  check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()));
}

void Hdf5File::make_group(const std::string& name) {
  const Hdf5Handle group(check(H5Gcreate2(file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)),
                         H5Gclose);
}

void Hdf5File::write_attribute(const std::string& group, const std::string& name, const std::string& text) {
  const Hdf5Handle type(check(H5Tcopy(H5T_C_S1)), H5Tclose);
  H5Tset_size(type, text.size());
  const Hdf5Handle space(check(H5Screate(H5S_SCALAR)), H5Sclose);
  write_attribute(group, name, type, space, text.data());
}

void Hdf5File::write_attribute(const std::string& group, const std::string& name,
                               std::array<std::int64_t, 2> numbers) {
  const hsize_t count = numbers.size();
  const Hdf5Handle space(check(H5Screate_simple(1, &count, nullptr)), H5Sclose);
  write_attribute(group, name, H5T_STD_I64LE, space, numbers.data());
}

void Hdf5File::write_attribute(const std::string& group, const std::string& name, hid_t type, hid_t space,
                               const void* value) {
  const Hdf5Handle attribute(check(H5Acreate_by_name(file_, group.c_str(), name.c_str(), type, space,
                                                     H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)),
                             H5Aclose);
  check(H5Awrite(attribute, type, value));
}

void Hdf5File::write_all(const std::string& name, hid_t type, const void* values) const {
  const Hdf5Handle dataset(check(H5Dopen2(file_, name.c_str(), H5P_DEFAULT)), H5Dclose);
  check(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
}

}  // namespace podm
