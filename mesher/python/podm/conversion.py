"""Conversion of a Mesh to objects of meshio and VTK, which are imported only here."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import meshio
    import vtk

    from .result import Mesh

_DEBIAN_PACKAGE_OF = {"meshio": "python3-meshio", "vtk": "python3-vtk9"}


def to_meshio(mesh: Mesh) -> meshio.Mesh:
    first, second = mesh.facet_labels.T
    return _package("meshio").Mesh(
        mesh.points, [("tetra", mesh.cells), ("triangle", mesh.facets)],
        cell_data={"label": [mesh.labels, second], "label_a": [mesh.labels, first], "label_b": [mesh.labels, second]},
        field_data={name: np.array([value, 3]) for value, name in mesh.names.items()})


def to_vtk(mesh: Mesh) -> vtk.vtkUnstructuredGrid:
    vtk = _package("vtk")
    grid = vtk.vtkUnstructuredGrid()
    grid.SetCells(vtk.VTK_TETRA, _cell_array(vtk, mesh.cells))
    _add_points_and_names(vtk, mesh, grid)
    grid.GetCellData().SetScalars(_array("label", mesh.labels))
    return grid


def facets_to_vtk(mesh: Mesh) -> vtk.vtkPolyData:
    vtk = _package("vtk")
    surface = vtk.vtkPolyData()
    surface.SetPolys(_cell_array(vtk, mesh.facets))
    _add_points_and_names(vtk, mesh, surface)
    for name, labels in zip(("label_a", "label_b"), mesh.facet_labels.T.copy()):
        surface.GetCellData().AddArray(_array(name, labels))
    return surface


def lines_to_vtk(mesh: Mesh) -> vtk.vtkPolyData:
    vtk = _package("vtk")
    lines = vtk.vtkPolyData()
    lines.SetLines(_cell_array(vtk, mesh.lines))
    _add_points_and_names(vtk, mesh, lines)
    lines.GetCellData().AddArray(_array("line", mesh.line_of_edge))
    return lines


def _package(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        raise ModuleNotFoundError(f"this conversion needs the Python package {name}, which is not installed: "
                                  f"pip install {name}, or Debian's {_DEBIAN_PACKAGE_OF[name]}", name=name) from None


def _array(name: str, values: npt.NDArray[Any]) -> Any:
    """Returns a VTK array that shares the memory of the values and keeps it alive."""
    from vtk.util.numpy_support import numpy_to_vtk
    array = numpy_to_vtk(values)
    array.SetName(name)
    return array


def _cell_array(vtk: Any, vertices: npt.NDArray[np.uint32]) -> Any:
    """Returns a copy of the vertices of each cell, facet or edge: VTK 9.1 keeps no other cells alive."""
    from vtk.util.numpy_support import numpy_to_vtk
    offsets = np.arange(0, vertices.size + 1, vertices.shape[1], dtype=np.int32)
    cells = vtk.vtkCellArray()
    cells.SetData(*(numpy_to_vtk(array, deep=True) for array in (offsets, vertices.view(np.int32).ravel())))
    return cells


def _add_points_and_names(vtk: Any, mesh: Mesh, grid: Any) -> None:
    """Adds the points, and names and space as field data, as in the .vtu files of podm."""
    grid.SetPoints(vtk.vtkPoints())
    grid.GetPoints().SetData(_array("Points", mesh.points))
    values = {f"space:{mesh.space}": 1, "label:outside": mesh.background}
    values |= {f"label:{name}": value for value, name in mesh.names.items()}
    for name, value in values.items():
        grid.GetFieldData().AddArray(_array(name, np.array([value], dtype=np.uint32)))
