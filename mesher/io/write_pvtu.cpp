// VTK's index of pieces: the arrays that all pieces have, and the path of each piece relative to the index.
#include "io/write_pvtu.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include "files/temporary_name.h"
#include "io/write_vtu.h"
#include "io/xml_text.h"

namespace podm {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPiece = "<Piece Source=\"";

std::string piece_path(const std::string& index_path, int rank) {
  const fs::path index(index_path);
  return (index.parent_path() / fmt::format("{}_{}.vtu", index.stem().string(), rank)).string();
}

std::string array(const char* type, const char* name, int components) {
  return fmt::format("<PDataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"/>\n", type, name,
                     components);
}

std::string index_text(const std::string& cell_arrays, const std::vector<std::string>& pieces) {
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PUnstructuredGrid GhostLevel=\"0\">\n"
      "<PPointData "
      "GlobalIds=\"{}\">\n{}</PPointData>\n<PCellData>\n{}</PCellData>\n<PPoints>\n{}</PPoints>\n",
      kGlobalIds, array("Int64", kGlobalIds, 1), cell_arrays, array("Float64", "Points", 3));
  for (const std::string& piece : pieces)
    text += fmt::format("{}{}\"/>\n", kPiece, xml_escaped(fs::path(piece).filename().string()));
  return text + "</PUnstructuredGrid>\n</VTKFile>\n";
}

std::string index_of_cells(const std::string& path, int num_pieces) {
  std::vector<std::string> pieces;
  for (int rank = 0; rank < num_pieces; ++rank) pieces.push_back(piece_path(path, rank));
  return index_text(array("UInt32", "label", 1), pieces);
}

std::string index_of_facets(const std::string& path, int num_pieces) {
  std::vector<std::string> pieces;
  for (int rank = 0; rank < num_pieces; ++rank) pieces.push_back(facets_path_of(piece_path(path, rank)));
  return index_text(array("UInt32", "label_a", 1) + array("UInt32", "label_b", 1), pieces);
}

// True for x_7.vtu and x_7_facets.vtu, if the index is x.pvtu.
bool is_piece(const std::string& path, const std::string& index_path) {
  const std::string name = fs::path(path).filename().string(),
                    prefix = fs::path(index_path).stem().string() + "_";
  if (!name.starts_with(prefix)) return false;
  const std::size_t end = name.find_first_not_of("0123456789", prefix.size());
  if (end == prefix.size() || end == std::string::npos) return false;
  const std::string rest = name.substr(end);
  return rest == ".vtu" || rest == "_facets.vtu";
}

void remove_old(const std::string& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) fail_to_write(path, error.value());
}

// While pieces are published there is no index. This file lists them, so that a later run can remove the
// pieces of a run that was killed meanwhile.
std::string unfinished_path(const std::string& index_path) { return index_path + ".unfinished"; }

// Returns the number of pieces that a file lists; 0 if it does not exist or is not one of podm's indices.
int pieces_in(const std::string& file_path, const std::string& index_path) {
  std::ifstream file(file_path, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  int num_pieces = 0;
  for (std::size_t at = text.find(kPiece); at != std::string::npos; at = text.find(kPiece, at + 1))
    ++num_pieces;
  return text == index_of_cells(index_path, num_pieces) ? num_pieces : 0;
}

}  // namespace

std::deque<AtomicFile> write_pvtu_piece(const MeshPiece& piece, const std::string& index_path) {
  return write_vtu_aside(piece.mesh, &piece.vertex_ids, piece_path(index_path, piece.rank));
}

int withdraw_pvtu_index(const std::string& path, int num_pieces) {
  const int num_earlier_pieces = std::max(pieces_in(path, path), pieces_in(unfinished_path(path), path));
  AtomicFile unfinished(unfinished_path(path));
  unfinished.write(index_of_cells(path, std::max(num_pieces, num_earlier_pieces)));
  unfinished.publish();
  remove_old(path);
  remove_old(facets_path_of(path));
  return num_earlier_pieces;
}

void write_pvtu_index(const std::string& path, int num_pieces, int num_earlier_pieces) {
  std::deque<AtomicFile> files;
  files.emplace_back(path);
  files.back().write(index_of_cells(path, num_pieces));
  files.emplace_back(facets_path_of(path));
  files.back().write(index_of_facets(path, num_pieces));
  publish_together(files);
  for (int rank = num_pieces; rank < num_earlier_pieces; ++rank) {
    remove_old(piece_path(path, rank));
    remove_old(facets_path_of(piece_path(path, rank)));
  }
  remove_old_temporaries(folder_of(path), [&](const std::string& target) { return is_piece(target, path); });
  remove_old(unfinished_path(path));
}

}  // namespace podm
