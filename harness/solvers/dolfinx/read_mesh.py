"""Reads the tetrahedra of a mesh file, of podm or of a peer."""
import contextlib
import io
import os
import pathlib

import meshio
import numpy as np
import vtk
from vtkmodules.util.numpy_support import vtk_to_numpy

TETRAHEDRON = "tetra"
# The names of the formats in meshio. It cannot read a .vtu file with raw appended data, which podm writes.
FORMATS = {".msh": "gmsh", ".mesh": "medit", ".ele": "tetgen"}
VTU = ".vtu"


class MeshError(Exception):
    """A file has no mesh to solve on. The text names the fault, not the file."""


def read_mesh(path):
    """Returns points, float64 of shape (n, 3) in mm, and cells, int64 of shape (m, 4), indices of points.

    Points without a cell are left out. Raises MeshError."""
    if not os.path.isfile(path):
        raise MeshError("no such file")
    extension = pathlib.Path(path).suffix
    if extension != VTU and extension not in FORMATS:
        raise MeshError(f"ends with none of {', '.join([VTU, *FORMATS])}")
    points, cells = _read_vtu(path) if extension == VTU else _read_by_meshio(path, FORMATS[extension])
    _check(points, cells)
    used, cells = np.unique(cells, return_inverse=True)
    return points[used], cells.reshape(-1, 4)


def _read_vtu(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    faults = []
    observer = lambda *_: faults.append(path)
    reader.AddObserver("ErrorEvent", observer)
    parser_messages = vtk.vtkStringOutputWindow()  # the only output of its parser
    vtk.vtkOutputWindow.SetInstance(parser_messages)
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    if faults or parser_messages.GetOutput() or grid.GetPoints() is None:
        raise MeshError("VTK cannot read it as an unstructured grid")
    types = vtk_to_numpy(grid.GetCellTypesArray()) if grid.GetNumberOfCells() else np.empty(0, int)
    starts = vtk_to_numpy(grid.GetCells().GetOffsetsArray())[:-1][types == vtk.VTK_TETRA]
    connectivity = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    return vtk_to_numpy(grid.GetPoints().GetData()), connectivity[starts[:, None] + np.arange(4)]


def _read_by_meshio(path, file_format):
    messages = io.StringIO()  # meshio prints messages
    try:
        with contextlib.redirect_stdout(messages), contextlib.redirect_stderr(messages):
            mesh = meshio.read(path, file_format)
    except (Exception, SystemExit) as error:  # pylint: disable=broad-except  # a broken file may raise any of them
        why = " ".join([*messages.getvalue().split(), str(error)])
        raise MeshError(f"meshio cannot read it as {file_format}: {type(error).__name__}: {why}") from None
    blocks = [block.data for block in mesh.cells if block.type == TETRAHEDRON]
    return mesh.points, np.concatenate(blocks) if blocks else np.empty((0, 4), int)


def _check(points, cells):
    if points.ndim != 2 or points.shape[1] != 3:
        raise MeshError("its points have no three coordinates")
    if not len(cells):
        raise MeshError("it has no tetrahedra")
    if cells.min() < 0 or cells.max() >= len(points):
        bad = int(np.argmax(((cells < 0) | (cells >= len(points))).any(axis=1)))
        raise MeshError(f"cell {bad} names a point that the mesh of {len(points)} points lacks")
    corners = points[cells]
    if not np.isfinite(corners).all():
        bad = int(np.argmax(~np.isfinite(corners).all(axis=(1, 2))))
        raise MeshError(f"cell {bad} has a coordinate that is not finite")
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1])
    if not volumes.all():
        raise MeshError(f"cell {int(np.argmax(volumes == 0))} is flat")
