"""A mesh packed for viewer.js: zlib of points, cells and labels, in base64."""
import base64
import zlib

import numpy

MAX_CELLS = 200_000
# The label of the greatest volume is pale, as scripts/render_mesh.py has it.
PALE = "#ede3d1"
PALETTE = ["#cc5c54", "#4582b5", "#f2b854", "#6ba36b", "#9473b3", "#e88c66", "#5cadb0", "#db8fad", "#9e8c59", "#8c9ed1",
           "#b5c769", "#8f575c", "#4d6b78", "#d4c28c", "#b89cc9"]


class TooManyCells(Exception):
    """The text says how many a page can hold."""


def pack(mesh):
    """What viewer.js reads. Points lose all but 16 bits a coordinate. Raises TooManyCells."""
    if len(mesh.cells) > MAX_CELLS:
        raise TooManyCells(f"{len(mesh.cells):,} cells are too many for a page; give it a mesh of at most "
                           f"{MAX_CELLS:,}, for example of `podm mesh --target-elements 100000`")
    used, cells = numpy.unique(mesh.cells, return_inverse=True)
    cells = _outward(mesh.points[used], cells.reshape(-1, 4))
    points, low, step_mm = _quantized(mesh.points[used])
    values, labels = numpy.unique(mesh.labels, return_inverse=True)
    parts = [points.astype("<u2"), cells.astype("<u4"), labels.astype("<u2")]
    return {
        "points": len(points), "cells": len(cells), "low_mm": low.tolist(), "step_mm": step_mm,
        "size": points.max(axis=0).tolist(),
        "labels": [{"value": int(value), "colour": colour, "cells": int(count)}
                   for value, colour, count in zip(values, _colours(mesh), numpy.bincount(labels))],
        "data": base64.b64encode(zlib.compress(b"".join(part.tobytes() for part in parts), 9)).decode(),
    }


def _quantized(points):
    low = points.min(axis=0)
    step_mm = float((points - low).max()) / 65535
    return numpy.round((points - low) / step_mm).astype(int), low, step_mm


def _outward(points, cells):
    """Cells of positive volume, so that their facets face outwards."""
    mirrored = _volumes(points, cells) < 0
    cells[mirrored] = cells[mirrored][:, [1, 0, 2, 3]]
    return cells


def _volumes(points, cells):
    a, b, c, d = (points[cells[:, corner]] for corner in range(4))
    return numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), d - a) / 6


def _colours(mesh):
    """One a label, in the order of label values, by rank of volume."""
    _, labels = numpy.unique(mesh.labels, return_inverse=True)
    volumes = numpy.bincount(labels, numpy.abs(_volumes(mesh.points, mesh.cells)))
    colours = [""] * len(volumes)
    for rank, label in enumerate(numpy.argsort(-volumes)):
        colours[label] = PALE if rank == 0 and len(volumes) > 1 else PALETTE[(rank - 1) % len(PALETTE)]
    return colours
