// Mesh files: VTU, legacy VTK, XDMF, Medit, Gmsh, Abaqus, Exodus II, TetGen; surfaces as STL or PLY. Files
// appear whole or not at all.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "podm/choices.h"
#include "podm/tet_mesh.h"

namespace podm {

/// Brings the mesh into its canonical order, so that two runs that made the same mesh agree byte by byte:
/// vertices sorted by (x, y, z), -0 as 0; each cell permuted evenly and each facet rotated to start at its
/// smallest vertex (a cell's other three ascend, the last two swapped where orientation asks); cells and
/// facets sorted by their vertices. Takes about 26 bytes a cell beside the mesh while it runs. `threads`: 0
/// for all cores; the order is the same for any number.
void canonicalize(TetMesh& mesh, int threads = 0);

/// Lower-case hexadecimal SHA-256 of a canonical mesh, over these little-endian bytes:
///   uint64   numbers of vertices, of cells, of facets
///   float64  x, y, z of every vertex
///   uint32   four vertices of every cell
///   uint32   label value of every cell
///   uint32   three vertices of every facet
///   uint32   two label values of every facet, in the order of TetMesh::facet_labels
/// Label names and the space have no part in it.
std::string mesh_sha256(const TetMesh& mesh);

/// A hash that needs no order, and adds up, modulo 2^64, over the pieces of a mesh that nobody has whole: the
/// sum over all cells and facets of hashes of their vertices' coordinates, orientation and label values. (A
/// multiset hash: Clarke, Devadas, van Dijk, Gassend, Suh, ASIACRYPT 2003; ours finds faults, not forgers.)
/// Takes 8 bytes a vertex while it runs. `threads`: 0 for all cores; the hash is the same for any number.
std::uint64_t mesh_hash(const TetMesh& mesh, int threads = 0);
/// 16 hexadecimal digits.
std::string mesh_hash_text(std::uint64_t hash);

struct MeshFileOptions {
  std::optional<GmshVersion> gmsh_version = {};  ///< for .msh alone; none: 4.1

  static constexpr auto options() {
    return std::tuple{option(&MeshFileOptions::gmsh_version,
                             {.name = "gmsh-version",
                              .group = OptionGroup::kOutput,
                              .help = "version of a .msh file; FreeFem++ and SfePy read 2.2",
                              .unset = "4.1",
                              .uses = kInPodm})};
  }
};

/// Throws InputError if `path` has no known mesh extension (those of write_mesh()), one that `options` are
/// not for, or cannot be written.
void check_mesh_path(const std::string& path, const MeshFileOptions& options = {});
void check_surface_path(const std::string& path);  ///< .stl .ply

/// Writes the mesh in the format of the extension, with promises_of() it in field data, comments or
/// information, where the space stands too. Returns a sentence for each thing that the file does not hold as
/// the mesh has it. Throws InputError naming the file and the fault; then nothing has been written, and files
/// that were there before are untouched.
///   .vtu   the cells, with the cell array `label` (label values), and in <stem>_facets.vtu beside it the
///          facets, with the cell arrays `label_a`, `label_b` (facet_labels as values, the background's for
///          outside; the normal points from b to a) and the point array `vertex` (position among all
///          vertices). Field data of both: arrays "space:RAS" and "label:liver", which holds the value.
///   .vtk   the same as two files of legacy VTK, names of arrays in VTK's percent code.
///   .mesh  a tetrahedron's reference is its label value; a triangle's numbers the unordered label pair.
///          Comments give the labels and the pairs. Coordinates read back to the same doubles, as in all text
///          but .inp.
///   .msh   physical volumes by label value, named "kidney" or "label 3"; physical surfaces by label
///          pair, named "kidney|outside" or "liver|kidney".
///   .xdmf  two grids of arrays in <stem>.h5 beside it: "mesh", the cells with their label values, and
///          "facets", the facets with a tag a label pair, both named in the tables /labels and /pairs.
///   .inp   Abaqus: element sets named after labels, surfaces of elements after pairs, "liver-kidney", with
///          '_' for what such names cannot hold; reals of at most 20 characters.
///   .e .exo  Exodus II: element blocks by label value and side sets by pair, with the names that .msh has.
///   .node .ele  TetGen: both and .face; the attribute of a tetrahedron is its label value, the marker of a
///          face numbers the pair, and comments name them.
std::vector<std::string> write_mesh(const TetMesh& mesh, const std::string& path,
                                    const MeshFileOptions& options = {});

/// Writes the closed, outward oriented surface of every label that has one: "s.stl" becomes
/// s_<value>[_<name>].stl. STL holds single precision, PLY doubles. Throws as write_mesh does.
void write_surfaces(const TetMesh& mesh, const std::string& path);

}  // namespace podm
