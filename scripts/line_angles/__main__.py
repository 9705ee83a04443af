"""Meshes phantom:bubbles with lines and without. Prints a JSON array on standard output, with an object per mesh: mean,
root mean square and 95th percentile of the angle between a facet's normal and that of the shape, weighted by area, for
facets at lines and for all others; and the ratio of the means with lines over without."""
import argparse
import itertools
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy

from views.read_mesh import read_mesh

from .bubbles import normals
from .facets import are_at_lines, areas_and_normals, errors_deg, interface_facets


def spread(errors, weights):
    """Returns the weighted mean, root mean square and 95th percentile."""
    order = numpy.argsort(errors)
    shares = numpy.cumsum(weights[order]) / weights.sum()
    return {"facets": len(errors), "mean_deg": float(numpy.average(errors, weights=weights)),
            "rms_deg": float(numpy.sqrt(numpy.average(errors**2, weights=weights))),
            "p95_deg": float(errors[order][numpy.searchsorted(shares, 0.95)])}


def errors_of(mesh):
    """Returns the spread of errors of the mesh's facets at lines, and away from them."""
    facets, sides = interface_facets(mesh.cells, mesh.labels)
    areas, found = areas_and_normals(mesh.points, facets)
    errors = errors_deg(found, normals(mesh.points[facets].mean(axis=1), sides))
    at_lines = are_at_lines(facets, sides)
    return {"at_lines": spread(errors[at_lines], areas[at_lines]), "away": spread(errors[~at_lines], areas[~at_lines])}


def measure(program, size, options):
    """Returns the row of one mesh."""
    with tempfile.TemporaryDirectory() as folder:
        mesh, record = Path(folder) / "mesh.vtu", Path(folder) / "record.jsonl"
        command = [program, "mesh", f"phantom:bubbles@{size}", *options, "-o", mesh, "--record", record, "--quiet"]
        subprocess.run(command, check=True)
        made = json.loads(record.read_text())
        return {"size": size, "options": options, "radius_mm": made["used"]["radius_mm"],
                "delta_mm": made["used"]["delta_mm"], "cells": made["cells"], "mesh_sha256": made["mesh_sha256"],
                **errors_of(read_mesh(mesh))}


def spacing_mm(program, size):
    command = [program, "info", f"phantom:bubbles@{size}", "--json"]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)["spacing_mm"][0]


def with_lines_and_without(program, size, smooth_voxels, delta_voxels):
    voxel = spacing_mm(program, size)
    options = ["--delta", f"{delta_voxels * voxel:.6g}", "--radius", f"{3 * voxel:.6g}", "--threads", "1"]
    options += ["--smooth", f"{smooth_voxels * voxel:.6g}"] if smooth_voxels else []
    without, with_lines = (measure(program, size, more) for more in (options, [*options, "--lines"]))
    ratio = with_lines["at_lines"]["mean_deg"] / without["at_lines"]["mean_deg"]
    settings = {"smooth_voxels": smooth_voxels, "delta_voxels": delta_voxels}
    return {**settings, "lines": False, **without}, {**settings, "lines": True, **with_lines, "ratio_of_means": ratio}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--podm", default="build/bin/podm", help="default build/bin/podm")
    parser.add_argument("--sizes", type=int, nargs="+", default=[48, 64, 96], help="voxels along x; default 48 64 96")
    parser.add_argument("--smooth", type=float, nargs="+", default=[0, 1.5],
                        help="--smooth of podm, voxels; 0: none; default 0 1.5")
    parser.add_argument("--delta", type=float, nargs="+", default=[1, 2], help="--delta of podm, voxels; default 1 2")
    arguments = parser.parse_args()
    version = subprocess.run([arguments.podm, "--version"], check=True, stdout=subprocess.PIPE, text=True).stdout
    rows = [{"program": version.splitlines(), **row}
            for settings in itertools.product(arguments.sizes, arguments.smooth, arguments.delta)
            for row in with_lines_and_without(arguments.podm, *settings)]
    print("[\n" + ",\n".join(map(json.dumps, rows)) + "\n]")
    return 0


if __name__ == "__main__":
    sys.exit(main())
