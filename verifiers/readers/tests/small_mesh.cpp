#include "readers/tests/small_mesh.h"

#include <zlib.h>

#include <fstream>
#include <sstream>

#include "errors.h"
#include "readers/read_mesh.h"

namespace podm::verify {

Mesh make_small_mesh() {
  Mesh mesh;
  mesh.vertices = {{0.1f, 0, -0.0},     {1, 1e-30f, 0},   {0.25f, 1, 0},
                   {0, 0.3f, 16777216}, {1.5f, 1e20f, 1}, {-1.0f / 3, 2, -2}};
  mesh.cells = {{0, 1, 2, 3}, {1, 2, 3, 4}, {5, 2, 1, 0}};
  mesh.cell_labels = {7, 2, 7};
  mesh.facets = {{0, 1, 2}, {3, 4, 1}};
  return mesh;
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string read_bytes(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

std::string gzipped(const std::string& bytes) {
  z_stream stream{};
  constexpr int kGzip = 16 + MAX_WBITS;
  deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

std::string refusal_of(const std::string& path) {
  try {
    read_mesh(path);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << path << " was read";
  return "";
}

void expect_refused(const TestFolder& folder, const std::string& name, const std::string& bytes,
                    const std::vector<std::string>& words) {
  const std::string path = folder / name;
  write_bytes(path, bytes);
  const std::string message = refusal_of(path);
  EXPECT_TRUE(message.starts_with(path + ": ")) << message;
  for (const std::string& word : words)
    EXPECT_NE(message.find(word), std::string::npos) << "no '" << word << "' in: " << message;
}

void expect_same_cells(const Mesh& mesh, const Mesh& expected) {
  ASSERT_EQ(mesh.vertices.size(), expected.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(mesh.vertices[i][axis], expected.vertices[i][axis]) << "vertex " << i;
  EXPECT_EQ(mesh.cells, expected.cells);
  EXPECT_EQ(mesh.cell_labels, expected.cell_labels);
}

void expect_same_facets(const Mesh& mesh, const Mesh& expected) {
  EXPECT_EQ(mesh.facets, expected.facets);
  EXPECT_EQ(mesh.facet_labels, expected.facet_labels);
}

}  // namespace podm::verify
