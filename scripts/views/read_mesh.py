"""Reads tetrahedra, their labels, and the labels' names and colours from VTK's mesh files. podm converts other formats
to these."""
from pathlib import Path

import numpy

from .mesh import Mesh, MeshError


def read_mesh(path):
    """Reads a mesh file. Raises MeshError."""
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise MeshError(f"{path}: not a mesh file that can be shown; convert it to one of {', '.join(READERS)}")
    try:
        with open(path, "rb"):
            pass
        mesh = reader(path)
    except OSError as error:
        raise MeshError(f"{path}: {error.strerror}") from None
    if len(mesh.cells) == 0:
        raise MeshError(f"{path}: no tetrahedra")
    if mesh.cells.min() < 0 or mesh.cells.max() >= len(mesh.points):
        raise MeshError(f"{path}: a tetrahedron has a vertex that does not exist")
    if not numpy.isfinite(mesh.points).all():
        raise MeshError(f"{path}: a coordinate is not finite")
    return mesh


def _read_vtk(path):
    """Reads a file by VTK. Needs Debian's python3-vtk9."""
    import vtk  # slow to load, therefore only if a mesh is drawn
    from vtk.util.numpy_support import vtk_to_numpy

    kinds = {".vtu": vtk.vtkXMLUnstructuredGridReader, ".pvtu": vtk.vtkXMLPUnstructuredGridReader,
             ".vtk": vtk.vtkUnstructuredGridReader}
    vtk.vtkObject.GlobalWarningDisplayOff()  # each failure is reported in one line instead
    reader = kinds[path.suffix.lower()]()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    if grid.GetNumberOfCells() == 0 or not grid.GetCellData().HasArray("label"):
        raise MeshError(f"{path}: no cells with an array `label`")
    if set(vtk_to_numpy(grid.GetCellTypesArray())) != {vtk.VTK_TETRA}:
        raise MeshError(f"{path}: cells other than tetrahedra")
    return Mesh(vtk_to_numpy(grid.GetPoints().GetData()).astype(float),
                vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4),
                vtk_to_numpy(grid.GetCellData().GetArray("label")), _names_of_fields(grid.GetFieldData()),
                _colours_of_fields(grid.GetFieldData()))


def _names_of_fields(fields):
    """Returns the names in the arrays "label:NAME" that podm writes, each with one value. The first names the
    outside."""
    arrays = [fields.GetAbstractArray(index) for index in range(fields.GetNumberOfArrays())]
    named = [array for array in arrays if array.GetName().startswith("label:") and array.GetNumberOfValues() == 1]
    return {int(array.GetVariantValue(0).ToDouble()): array.GetName().removeprefix("label:") for array in named[1:]}


def _colours_of_fields(fields):
    """Returns the colours in the array `label_colours` that podm writes: value, red, green and blue of each label."""
    array = fields.GetArray("label_colours")
    if array is None or array.GetNumberOfComponents() != 4:
        return {}
    tuples = [array.GetTuple(index) for index in range(array.GetNumberOfTuples())]
    return {int(value): "#" + "".join(f"{int(share):02x}" for share in shares) for value, *shares in tuples
            if all(0 <= share <= 255 for share in shares)}


READERS = {".vtu": _read_vtk, ".pvtu": _read_vtk, ".vtk": _read_vtk}
