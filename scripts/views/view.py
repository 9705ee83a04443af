"""Draws a picture for `podm view`, from a request that podm has checked."""
import json
import sys

import numpy

from .cut import Plane, shown_cells
from .display import hidden_display
from .mesh import MeshError
from .read_mesh import read_mesh

DEFAULT_TOWARDS = (0.0, 1.0, 0.0)  # without a cut: from the front, in RAS


def picture_of(request):
    """Returns the bytes of a PNG file. Raises MeshError. `request` holds, with the names of `podm view --help`: mesh (a
    VTK file), cut (null, or normal and place with is_fraction), flip, labels, hide, colour, camera_deg, zoom, size,
    background, legend."""
    from .picture import Look, png_of  # VTK is slow to load

    mesh = read_mesh(request["mesh"])
    plane, towards = None, numpy.array(DEFAULT_TOWARDS)
    if request["cut"]:
        plane = plane_of(request["cut"], request["flip"])
        towards = plane.normal
    cells = shown_cells(mesh, plane, request["labels"], request["hide"])
    look = Look(towards, request["colour"], tuple(request["camera_deg"]), request["zoom"], tuple(request["size"]),
                request["background"], request["legend"])
    with hidden_display():
        return png_of(mesh, cells, look)


def plane_of(cut, is_flipped):
    normal = numpy.array(cut["normal"], dtype=float)
    normal /= numpy.linalg.norm(normal)
    place = cut["place"]
    if is_flipped:
        normal, place = -normal, 1 - place if cut["is_fraction"] else -place
    return Plane(normal, place, cut["is_fraction"])


def main(arguments):
    """Returns the exit code: 0 if the picture is on standard output, 2 for bad input."""
    try:
        sys.stdout.buffer.write(picture_of(json.loads(arguments[0])))
    except MeshError as error:
        print(f"podm: {error}", file=sys.stderr)
        return 2
    return 0
