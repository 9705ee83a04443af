"""Common parts of the examples: meshing by podm, a check of the mesh that the solver read, and a picture."""

import argparse
import json
import os
import pathlib
import subprocess

PROGRAM = os.environ.get("PODM_PROGRAM", "podm")
LIVER = 14  # its label in the phantom


def arguments(description):
    """Returns IMAGE and FOLDER of the command line, and creates the folder."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("folder", type=pathlib.Path, help="where mesh, solution and picture go")
    parser.add_argument("image", nargs="?", default="phantom:abdomen@40", help="segmentation with a liver, label 14")
    parser.add_argument("--radius", default="20", help="largest circumradius of a cell, mm")
    parsed = parser.parse_args()
    parsed.folder.mkdir(parents=True, exist_ok=True)
    return parsed


def make_mesh(parsed, name, *options):
    """Meshes the image into FOLDER/name; returns its path and podm's record of the run."""
    path, record = parsed.folder / name, parsed.folder / "record.jsonl"
    subprocess.run([PROGRAM, "mesh", parsed.image, "--radius", parsed.radius, "--quiet", "-o", path, "--record", record,
                    *options], check=True)
    return path, json.loads(record.read_text().splitlines()[-1])


def names_of(record):
    """Returns names by label value, as podm writes them."""
    return {0: "outside", **{label["value"]: label["name"] or f"label {label['value']}" for label in record["labels"]}}


def check(record, cells, volumes, facets, tolerance=1e-9):
    """Checks the number of cells, volumes (mm^3) by label name, and facets by pair name against podm's record."""
    names = names_of(record)
    expected_facets = {f"{names[b]}|{names[a]}": pair["facets"] for pair in record["facet_pairs"]
                       for a, b in [pair["labels"]]}
    faults = [] if cells == record["cells"] else [f"{cells} cells, podm recorded {record['cells']}"]
    expected_volumes = {names[label["value"]]: label["volume_mm3"] for label in record["labels"] if label["cells"] > 0}
    faults += [f"volume of {name}" for name in expected_volumes.keys() | volumes.keys()
               if abs(volumes.get(name, 0) / expected_volumes.get(name, 1) - 1) > tolerance]
    faults += [f"facets of {name}: {facets.get(name)}, podm recorded {expected_facets.get(name)}"
               for name in expected_facets.keys() | facets.keys() if facets.get(name) != expected_facets.get(name)]
    if faults:
        raise SystemExit("the solver has read another mesh than podm wrote: " + "; ".join(sorted(faults)[:5]))


def draw_cut(points, cells, values, quantity, path):
    """Draws the values at the points, in the axial plane through the point of the largest value."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    height = points[np.argmax(values)][2] + 1e-3  # the plane contains no point
    above = points[cells][:, :, 2] > height
    edges = np.array([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])
    xy, colour, triangles = [], [], []
    for cell, is_above in zip(cells[above.any(1) & ~above.all(1)], above[above.any(1) & ~above.all(1)]):
        a, b = cell[edges[is_above[edges[:, 0]] != is_above[edges[:, 1]]]].T
        t = (height - points[a, 2]) / (points[b, 2] - points[a, 2])
        first = len(colour)
        xy.extend(points[a, :2] + t[:, None] * (points[b, :2] - points[a, :2]))
        colour.extend(values[a] + t * (values[b] - values[a]))
        triangles.extend([(first, first + 1, first + 2), (first + 1, first + 2, first + 3)][:len(a) - 2])
    figure, axes = plt.subplots(figsize=(7, 5))
    drawn = axes.tripcolor(*np.array(xy).T, triangles, np.array(colour), shading="gouraud", cmap="inferno")
    axes.set(aspect="equal", xlabel="x (mm, to the right)", ylabel="y (mm, to the front)", title=f"z = {height:.0f} mm")
    figure.colorbar(drawn, label=quantity)
    figure.savefig(path, dpi=120)
