// A small mesh to write and read back, and comparisons of two meshes.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <string>

#include "mesh.h"

namespace podm::verify {

/// A temporary folder per test, removed with its content.
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

/// Returns three tetrahedra of two labels and two triangles. All coordinates are floats, so any type holds
/// them.
Mesh make_small_mesh();

void write_bytes(const std::string& path, const std::string& bytes);
std::string read_bytes(const std::string& path);
std::string gzipped(const std::string& bytes);

/// Reads `path`. Returns the message of the InputError that it throws, or "" (and a test failure) if none.
std::string refusal_of(const std::string& path);
/// Writes `bytes` as `name` and expects a refusal whose message has the path first and every word after it.
void expect_refused(const TestFolder& folder, const std::string& name, const std::string& bytes,
                    const std::vector<std::string>& words);

/// Compares vertices bit by bit, cells and labels.
void expect_same_cells(const Mesh& mesh, const Mesh& expected);
void expect_same_facets(const Mesh& mesh, const Mesh& expected);

}  // namespace podm::verify
