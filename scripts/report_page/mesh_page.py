"""Makes the page about one run of `podm mesh` and its mesh: are the guarantees met, how good are the cells, what were
the settings. Uses the mesh's file, the run's record and, with --verify, the report of podm-verify."""
import json
import sys
from html import escape
from pathlib import Path

import numpy
import pandas
from figures.write import svg_of
from views.mesh import MeshError
from views.read_mesh import read_mesh

from . import dihedral_bounds
from .histograms import histograms, quality_of
from .html import Bar, bars, box, document, findings, fold, responsive, section, table_html
from .sections import sections_html
from .viewer import MAX_CELLS, pack, script, viewer_html

SECTIONS = {"quality": "Quality by label", "mesh": "The mesh", "labels": "Labels", "claims": "Claims", "run": "The run"}
BOUND_RATIO, BOUND_ANGLE_DEG = 1.93, 30
# Guarantees that the mesher itself checks, by their names in the record.
GUARANTEES = {"radius_edge": f"cells have a radius-edge ratio below {BOUND_RATIO}",
              "facet_angle": f"boundary facets have angles above {BOUND_ANGLE_DEG} degrees",
              "radius": "cells have a circumradius within what was asked for",
              "facet_vertices": "boundary facets have their vertices on the surface between the labels",
              "orientation": "cells have a positive volume as stored",
              "missing_labels": "labels of more than 1000 voxels have cells",
              "topology": "components of labels have the topology that they have in the image",
              "off_sides": "facets where the object leaves the image's box lie in the planes of its sides"}

# The part of the record that is null unless the guarantee was asked for.
ASKED_FOR_BY = {"topology": "thin_layers", "off_sides": "facets_of_sides"}


def page(request):
    """Returns the page. `request`: mesh (the path of a VTK file), name (of the mesh's own file), record, verification
    (null or podm-verify's report), unmet (sentences). Raises MeshError."""
    record, verification = request["record"], request["verification"]
    mesh = read_mesh(request["mesh"])
    quality = quality_of(mesh)
    packed = pack(mesh) if len(mesh.cells) <= MAX_CELLS else None
    parts = {"quality": _quality(mesh, quality), "mesh": _mesh(mesh, packed), "labels": _labels(mesh, quality, record),
             "claims": _claims(record, verification), "run": _run(record)}
    name = request["name"]
    header = f"""<h1>{escape(name)}</h1>
<p class="faint">{record["cells"]:,} tetrahedra, {record["vertices"]:,} vertices, {record["boundary_facets"]:,} facets
on surfaces, of {escape(record["input"]["path"])}, by {escape(record["program"])}.</p>"""
    links = " ".join(f'<a href="#{key}">{title}</a>' for key, title in SECTIONS.items())
    body = "\n".join(section(key, title, parts[key]) for key, title in SECTIONS.items())
    main = f"""<div class="answers">
{_card("holds", "Does it keep its promises?", _holds(record, verification, request["unmet"]))}
{_card("good", "How good are its cells?", _good(record))}
</div>
<nav aria-label="Sections">{links}</nav>
{body}"""
    return document(f"{name}: a mesh by PODMark", header, main, script(packed))


def _card(name, question, content):
    return (f'<section class="answer" id="{name}" aria-labelledby="{name}-title">'
            f'<h2 id="{name}-title">{question}</h2>\n{content}\n</section>')


def _answer(text):
    return f'<p class="answer-text">{escape(text)}</p>'


def _holds(record, verification, unmet):
    lines = _findings(record, verification)
    if unmet:
        listed = "".join(f"<li>{escape(sentence)}</li>" for sentence in unmet)
        return _answer("No, not all of it.") + f"<ul>{listed}</ul>"
    if verification is None:
        return (_answer("Yes, by what the mesher counts itself.") + findings(lines)
                + '<p class="faint">It is not verified independently: with --verify, podm-verify proves it by exact '
                  "arithmetic, with none of the mesher's code.</p>")
    return _answer(f"Yes: podm-verify has proved {len(lines)} claims about the file.") + findings(lines)


def _findings(record, verification):
    """Returns (verdict, statement, reason) from podm-verify, or from the mesher."""
    if verification is None:
        return [(verdict, f"all {statement}", f"misses: {misses}") for statement, misses, verdict in _counted(record)]
    return [(claim["verdict"], name.replace("_", " "), claim["reason"])
            for name, claim in verification["claims"].items()]


def _good(record):
    quality, used = record["quality"], record["used"]
    lines = [Bar("largest radius-edge ratio", quality["max_radius_edge"] / BOUND_RATIO,
                 f"{quality['max_radius_edge']:.4g} of {BOUND_RATIO}", "own"),
             Bar("smallest angle of a facet on a surface", quality["min_facet_angle_deg"] / 60,
                 f"{quality['min_facet_angle_deg']:.4g}°, bound {BOUND_ANGLE_DEG}°", "own"),
             *dihedral_bounds.bars_of(record)]
    if used["radius_mm"] > 0:
        lines.append(Bar("largest circumradius", quality["max_radius_mm"] / used["radius_mm"],
                         f"{quality['max_radius_mm']:.4g} of {used['radius_mm']:.4g} mm", "own"))
    verdicts = dihedral_bounds.judged(record)
    note = "" if verdicts else f'<p class="faint">{dihedral_bounds.NO_BOUND}</p>'
    return (_answer(f"Radius-edge ratio up to {quality['max_radius_edge']:.4g}, dihedral angles from "
                  f"{quality['min_dihedral_deg']:.3g} to {quality['max_dihedral_deg']:.4g} degrees.")
            + findings(verdicts) + bars("the worst cells", lines, full=1) + note)


def _quality(mesh, quality):
    figure = histograms(mesh, quality)
    title = "Histograms of quality by label"
    picture = box(title, responsive(svg_of(figure, "quality"), title))
    return f"<figure>{picture}<figcaption>{escape(figure.get_label())}</figcaption></figure>"


def _mesh(mesh, packed):
    if packed is not None:
        return viewer_html(packed, "")
    return (f"<p>{len(mesh.cells):,} cells, more than the {MAX_CELLS:,} that a page can turn: cut by three planes. "
            f"<code>podm view</code> draws any cut of it.</p>\n{sections_html(mesh)}")


def _labels(mesh, quality, record):
    """Returns a table with a line per label, the greatest volume first."""
    volumes = {label["value"]: label["volume_mm3"] for label in record["labels"]}
    lines = []
    for value in mesh.labels_by_volume():
        chosen = mesh.labels == value
        ratio, angle, size = (quality[name][chosen] for name in ("ratio", "dihedral", "size"))
        lines.append({"label": mesh.name_of(value), "value": str(value), "cells": f"{chosen.sum():,}",
                      "volume, cm³": f"{volumes.get(value, numpy.nan) / 1000:.4g}",
                      "largest ratio": float(numpy.nanmax(ratio)),
                      "smallest dihedral angle": float(numpy.nanmin(angle)),
                      "cells under 10°": f"{100 * (angle < 10).mean():.2g} %",
                      "median circumradius, mm": float(numpy.nanmedian(size))})
    return table_html(pandas.DataFrame(lines), "Labels")


def _claims(record, verification):
    own = pandas.DataFrame([{"guarantee": f"all {statement}", "verdict": verdict, "cells or facets that do not": misses}
                            for (statement, misses, verdict) in _counted(record)])
    made = ["<p>The mesher's own counts, while the mesh is in memory:</p>", table_html(own, "Guarantees")]
    if verification is None:
        return "\n".join([*made, "<p>podm-verify did not run (--verify).</p>"])
    lines = [{"claim": name.replace("_", " "), "verdict": claim["verdict"], "found": claim["reason"],
              "checked": f"{claim['num_checked']:,}", "how": claim["method"]}
             for name, claim in verification["claims"].items()]
    return "\n".join([*made, "<p>Claims about the file that podm-verify decided:</p>",
                      table_html(pandas.DataFrame(lines), "Claims of podm-verify")])


def _counted(record):
    return [(statement, f"{record['guarantees'][name]:,}", "fail" if record["guarantees"][name] else "pass")
            for name, statement in GUARANTEES.items()
            if record.get(ASKED_FOR_BY.get(name, "guarantees"))]


def _run(record):
    phases = [Bar(name, seconds, f"{seconds:.2f} s", "own") for name, seconds in record["phases_s"].items()
              if seconds >= 0.005]
    facts = {"algorithm": record["algorithm"], "threads": record["threads"]["used"],
             "cells per second, image to mesh": f"{record['cells_per_second']:,.0f}",
             "peak memory": f"{record['peak_rss_bytes'] / 2**30:.3g} GiB",
             "delta, mm": f"{record['used']['delta_mm']:.4g}", "space": record["options"]["space"],
             "ended": record["stop_reason"], "SHA-256 of the input": record["input"]["sha256"],
             "SHA-256 of the mesh": record["mesh_sha256"]}
    listed = "".join(f"<dt>{escape(name)}</dt><dd>{escape(str(value))}</dd>" for name, value in facts.items())
    warnings = "".join(f"<li>{escape(warning)}</li>" for warning in record["warnings"])
    whole = f"<pre>{escape(json.dumps(record, indent=1))}</pre>"
    return (f"<dl>{listed}</dl>" + (f"<h3>Warnings</h3><ul>{warnings}</ul>" if warnings else "")
            + f"<h3>Seconds by phase</h3>{bars('seconds by phase', phases)}" + fold("The whole record", whole))


def main(arguments):
    """Returns the exit code: 0 if the page is on standard output, 2 for bad input."""
    try:
        text = page(json.loads(Path(arguments[0]).read_text(encoding="utf-8")))
        sys.stdout.buffer.write(text.encode())  # independent of the locale, which VTK's reader may have changed
    except (MeshError, OSError) as error:
        print(f"podm: {error}", file=sys.stderr)
        return 2
    return 0
