// A mesh as one HDF5 file of arrays, which many processes may write and read by ranges of rows, and an XDMF
// file that describes the arrays to solvers and viewers. This file declares the steps.
// distributed/write_pieces.h performs them on all ranks, and write_mesh() performs them for a whole mesh.
//
//   /points                  float64 (n, 3)
//   /cells, /facets          int32 (m, 4), (k, 3), vertices from 0; int64 if they do not fit
//   /cell_labels             int32 (m): the label's value; the row in /labels for all, if one does not fit
//   /labels/value, name      uint32, UTF-8: row by row, the background first
//   /facet_tags              int32 (k): 1 + the row in /pairs of the labels on the facet's two sides
//   /facet_labels            uint32 (k, 2): their values; the normal points out of the second, to the first
//   /pairs/labels, name      uint32 (p, 2), UTF-8 "liver|kidney"
//   /lines                   as /cells, (e, 2): the edges of lines, if the mesh has some
//   /line_tags               int32 (e): 1 + the row in /line_sets of the edge's line
//   /line_sets/name          UTF-8 "liver|kidney|outside"
//
// The grid "mesh" holds the cells and their labels, "facets" the facets and their tags, "lines" the edges of
// lines and their tags. DOLFINx reads them with XDMFFile.read_mesh(name="mesh"), read_meshtags(mesh,
// name="mesh"), read_meshtags(mesh, name="facets") and read_meshtags(mesh, name="lines").
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "files/temporary_file.h"
#include "io/label_table.h"
#include "io/shared_rows.h"
#include "podm/mesh_piece.h"

namespace podm {

/// A mesh or a piece of one, and the positions of its rows in the arrays of the whole mesh.
struct XdmfPart {
  explicit XdmfPart(const TetMesh& whole);
  explicit XdmfPart(const MeshPiece& piece);

  const TetMesh& mesh;
  const std::vector<std::uint64_t>* vertex_ids = nullptr;  ///< null: vertices keep their numbers
  const std::vector<std::uint8_t>* owns_vertex = nullptr;  ///< null: all vertices are written
  std::uint64_t first_cell = 0, first_facet = 0;
  std::uint64_t total_vertices, total_cells, total_facets;
};

/// The places of the arrays of the whole mesh. Meshes of several pieces have no lines.
struct XdmfArrays {
  RowsInFile points, cells, cell_labels, facets, facet_tags, facet_labels, lines, line_tags;
  std::optional<RowsInFile> facet_sides = {};  ///< if the box is flat
};

/// Returns "x.h5" for "x.xdmf".
std::string hdf5_path_of(const std::string& xdmf_path);

/// Makes the arrays of the whole mesh in `file`, a new one, and writes the tables of labels and of `pairs`,
/// which are the pairs of all pieces. Any part may be passed. Throws InputError that names `path`.
XdmfArrays create_xdmf_arrays(const std::string& file, const std::string& path, const XdmfPart& part,
                              const LabelPairs& pairs);
/// Writes the rows of a part. All parts may be written at once.
void write_xdmf_part(const std::string& file, const std::string& path, const XdmfPart& part,
                     const LabelPairs& pairs, const XdmfArrays& arrays);
/// Gives `arrays` its name and then makes the XDMF file.
void publish_xdmf(const std::string& path, const XdmfPart& part, TemporaryFile& arrays);

}  // namespace podm
