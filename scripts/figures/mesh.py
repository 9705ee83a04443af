"""Tetrahedra of a .vtu file, and plane cuts through them."""
from dataclasses import dataclass

import numpy


class MeshError(Exception):
    """A mesh that cannot be read; the text names the file and the fault."""


@dataclass(frozen=True)
class Mesh:
    points: numpy.ndarray  # n x 3, mm
    cells: numpy.ndarray  # m x 4, indices of points
    labels: numpy.ndarray  # m


def read_vtu(path):
    """Needs Debian's python3-vtk9. Raises MeshError."""
    import vtk  # slow to load: only where a mesh is drawn
    from vtk.util.numpy_support import vtk_to_numpy

    vtk.vtkObject.GlobalWarningDisplayOff()  # failures are told in one line each
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    if grid.GetNumberOfCells() == 0 or not grid.GetCellData().HasArray("label"):
        raise MeshError(f"{path}: no cells with an array `label`")
    if set(vtk_to_numpy(grid.GetCellTypesArray())) != {vtk.VTK_TETRA}:
        raise MeshError(f"{path}: cells other than tetrahedra")
    return Mesh(vtk_to_numpy(grid.GetPoints().GetData()).astype(float),
                vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4),
                vtk_to_numpy(grid.GetCellData().GetArray("label")))


def plane_cut(points, cells, height):
    """Polygons (k x 4 x 2: x and y; triangles repeat their last corner) in which z = `height` cuts the cells, and the
    index of the cell of each. Vertices on the plane count as above it."""
    above = points[cells, 2] >= height
    triangles = _cut_by(points, cells, above, height, 1) + _cut_by(points, cells, ~above, height, 1)
    quads = _cut_by(points, cells, above, height, 2)
    polygons = numpy.concatenate([polygon for polygon, _ in triangles + quads])
    return polygons, numpy.concatenate([cell for _, cell in triangles + quads])


def _cut_by(points, cells, chosen, height, count):
    """Cells with `count` chosen vertices: the cut runs over the edges from these to the others."""
    found = numpy.flatnonzero(chosen.sum(axis=1) == count)
    if found.size == 0:
        return [(numpy.empty((0, 4, 2)), found)]
    order = numpy.argsort(~chosen[found], axis=1, kind="stable")  # chosen vertices first
    corners = points[numpy.take_along_axis(cells[found], order, axis=1)]
    # Around the cut, edges in turn share a vertex of the cell.
    edges = [(0, 1), (0, 2), (0, 3), (0, 3)] if count == 1 else [(0, 2), (0, 3), (1, 3), (1, 2)]
    polygon = [_cross(corners[:, a], corners[:, b], height) for a, b in edges]
    return [(numpy.stack(polygon, axis=1), found)]


def _cross(start, end, height):
    share = (height - start[:, 2]) / (end[:, 2] - start[:, 2])
    return start[:, :2] + share[:, None] * (end[:, :2] - start[:, :2])
