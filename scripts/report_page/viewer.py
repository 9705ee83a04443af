"""Packs a mesh for viewer.js: points, cells and labels; in a page zlib of them, in base64. Also makes the HTML around
it."""
import base64
import json
import zlib
from html import escape
from pathlib import Path

import numpy
from views.colours import colours_of_labels

MAX_CELLS = 200_000
SCRIPT = Path(__file__).with_name("viewer.js")
HELP = """cut open: those whose centres lie beyond the plane are left out. Drag to turn; wheel, two fingers, + and -
zoom; arrow keys turn too."""
# The elements that viewer.js fills.
FRAME = """<div id="viewer">
<canvas tabindex="0" role="img" aria-label="The mesh in three dimensions, cells coloured by label"></canvas>
<form>
<div class="line"><label for="axis">across</label><select id="axis" name="axis"><option value="0">x</option>
<option value="1" selected>y</option><option value="2">z</option></select></div>
<div class="line"><label for="cut">cut</label>
<input id="cut" name="cut" type="range" min="0" max="1" step="0.005" value="0.5"></div>
<fieldset><legend>labels</legend><div data-labels></div></fieldset>
</form>
<p data-fault role="status"></p>
</div>"""


class TooManyCells(Exception):
    """The mesh is too large; the text gives the greatest number of cells for a page."""


def pack(mesh):
    """Returns the data for viewer.js. Raises TooManyCells."""
    if len(mesh.cells) > MAX_CELLS:
        raise TooManyCells(f"{len(mesh.cells):,} cells are more than a page can show; use a mesh of at most "
                           f"{MAX_CELLS:,}, for example from `podm mesh --target-elements 100000`")
    description, data = parts_of(mesh, colours_of_labels(mesh))
    return description | {"data": base64.b64encode(zlib.compress(data, 9)).decode()}


def parts_of(mesh, colours):
    """Returns the description of the mesh for viewer.js, and its bytes. Points keep 16 bits per coordinate. `colours`:
    by label value."""
    used, cells = numpy.unique(mesh.cells, return_inverse=True)
    cells = _outward(mesh, cells.reshape(-1, 4))
    points, low, step_mm = _quantized(mesh.points[used])
    values, labels = numpy.unique(mesh.labels, return_inverse=True)
    parts = [points.astype("<u2"), cells.astype("<u4"), labels.astype("<u2")]
    description = {
        "points": len(points), "cells": len(cells), "low_mm": low.tolist(), "step_mm": step_mm,
        "size": points.max(axis=0).tolist(),
        "labels": [{"value": int(value), "name": mesh.name_of(value), "colour": colours[int(value)],
                    "cells": int(count)} for value, count in zip(values, numpy.bincount(labels))],
    }
    return description, b"".join(part.tobytes() for part in parts)


def _quantized(points):
    low = points.min(axis=0)
    step_mm = float((points - low).max()) / 65535
    return numpy.round((points - low) / step_mm).astype(int), low, step_mm


def _outward(mesh, cells):
    """Orders the vertices so that volumes are positive and facets face outwards."""
    mirrored = mesh.volumes_mm3() < 0
    cells[mirrored] = cells[mirrored][:, [1, 0, 2, 3]]
    return cells


def viewer_html(packed, fault):
    """`packed`: from pack(), or None; `fault` then gives the reason. Needs script() at the end of the page."""
    if packed is None:
        return f'<p class="faint">{escape(fault)}</p>'
    data = json.dumps(packed).replace("<", "\\u003c")
    return f"""<p>{packed["cells"]:,} cells, {HELP}</p>
{FRAME}
<script type="application/json" id="mesh-data">{data}</script>"""


def script(packed):
    return f"<script>{SCRIPT.read_text(encoding='utf-8')}</script>" if packed else ""
