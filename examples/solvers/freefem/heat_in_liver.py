"""Heat in the liver with FreeFem++ (heat_in_liver.edp), from the segmentation to the picture.

usage: heat_in_liver.py FOLDER [IMAGE]    (packages freefem++, python3-meshio, python3-matplotlib)
"""
import pathlib
import re
import subprocess
import sys

import meshio
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
import from_image  # noqa: E402

SCRIPT = pathlib.Path(__file__).with_suffix(".edp")


def names_in(path):
    """Returns names by kind, label or pair, and reference, from podm's comments in a Medit file."""
    head = path.read_text().split("Dimension")[0]
    comments = re.findall(r"^# (label|pair) (\d+)(?: \d+ \d+)? (.*)$", head, re.MULTILINE)
    return {(kind, int(number)): name for kind, number, name in comments}


def main():
    parsed = from_image.arguments(__doc__.splitlines()[0])
    path, record = from_image.make_mesh(parsed, "abdomen.mesh")
    names = names_in(path)
    outer = [number for (kind, number), name in names.items() if kind == "pair" and name.endswith("|outside")]
    (parsed.folder / "outer.txt").write_text("\n".join(map(str, [len(outer), *outer])) + "\n")
    subprocess.run(["FreeFem++", "-nw", "-v", "0", SCRIPT, parsed.folder], check=True)

    cells, *lines = (parsed.folder / "read.txt").read_text().splitlines()
    sums = [line.split() for line in lines]
    from_image.check(record, int(cells),
                     {names[kind, int(number)]: float(volume) for kind, number, volume in sums if kind == "label"},
                     {names[kind, int(number)]: int(count) for kind, number, count in sums if kind == "pair"})
    rise = np.loadtxt(parsed.folder / "rise.txt")
    assert 0 < rise.max() < 5e-5 / 2e-6, "no point is hotter than without conduction"
    mesh = meshio.read(path)
    cells_read = next(block.data for block in mesh.cells if block.type == "tetra")
    from_image.draw_cut(mesh.points, cells_read, rise, "K above blood", parsed.folder / "heat_in_liver.png")
    print(f"{cells} cells, at most {rise.max():.1f} K above blood")


main()
