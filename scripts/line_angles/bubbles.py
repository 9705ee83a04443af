"""The shape of phantom:bubbles: three equal spheres, cut by the planes halfway between their centers.

The numbers are those of bubbles() in mesher/phantoms/phantom.cpp.
"""
import numpy

RADIUS_MM, FROM_AXIS_MM = 40, 26
_ANGLES = 2 * numpy.pi * numpy.arange(3) / 3
CENTERS = FROM_AXIS_MM * numpy.stack([numpy.cos(_ANGLES), numpy.sin(_ANGLES), numpy.zeros(3)], axis=1)


def normals(points, sides):
    """Returns the unit normal of the interface between the labels `sides` (0: outside) that is nearest to each point.
    """
    low, high = numpy.sort(sides, axis=1).T
    way = CENTERS[high - 1] - CENTERS[low - 1]
    way = numpy.where(low[:, None] == 0, points - CENTERS[high - 1], way)
    return way / numpy.linalg.norm(way, axis=1, keepdims=True)
