"""The Delaunay triangulation of some vertices, which operations it answers to, and plane cuts through it."""
from dataclasses import dataclass

import numpy
from figures.plane_cut import plane_cut
from scipy.spatial import Delaunay


FLAT = 1e-9  # six times the volume over the cube of the longest edge


@dataclass(frozen=True)
class Triangulation:
    ids: numpy.ndarray
    points: numpy.ndarray
    cells: numpy.ndarray  # positions in `points`

    @classmethod
    def of(cls, vertices):
        ids, points = numpy.array(list(vertices)), numpy.array(list(vertices.values()))
        cells = Delaunay(points).simplices
        edges = points[cells[:, 1:]] - points[cells[:, :1]]
        # Corners of the box lie on one sphere, and Qhull makes flat cells of them.
        flatness = numpy.abs(numpy.linalg.det(edges)) / numpy.linalg.norm(edges, axis=2).max(axis=1)**3
        return cls(ids, points, cells[flatness > FLAT])

    def spheres(self):
        """Circumcenters and squared circumradii of the cells."""
        corners = self.points[self.cells]
        edges = corners[:, 1:] - corners[:, :1]
        centers = numpy.linalg.solve(2 * edges, (edges**2).sum(axis=2)[..., None])[..., 0]
        return centers + corners[:, 0], (centers**2).sum(axis=1)

    def cavity(self, point, spheres, removed=()):
        """True for each cell whose circumsphere holds the point, or with a vertex that is removed."""
        centers, squared = spheres
        found = ((centers - point) ** 2).sum(axis=1) < squared
        return found | numpy.isin(self.ids[self.cells], removed).any(axis=1)

    def named_cells(self, chosen):
        """The chosen cells as sets of vertex ids."""
        return {frozenset(cell) for cell in self.ids[self.cells[chosen]].tolist()}


@dataclass(frozen=True)
class Plane:
    """A plane through `origin`, by two unit vectors in it that are perpendicular."""

    origin: numpy.ndarray
    right: numpy.ndarray
    up: numpy.ndarray

    @classmethod
    def through(cls, origin, other, third):
        right = (other - origin) / numpy.linalg.norm(other - origin)
        up = third - origin - right * numpy.dot(third - origin, right)
        return cls(origin, right, up / numpy.linalg.norm(up))

    def seen(self, points):
        """n x 3: coordinates in the plane, and the height above it."""
        axes = numpy.stack([self.right, self.up, numpy.cross(self.right, self.up)], axis=1)
        return (points - self.origin) @ axes

    def cut(self, mesh, chosen):
        """The polygons in which the plane cuts the chosen cells, and the cell of each."""
        cells = numpy.flatnonzero(chosen)
        polygons, owners = plane_cut(self.seen(mesh.points), mesh.cells[cells], 1e-9)
        return polygons, cells[owners]


@dataclass(frozen=True)
class Labels:
    """The label at a point, by the nearest voxel; 0 outside the image."""

    voxels: numpy.ndarray
    inverse: numpy.ndarray  # 4 x 4: from mm to voxels

    def at(self, points):
        places = numpy.rint(points @ self.inverse[:3, :3].T + self.inverse[:3, 3]).astype(int)
        inside = ((places >= 0) & (places < self.voxels.shape)).all(axis=-1)
        places[~inside] = 0
        return numpy.where(inside, self.voxels[tuple(numpy.moveaxis(places, -1, 0))], 0)
