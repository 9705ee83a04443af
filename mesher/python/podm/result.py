"""podm.Mesh, the result of podm.mesh."""

from __future__ import annotations

import functools
import json
import os
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _podm, conversion, verification
from .checks import path_bytes
from .verification import Verification

if TYPE_CHECKING:
    import meshio
    import vtk


class Mesh:
    """A tetrahedral mesh with labels.

    Its arrays are read-only. `points`, `cells`, `facets` and `lines` are views of the mesher's memory and keep it
    alive; `labels` and `facet_labels` are made once, at the first access. Points, cells and facets are in the canonical
    order of the program, so that the same mesh has the same arrays.
    """

    def __init__(self, made: _podm.MeshInMemory) -> None:
        """Not for users: podm.mesh makes meshes."""
        self._made = made

    @property
    def points(self) -> npt.NDArray[np.float64]:
        """Coordinates of the vertices in mm (in the frame `space`), shape (n, 3)."""
        return self._made.points

    @property
    def cells(self) -> npt.NDArray[np.uint32]:
        """The four vertices of each cell, as positions in `points`, shape (m, 4).

        For a cell (a, b, c, d) the determinant of (b - a, c - a, d - a) is positive."""
        return self._made.cells

    @functools.cached_property
    def labels(self) -> npt.NDArray[np.uint32]:
        """The label of each cell, a value of the image, shape (m,)."""
        return self._values_of(self._made.label_of_cell)

    @property
    def facets(self) -> npt.NDArray[np.uint32]:
        """The three vertices of each boundary or interface facet, as positions in `points`, shape (k, 3).

        The normal, by the right-hand rule, points out of the facet's second label, towards its first."""
        return self._made.facets

    @functools.cached_property
    def facet_labels(self) -> npt.NDArray[np.uint32]:
        """The labels on both sides of each facet, values of the image, shape (k, 2).

        The first is the background's where the outside is on that side."""
        return self._values_of(self._made.labels_of_facet)

    @property
    def lines(self) -> npt.NDArray[np.uint32]:
        """The two vertices of each edge where three or more labels meet, as positions in `points`, shape (e, 2).

        Empty unless the mesh was made with `lines=True`."""
        return self._made.edges_of_lines

    @property
    def line_of_edge(self) -> npt.NDArray[np.uint32]:
        """The line of each row of `lines`, as a position in `line_labels`, shape (e,)."""
        return self._made.line_of_edge

    @functools.cached_property
    def line_labels(self) -> list[tuple[int, ...]]:
        """The labels that meet along each line, values of the image. The first is the background's where the outside
        is one of them.

        A line is the set of all edges along which the same labels meet."""
        values = [value for value, _ in self._made.labels]
        return [tuple(values[label] for label in labels) for labels in self._made.labels_of_lines]

    @functools.cached_property
    def names(self) -> dict[int, str]:
        """The name of each label by its value, "label 3" for a label without a name; without the background."""
        return dict(self._made.labels[1:])

    @functools.cached_property
    def colours(self) -> dict[int, tuple[int, int, int]]:
        """The colour of each label that has one, by its value: red, green and blue from 0 to 255.

        They come from the file of names, or from the image, a segmentation of 3D Slicer (.seg.nrrd)."""
        return self._made.colours

    @property
    def background(self) -> int:
        """The value of the background in the image."""
        return self._made.labels[0][0]

    @property
    def space(self) -> str:
        """The frame of `points`: "RAS" or "LPS", mm, or "voxel", indices."""
        return self._made.space

    @property
    def stop_reason(self) -> str:
        """"complete", or the reason why the run ended early: "time limit", "element limit", "memory limit",
        "cancelled", "limit of 2^30 cells in the store"."""
        return self._made.stop_reason

    @property
    def is_complete(self) -> bool:
        """True if the run was not ended early."""
        return self.stop_reason == "complete"

    @property
    def unmet(self) -> list[str]:
        """A sentence for each guarantee that is missed and each limit that was met; empty for a complete mesh."""
        return self._made.unmet

    @functools.cached_property
    def record(self) -> dict[str, Any]:
        """The record of the run, as `podm mesh --record` writes it: options, times, counts, quality, hashes."""
        return json.loads(self._made.record())

    def quality(self) -> dict[str, npt.NDArray[np.float64]]:
        """Returns the quality of each cell: arrays of shape (m,).

        "radius_edge" (circumradius over shortest edge), "circumradius" (mm), "min_dihedral_deg", "max_dihedral_deg" and
        "volume" (mm^3). They are measured on `points`: in the space "voxel" in units of voxels. The extremes of all
        cells and facets in mm are in record["quality"]."""
        return self._made.qualities()

    def verify(self, *, fidelity: bool = False) -> Verification:
        """Runs podm-verify, a program that shares no code with the mesher, to check the promises of this mesh.

        It gets mesh and image as temporary files. `fidelity`: also checks that the surfaces of mesh and image are
        within a voxel or 2 delta of each other; a mesh much coarser than a structure may fail this check."""
        return verification.verify(self, self._made, fidelity)

    def save(self, path: str | os.PathLike[str], *, gmsh_version: str | float | None = None) -> None:
        """Writes the mesh, in the format of the name's extension: those of `podm mesh --output`.

        The file is written completely or not at all; podm.Error names the fault. Properties that the format cannot
        hold, such as characters of names in .inp, are reported by warnings.warn(). `gmsh_version` is for .msh files
        only: "4.1" or "2.2", as `podm mesh --gmsh-version`; None means the program's default."""
        for loss in self._made.save(path_bytes("path", path), gmsh_version):
            warnings.warn(f"{os.fsdecode(path)}: {loss}", stacklevel=2)

    def save_surfaces(self, path: str | os.PathLike[str]) -> None:
        """Writes the closed surface of each label as .stl or .ply: "s.stl" becomes s_VALUE[_NAME].stl."""
        self._made.save_surfaces(path_bytes("path", path))

    def to_meshio(self) -> meshio.Mesh:
        """Returns a meshio.Mesh with a block of cells and a block of facets. Needs the package meshio.

        Cell data: "label" of cells (the second label of facets), "label_a" and "label_b" of facets (a cell has its own
        label on both sides). Field data: for each name of a label [value, 3], as meshio has it for Gmsh's groups."""
        return conversion.to_meshio(self)

    def to_vtk(self) -> vtk.vtkUnstructuredGrid:
        """Returns a vtkUnstructuredGrid of the cells, with the cell array `label`. Needs the package vtk.

        For PyVista: pyvista.wrap(mesh.to_vtk()). Field data has the names of labels, as in the .vtu files of podm: an
        array "label:liver" holds the value of the liver. Points and labels share the memory of this mesh; cells are a
        copy."""
        return conversion.to_vtk(self)

    def facets_to_vtk(self) -> vtk.vtkPolyData:
        """Returns a vtkPolyData of the facets, with the cell arrays `label_a` and `label_b`. Needs the package vtk.

        It has all points of the mesh, and the field data of to_vtk()."""
        return conversion.facets_to_vtk(self)

    def lines_to_vtk(self) -> vtk.vtkPolyData:
        """Returns a vtkPolyData of the edges in `lines`, with the cell array `line`. Needs the package vtk.

        It has all points of the mesh, and the field data of to_vtk()."""
        return conversion.lines_to_vtk(self)

    def _values_of(self, labels: npt.NDArray[np.uint16]) -> npt.NDArray[np.uint32]:
        """Returns the image's values of labels that the mesher has numbered, read-only."""
        values = np.array([value for value, _ in self._made.labels], dtype=np.uint32)[labels]
        values.setflags(write=False)
        return values

    def __repr__(self) -> str:
        names = list(self.names.values())
        listed = ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")
        state = "" if self.is_complete else f", ended early: {self.stop_reason}"
        return (f"<podm.Mesh: {len(self.cells)} cells, {len(self.points)} points, {len(self.facets)} facets; {listed}"
                f"{state}>")

    def __str__(self) -> str:
        """Returns the summary of the run, as the program prints it."""
        return self._made.summary()
