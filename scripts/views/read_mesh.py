"""Tetrahedra, their labels and the names of these from mesh files: VTK's by VTK, Medit's and Gmsh's here."""
import struct
from pathlib import Path

import numpy

from .mesh import Mesh, MeshError

GMSH_TETRAHEDRON = 4
GMSH_NODES = {1: 2, 2: 3, 3: 4, GMSH_TETRAHEDRON: 4, 15: 1}  # of an element, by type: lines to tetrahedra, points


def read_mesh(path):
    """Raises MeshError."""
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise MeshError(f"{path}: no mesh file that can be shown; convert it to one of {', '.join(READERS)}")
    try:
        with open(path, "rb"):
            pass
        mesh = reader(path)
    except OSError as error:
        raise MeshError(f"{path}: {error.strerror}") from None
    if len(mesh.cells) == 0:
        raise MeshError(f"{path}: no tetrahedra")
    if mesh.cells.min() < 0 or mesh.cells.max() >= len(mesh.points):
        raise MeshError(f"{path}: a tetrahedron has a vertex that is not there")
    if not numpy.isfinite(mesh.points).all():
        raise MeshError(f"{path}: a coordinate is not finite")
    return mesh


def _read_vtk(path):
    """Needs Debian's python3-vtk9."""
    import vtk  # slow to load: only where a mesh is drawn
    from vtk.util.numpy_support import vtk_to_numpy

    kinds = {".vtu": vtk.vtkXMLUnstructuredGridReader, ".pvtu": vtk.vtkXMLPUnstructuredGridReader,
             ".vtk": vtk.vtkUnstructuredGridReader}
    vtk.vtkObject.GlobalWarningDisplayOff()  # failures are told in one line each
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
                vtk_to_numpy(grid.GetCellData().GetArray("label")), _names_of_fields(grid.GetFieldData()))


def _names_of_fields(fields):
    """Of the arrays "label:NAME" that podm writes, each with one value. The first is what is outside."""
    arrays = [fields.GetAbstractArray(index) for index in range(fields.GetNumberOfArrays())]
    named = [array for array in arrays if array.GetName().startswith("label:") and array.GetNumberOfValues() == 1]
    return {int(array.GetVariantValue(0).ToDouble()): array.GetName().removeprefix("label:") for array in named[1:]}


def _read_medit(path):
    """ASCII. Comments "label VALUE NAME" are of podm."""
    words, names = [], {}
    try:
        for line in path.read_bytes().decode(errors="replace").splitlines():
            if line.startswith("# label "):
                value, name = line.removeprefix("# label ").split(" ", 1)
                names[int(value)] = name
            words += line.split("#", 1)[0].split()
        vertices, cells = (_medit_block(words, name, width) for name, width in (("Vertices", 4), ("Tetrahedra", 5)))
        return Mesh(vertices[:, :3], cells[:, :4].astype(int) - 1, cells[:, 4].astype(int), names)
    except (IndexError, OverflowError, ValueError) as error:
        raise MeshError(f"{path}: no ASCII Medit mesh: {error}") from None


def _medit_block(words, name, width):
    at = words.index(name) + 1
    count = int(words[at]) * width
    block = words[at + 1:at + 1 + count]
    return numpy.array(block, dtype=float).reshape(-1, width)


def _read_gmsh(path):
    """MSH 4.1, binary, little-endian, as podm writes it: a volume's first physical group is its label."""
    data = path.read_bytes()
    if not data.startswith(b"$MeshFormat\n4.1 1 8\n" + struct.pack("<i", 1)):
        raise MeshError(f"{path}: not binary MSH 4.1; convert it to .vtu")
    try:
        groups = _gmsh_volumes(_Bytes(data, b"$Entities\n"))
        tags, points = _gmsh_nodes(_Bytes(data, b"$Nodes\n"))
        cells, volumes = _gmsh_cells(_Bytes(data, b"$Elements\n"))
        labels = numpy.array([groups[volume] for volume in volumes.tolist()])
        names = _gmsh_names(data)
    except (KeyError, OverflowError, ValueError, struct.error):
        raise MeshError(f"{path}: damaged, or its volumes have no physical groups") from None
    order = numpy.argsort(tags)
    found = numpy.clip(numpy.searchsorted(tags, cells, sorter=order), 0, len(tags) - 1)
    positions = order[found]
    if (tags[positions] != cells).any():
        raise MeshError(f"{path}: a tetrahedron has a vertex that is not there")
    return Mesh(points, positions, labels, names)


class _Bytes:
    """What follows a heading, taken number by number. Raises ValueError or struct.error at the end."""

    def __init__(self, data, heading):
        self._data, self._at = data, data.index(heading) + len(heading)

    def take(self, kinds):
        values = struct.unpack_from("<" + kinds, self._data, self._at)
        self._at += struct.calcsize("<" + kinds)
        return values

    def array(self, kind, *shape):
        count = int(numpy.prod(shape, dtype=object))
        values = numpy.frombuffer(self._data, kind, count, self._at)
        self._at += values.nbytes
        return values.reshape(shape)


def _gmsh_volumes(rest):
    """The first physical group of each volume."""
    points, curves, surfaces, volumes = rest.take("4Q")
    groups = {}
    for dimension, count in enumerate((points, curves, surfaces, volumes)):
        for _ in range(count):
            (tag,) = rest.take("i")
            rest.array("<f8", 3 if dimension == 0 else 6)  # its box
            own = rest.array("<i4", rest.take("Q")[0])
            if dimension > 0:
                rest.array("<i4", rest.take("Q")[0])  # its boundary
            if dimension == 3 and len(own):
                groups[tag] = int(own[0])
    return groups


def _gmsh_nodes(rest):
    blocks, *_ = rest.take("4Q")
    tags, points = [], []
    for _ in range(blocks):
        *_, count = rest.take("iiiQ")
        tags.append(rest.array("<u8", count))
        points.append(rest.array("<f8", count, 3))
    return numpy.concatenate(tags), numpy.concatenate(points)


def _gmsh_cells(rest):
    """Tags of nodes, and the volume of each tetrahedron."""
    blocks, *_ = rest.take("4Q")
    cells, volumes = [], []
    for _ in range(blocks):
        _, entity, kind, count = rest.take("iiiQ")
        elements = rest.array("<u8", count, 1 + GMSH_NODES[kind])
        if kind == GMSH_TETRAHEDRON:
            cells.append(elements[:, 1:])
            volumes.append(numpy.full(count, entity))
    return numpy.concatenate(cells), numpy.concatenate(volumes)


def _gmsh_names(data):
    """Of the physical groups of volumes: lines `3 TAG "NAME"`."""
    if b"$PhysicalNames\n" not in data:
        return {}
    section = data.split(b"$PhysicalNames\n", 1)[1].split(b"$EndPhysicalNames", 1)[0]
    split = (line.split(" ", 2) for line in section.decode(errors="replace").splitlines()[1:])
    return {int(tag): name.strip('"') for dimension, tag, name in split if dimension == "3"}


READERS = {".vtu": _read_vtk, ".pvtu": _read_vtk, ".vtk": _read_vtk, ".mesh": _read_medit, ".msh": _read_gmsh}
