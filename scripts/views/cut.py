"""Chooses the cells of a mesh to show: those of some labels, on one side of a plane."""
import difflib
from dataclasses import dataclass

import numpy

from .mesh import MeshError


@dataclass(frozen=True)
class Plane:
    """Cells whose centres lie beyond the plane, on the side that the normal points to, are left out."""

    normal: numpy.ndarray  # of length 1
    place: float
    is_fraction: bool = False  # of the mesh's extent along the normal; otherwise `place` is in mm from the origin


def shown_cells(mesh, plane, names, hidden):
    """Returns positions of the cells to draw. `names`: names or values of labels; empty: all. Raises MeshError."""
    kept = numpy.ones(len(mesh.cells), bool)
    if names:
        kept &= numpy.isin(mesh.labels, label_values(mesh, names, "--labels"))
    kept &= ~numpy.isin(mesh.labels, label_values(mesh, hidden, "--hide"))
    if not kept.any():
        raise MeshError("--labels and --hide leave no cell")
    if plane is not None:
        kept &= mesh.corners().mean(axis=1) @ plane.normal <= place_mm(mesh, plane)
    if not kept.any():
        raise MeshError("--cut: the plane leaves no cell of the labels shown; move it, or --flip it")
    return numpy.flatnonzero(kept)


def place_mm(mesh, plane):
    """Returns the plane's distance from the origin along the normal."""
    if not plane.is_fraction:
        return plane.place
    along = mesh.points[numpy.unique(mesh.cells)] @ plane.normal
    return along.min() + plane.place * (along.max() - along.min())


def label_values(mesh, words, option):
    """Returns the values of labels given by name or value. A name stands for every label that has it."""
    values = [int(value) for value in numpy.unique(mesh.labels)]
    found = []
    for word in words:
        bearers = [value for value in values if word in (mesh.names.get(value), str(value))]
        if not bearers:
            raise MeshError(f"{option}: no label of the mesh is called '{word}'{_did_you_mean(word, mesh, values)}")
        found += bearers
    return found


def _did_you_mean(word, mesh, values):
    names = [mesh.name_of(value) for value in values]
    nearest = difflib.get_close_matches(word, names, 1, 0.5)
    if nearest:
        return f", did you mean '{nearest[0]}'?"
    return f"; it has {', '.join(names[:12])}{' and others' if len(names) > 12 else ''}"
