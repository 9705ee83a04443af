// Mesh files: VTU, legacy VTK, XDMF, Medit, Gmsh, Abaqus, Exodus II, TetGen; surfaces as STL or PLY. No file
// appears unless it is complete.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "podm/choices.h"
#include "podm/option.h"
#include "podm/tet_mesh.h"

namespace podm {

/// Puts the mesh into its canonical order. Two runs that made the same mesh then agree byte by byte. Vertices
/// are sorted by (x, y, z), and -0 becomes 0. Each cell is permuted evenly and each facet is rotated to start
/// at its smallest vertex. The other three vertices of a cell ascend; the last two are swapped where
/// orientation requires it. Cells, facets and edges of lines are sorted by their vertices, lines by their
/// labels. Takes about 26 bytes per cell in
/// addition to the mesh. `threads`: 0 for all cores; the order is the same for any number.
void canonicalize(TetMesh& mesh, int threads = 0);

/// Returns the lower-case hexadecimal SHA-256 of a canonical mesh, over these little-endian bytes:
///   uint64   numbers of vertices, of cells, of facets
///   float64  x, y, z of every vertex
///   uint32   four vertices of every cell
///   uint32   label value of every cell
///   uint32   three vertices of every facet
///   uint32   two label values of every facet, in the order of TetMesh::facet_labels
/// Label names, lines and the space are not hashed.
std::string mesh_sha256(const TetMesh& mesh);

/// Returns a hash that does not depend on the order of cells and facets. Hashes of the pieces of a
/// distributed mesh add up to the hash of the whole, modulo 2^64. The hash is the sum over all cells and
/// facets of hashes of their vertices' coordinates, orientation and label values. (A multiset hash: Clarke,
/// Devadas, van Dijk, Gassend, Suh, ASIACRYPT 2003. This one detects faults; it does not resist forgery.)
/// Takes 8 bytes per vertex while it runs. `threads`: 0 for all cores; the hash is the same for any number.
std::uint64_t mesh_hash(const TetMesh& mesh, int threads = 0);
/// Returns the hash as 16 hexadecimal digits.
std::string mesh_hash_text(std::uint64_t hash);

struct MeshFileOptions {
  std::optional<GmshVersion> gmsh_version = {};  ///< for .msh alone; none: 4.1

  static constexpr auto options() {
    return std::tuple{option(&MeshFileOptions::gmsh_version, "gmsh-version", "", OptionGroup::kOutput,
                             "version of a .msh file; FreeFem++ and SfePy read 2.2",
                             {.unset = "4.1", .uses = kInPodm})};
  }
};

/// Throws InputError if the extension of `path` is not one of those of write_mesh(), if `options` do not
/// apply to the format, or if the file cannot be written.
void check_mesh_path(const std::string& path, const MeshFileOptions& options = {});
void check_surface_path(const std::string& path);  ///< accepts .stl and .ply
bool is_surface_path(const std::string& path);     ///< true for these

/// Writes the mesh in the format of the extension. Field data, comments or information records hold
/// promises_of() and the space. Returns a sentence for each property of the mesh that the file cannot hold
/// exactly, and for <stem>_lines.vtu if another mesh left it beside one without lines. Throws InputError that
/// names the file and the fault; in that case nothing is written and existing files stay untouched.
///   .vtu   the cells, with the cell array `label` (label values), and in <stem>_facets.vtu beside it the
///          facets, with the cell arrays `label_a`, `label_b` (facet_labels as values, the background's for
///          outside; the normal points from b to a) and the point array `vertex` (position among all
///          vertices). If lines were asked for, <stem>_lines.vtu has their edges, with the cell array `line`,
///          the point array `vertex` and field data "line:liver|kidney|outside", which holds the line. Field
///          data of all: arrays "space:RAS" and "label:liver", which holds the value.
///   .vtk   the same as two files of legacy VTK; array names are percent-encoded as VTK does.
///   .mesh  a tetrahedron's reference is its label value; a triangle's numbers the unordered label pair.
///          Comments give the labels and the pairs. Coordinates read back to the same doubles, as in all text
///          formats except .inp.
///   .msh   physical volumes by label value, named "kidney" or "label 3"; physical surfaces by label
///          pair, named "kidney|outside" or "liver|kidney".
///   .xdmf  two grids of arrays in <stem>.h5 beside it: "mesh", the cells with their label values, and
///          "facets", the facets with one tag per label pair, both named in the tables /labels and /pairs.
///   .inp   Abaqus: element sets named after labels, surfaces of elements after pairs, "liver-kidney"; '_'
///          replaces characters that such names cannot hold; reals have at most 20 characters.
///   .e .exo  Exodus II: element blocks by label value and side sets by pair, with the names of .msh.
///   .node .ele  TetGen: both and .face; the attribute of a tetrahedron is its label value, the marker of a
///          face numbers the pair, and comments name the labels and pairs.
std::vector<std::string> write_mesh(const TetMesh& mesh, const std::string& path,
                                    const MeshFileOptions& options = {});

/// Writes the closed, outward oriented surface of every label that has one: "s.stl" becomes
/// s_<value>[_<name>].stl. STL holds single precision, PLY doubles. Throws as write_mesh does.
void write_surfaces(const TetMesh& mesh, const std::string& path);

}  // namespace podm
