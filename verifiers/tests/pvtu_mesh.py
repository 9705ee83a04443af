"""A mesh in pieces, as PVTU indexes and ascii VTU files. It is made of a MeditMesh; the tests change and write it."""

import copy

import numpy as np

PROMISE = "# promise "
HEAD = '<?xml version="1.0"?>\n<VTKFile type="{}" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'


class Piece:
    """points (n,3), their global ids (n,), cells (m,5) and facets (k,3 or 5) of the piece's points, then labels."""

    def __init__(self, mesh, cells, facets, others=()):
        """The piece also has the vertices `others`. An id that names no vertex names no point of the piece."""
        used = np.unique(np.concatenate([cells[:, :4].ravel(), facets[:, :3].ravel(), others])).astype(np.int64)
        used = used[(used >= 0) & (used < len(mesh.vertices))]
        self.ids = used
        self.points = mesh.vertices[used]
        self.cells, self.facets = cells.copy(), facets.copy()
        for rows, corners in (self.cells, 4), (self.facets, 3):
            places = np.searchsorted(used, rows[:, :corners])
            rows[:, :corners] = np.where(np.isin(rows[:, :corners], used), places, len(used) + 7)
        self.field = {"space:RAS": 1, **{f"promise:{line[len(PROMISE):].strip()}": 1 for line in mesh.comments
                                         if line.startswith(PROMISE)}}

    def vtu(self, rows, corners, vtk_type, labels, ids="GlobalNodeIds"):
        """Returns VTU text of all points and the cells in `rows`; columns after the corners are named cell arrays."""
        def array(name, kind, values, components=1):
            # repr() of a numpy number is more than its digits.
            text = " ".join(repr(value) for value in np.asarray(values).ravel().tolist())
            return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="ascii">\n'
                    f"{text}\n</DataArray>\n")

        field = "".join(array(name, "UInt32", [value]) for name, value in self.field.items())
        cell_data = "".join(array(name, "UInt32", rows[:, corners + k]) for k, name in enumerate(labels))
        cells = (array("connectivity", "Int64", rows[:, :corners]) +
                 array("offsets", "Int64", corners * (np.arange(len(rows)) + 1)) +
                 array("types", "UInt8", np.full(len(rows), vtk_type)))
        return (HEAD.format("UnstructuredGrid") + f"<UnstructuredGrid>\n<FieldData>\n{field}</FieldData>\n"
                f'<Piece NumberOfPoints="{len(self.points)}" NumberOfCells="{len(rows)}">\n'
                f"<PointData>\n{array(ids, 'Int64', self.ids)}</PointData>\n<CellData>\n{cell_data}</CellData>\n"
                f"<Points>\n{array('Points', 'Float64', self.points, 3)}</Points>\n<Cells>\n{cells}</Cells>\n"
                "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n")


class MeshInPieces:
    """A mesh in pieces. write() writes `pieces` as x_0.vtu etc. beside the index x.pvtu, and the facets likewise."""
    extension = ".pvtu"

    def __init__(self, mesh, num_pieces):
        """Distributes cells by the x of their first vertex; a facet goes with a cell that it is a side of. The last
        piece has the vertices that no cell uses. Facets have labels if the mesh states pairs.
        """
        pairs = label_pairs(mesh)
        order = np.argsort(mesh.vertices[np.clip(mesh.cells[:, 0], 0, len(mesh.vertices) - 1), 0], kind="stable") \
            if len(mesh.cells) > 0 else np.array([], dtype=np.int64)
        piece_of_cell = np.empty(len(order), dtype=np.int64)
        piece_of_cell[order] = np.arange(len(order)) * num_pieces // max(len(order), 1)
        piece_of_side = {tuple(sorted(np.delete(cell, k))): piece_of_cell[c]
                         for c, cell in enumerate(mesh.cells[:, :4]) for k in range(4)}
        piece_of_facet = np.array([piece_of_side.get(tuple(sorted(facet[:3])), 0) for facet in mesh.facets],
                                  dtype=np.int64)
        facets = (np.array([[*facet[:3], *pairs[facet[3]]] for facet in mesh.facets], dtype=np.int64).reshape(-1, 5)
                  if pairs else mesh.facets[:, :3])
        unused = np.setdiff1d(np.arange(len(mesh.vertices)), mesh.cells[:, :4])
        self.pieces = [Piece(mesh, mesh.cells[piece_of_cell == p], facets[piece_of_facet == p],
                             unused if p == num_pieces - 1 else ())
                       for p in range(num_pieces)]
        self.index = list(range(num_pieces))  # the pieces that the index names

    def copy(self):
        return copy.deepcopy(self)

    def shared_id(self):
        """Returns a vertex that is in the first two pieces."""
        return np.intersect1d(self.pieces[0].ids, self.pieces[1].ids)[0]

    def write(self, path, _digits=17):
        kinds = (("", lambda piece: piece.vtu(piece.cells, 4, 10, ["label"])),
                 ("_facets", lambda piece: piece.vtu(piece.facets, 3, 5,
                                                     ["label_a", "label_b"][:piece.facets.shape[1] - 3])))
        for ending, text in kinds:
            for p, piece in enumerate(self.pieces):
                path.with_name(f"{path.stem}_{p}{ending}.vtu").write_text(text(piece))
            sources = "".join(f'<Piece Source="{path.stem}_{p}{ending}.vtu"/>\n' for p in self.index)
            path.with_name(f"{path.stem}{ending}.pvtu").write_text(
                HEAD.format("PUnstructuredGrid") + f'<PUnstructuredGrid GhostLevel="0">\n{sources}'
                "</PUnstructuredGrid>\n</VTKFile>\n")


def label_pairs(mesh):
    """Returns the labels on the two sides of a facet by its reference, from podm's comments."""
    rows = [line.split() for line in mesh.comments if line.startswith("# pair ")]
    return {int(row[2]): (int(row[3]), int(row[4])) for row in rows}
