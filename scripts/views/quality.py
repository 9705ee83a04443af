"""Quality of each cell of a mesh in floating point, for display only; podm-verify proves the bounds."""
from dataclasses import dataclass
from itertools import combinations
from typing import Callable

import numpy

BLOCK = 1 << 17  # cells measured at a time, so that the memory needed does not grow with the mesh


@dataclass(frozen=True)
class Measure:
    """One number per cell. `low` and `high`: the range of the colours; None: the mesh's own range."""

    title: str
    of_corners: Callable  # corners, m x 4 x 3 in mm, to m numbers
    low: float | None = None
    high: float | None = None
    is_low_bad: bool = False


def measured(mesh, name):
    """Returns one number per cell for the named measure; NaN where a flat cell has none."""
    measure = MEASURES[name].of_corners
    with numpy.errstate(divide="ignore", invalid="ignore"):
        parts = [measure(mesh.points[mesh.cells[at:at + BLOCK]]) for at in range(0, len(mesh.cells), BLOCK)]
    values = numpy.concatenate(parts)
    values[~numpy.isfinite(values)] = numpy.nan
    return values


def dihedral_angles_deg(corners):
    """Returns m x 6 angles, between the two facets at each edge."""
    return numpy.stack([_angle_at(corners, edge) for edge in combinations(range(4), 2)], axis=1)


def _angle_at(corners, edge):
    """Returns the angle between the other two vertices, seen along the edge."""
    a, b = (corners[:, vertex] for vertex in edge)
    c, d = (corners[:, vertex] - a for vertex in range(4) if vertex not in edge)
    along = (b - a) / numpy.linalg.norm(b - a, axis=1, keepdims=True)
    c, d = (one - _dot(one, along)[:, None] * along for one in (c, d))
    return numpy.degrees(numpy.arctan2(numpy.linalg.norm(numpy.cross(c, d), axis=1), _dot(c, d)))


def circumradii_mm(corners):
    a = corners[:, 0]
    u, v, w = (corners[:, vertex] - a for vertex in (1, 2, 3))
    vw, wu, uv = numpy.cross(v, w), numpy.cross(w, u), numpy.cross(u, v)
    center = (_dot(u, u)[:, None] * vw + _dot(v, v)[:, None] * wu + _dot(w, w)[:, None] * uv) / (
        2 * _dot(u, vw)[:, None])
    return numpy.linalg.norm(center, axis=1)


def radius_edge_ratios(corners):
    edges = [numpy.linalg.norm(corners[:, a] - corners[:, b], axis=1) for a, b in combinations(range(4), 2)]
    return circumradii_mm(corners) / numpy.min(edges, axis=0)


def _dot(a, b):
    return numpy.einsum("ij,ij->i", a, b)


# The names are those of `podm view --colour`. A regular tetrahedron has 70.5 degrees and a ratio of 0.61.
MEASURES = {
    "dihedral": Measure("smallest dihedral angle, degrees", lambda corners: dihedral_angles_deg(corners).min(axis=1),
                        0, 70.53, is_low_bad=True),
    "ratio": Measure("radius-edge ratio", radius_edge_ratios, 0.61, 2),
    "size": Measure("circumradius, mm", circumradii_mm),
}
