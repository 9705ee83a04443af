"""A tetrahedral mesh with labels, as read from a file."""
from dataclasses import dataclass, field

import numpy


class MeshError(Exception):
    """A mesh that cannot be read or shown; the text names the file and the fault."""


@dataclass(frozen=True)
class Mesh:
    points: numpy.ndarray  # n x 3, mm
    cells: numpy.ndarray  # m x 4, indices of points
    labels: numpy.ndarray  # m, values
    names: dict = field(default_factory=dict)  # by label value; unnamed labels are missing
    colours: dict = field(default_factory=dict)  # "#rrggbb" by label value, of labels whose image gives one

    def name_of(self, value):
        return self.names.get(int(value), f"label {value}")

    def corners(self):
        """Returns the cells' vertices, m x 4 x 3."""
        return self.points[self.cells]

    def volumes_mm3(self):
        """Returns signed volumes: positive if the fourth vertex is above the first three, counterclockwise."""
        a, b, c, d = numpy.moveaxis(self.corners(), 1, 0)
        return numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), d - a) / 6

    def labels_by_volume(self):
        """Returns label values, the greatest volume first."""
        values, positions = numpy.unique(self.labels, return_inverse=True)
        volumes = numpy.bincount(positions, numpy.abs(self.volumes_mm3()), len(values))
        return [int(value) for value in values[numpy.argsort(-volumes, kind="stable")]]
