"""A pressed abdomen with CalculiX: the back is held, the front pressed, and every tissue has a stiffness.

usage: pressed_abdomen.py FOLDER [IMAGE]    (packages calculix-ccx, python3-matplotlib)
"""
import pathlib
import re
import subprocess
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
import from_image  # noqa: E402

KILOPASCALS = {"vertebra": 1e5, "rib": 1e5, "hip_bone": 1e5, "disc": 1e3}  # all soft tissue has SOFT
SOFT, POISSON, PRESSURE = 10, 0.4, 1  # kPa, a ratio, and kPa on the skin in front


def read_mesh(path):
    """Returns points, cells with the name of their set, and the sides of each surface, as listed in the input file."""
    sections = re.split(r"^\*(?!\*)", path.read_text(), flags=re.MULTILINE)[1:]
    points, cells, surfaces = None, {}, {}
    for section in sections:
        head, _, body = section.partition("\n")
        lines = [line.split(", ") for line in body.splitlines() if not line.startswith("**")]
        name = head.rpartition("=")[2]
        if head.startswith("NODE"):
            points = np.array(lines, dtype=float)[:, 1:]
        elif head.startswith("ELEMENT"):
            cells[name] = np.array(lines, dtype=int)
        elif head.startswith("SURFACE"):
            surfaces[name] = lines
    return points, cells, surfaces


def write_job(path, mesh, cells, surfaces, points):
    front, back = points[:, 1].max(), points[:, 1].min()
    held = np.flatnonzero(points[:, 1] < back + 0.15 * (front - back)) + 1
    materials = "".join(f"*MATERIAL, NAME={name}\n*ELASTIC\n{KILOPASCALS.get(name, SOFT)}, {POISSON}\n"
                        f"*SOLID SECTION, ELSET={name}, MATERIAL={name}\n" for name in cells)
    volumes = "".join(f"*EL PRINT, ELSET={name}, TOTALS=ONLY\nEVOL\n" for name in cells)
    path.write_text(f"*INCLUDE, INPUT={mesh.name}\n*NSET, NSET=held\n" + "".join(f"{node},\n" for node in held) +
                    front_surface(cells, surfaces, points) + materials +
                    "*STEP\n*STATIC, SOLVER=ITERATIVE CHOLESKY\n*BOUNDARY\nheld, 1, 3\n" +
                    f"*DSLOAD\nfront, P, {PRESSURE}\n" + volumes + "*NODE PRINT, NSET=Nall\nU\n*END STEP\n")


def front_surface(cells, surfaces, points):
    """Returns a separate surface: the outer sides whose normal points to the front."""
    corners = {int(row[0]): row[1:] - 1 for rows in cells.values() for row in rows}
    vertices = {"S1": (0, 2, 1), "S2": (0, 1, 3), "S3": (1, 2, 3), "S4": (2, 0, 3)}  # the normal points out
    lines = []
    for element, side in (row for name, rows in surfaces.items() if name.endswith("-outside") for row in rows):
        a, b, c = points[corners[int(element)][list(vertices[side])]]
        normal = np.cross(b - a, c - a)
        if normal[1] > 0.8 * np.linalg.norm(normal):
            lines.append(f"{element}, {side}\n")
    return "*SURFACE, TYPE=ELEMENT, NAME=front\n" + "".join(lines)


def read_results(path):
    """Returns the volume by name of set in capitals, and displacements in the order of the nodes."""
    text = path.read_text()
    volumes = {name: float(volume) for name, volume in
               re.findall(r"total volume for set (\S+) and time.*\n\s*\n?\s*(\S+)", text)}
    displacements = re.search(r"displacements .*\n\s*\n((?:\s+\d+.*\n)+)", text).group(1)
    return volumes, np.array([line.split()[1:4] for line in displacements.splitlines()], dtype=float)


def main():
    parsed = from_image.arguments(__doc__.splitlines()[0])
    path, record = from_image.make_mesh(parsed, "abdomen.inp")
    points, cells, surfaces = read_mesh(path)
    write_job(parsed.folder / "press.inp", path, cells, surfaces, points)
    subprocess.run(["ccx", "press"], cwd=parsed.folder, check=True, stdout=subprocess.DEVNULL)
    volumes, displacements = read_results(parsed.folder / "press.dat")

    names = {name.upper().replace(" ", "_"): name for name in from_image.names_of(record).values()}
    pairs = {f"{names[a]}|{names[b]}": len(rows)
             for name, rows in surfaces.items() for a, b in [name.upper().split("-")]}
    from_image.check(record, sum(map(len, cells.values())),
                     {names[name]: volume for name, volume in volumes.items()}, pairs, tolerance=1e-5)  # 7 digits
    moved = np.linalg.norm(displacements, axis=1)
    assert moved.shape == (len(points),) and displacements[:, 1].min() < 0, "nothing was pressed to the back"
    from_image.draw_cut(points, np.vstack(list(cells.values()))[:, 1:] - 1, moved, "displacement, mm",
                        parsed.folder / "pressed_abdomen.png")
    print(f"{record['cells']} cells, moved by up to {moved.max():.2f} mm")


main()
