// A small mesh to write and read back, and how two meshes are compared.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <string>

#include "mesh.h"

namespace podm::verify {

/// A folder of its own for each test, removed with all in it.
class TestFolder {
 public:
  TestFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "podm-verify-test-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Three tetrahedra of two labels and two triangles; all coordinates are floats, so that any type holds them.
Mesh make_small_mesh();

void write_bytes(const std::string& path, const std::string& bytes);
std::string read_bytes(const std::string& path);
std::string gzipped(const std::string& bytes);

/// Reads `path`; the message of the InputError it throws, or "" (and a test failure) if it throws none.
std::string refusal_of(const std::string& path);
/// Writes `bytes` as `name` and expects that reading is refused with the path first and every word after it.
void expect_refused(const TestFolder& folder, const std::string& name, const std::string& bytes,
                    const std::vector<std::string>& words);

/// Vertices bit by bit, cells and labels.
void expect_same_cells(const Mesh& mesh, const Mesh& expected);
void expect_same_facets(const Mesh& mesh, const Mesh& expected);

}  // namespace podm::verify
