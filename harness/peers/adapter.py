"""What the adapters of this folder share: the contract's command line, podm's surface, the record."""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

import numpy as np

EXIT_ABSENT = 77
# A regular tetrahedron of circumradius 1: what a bound of the circumradius means to meshers that bound edge or volume.
EDGE_OF_UNIT_RADIUS = (8 / 3) ** 0.5
VOLUME_OF_UNIT_RADIUS = EDGE_OF_UNIT_RADIUS**3 / 72**0.5


def absent(reason):
    """Ends the adapter: its mesher cannot run here."""
    print(reason)
    sys.exit(EXIT_ABSENT)


def refuse(reason):
    """Ends the adapter: its mesher cannot take this image."""
    print(reason, file=sys.stderr)
    sys.exit(EXIT_ABSENT)


def parse_arguments(version):
    """The contract's options. Answers --version with version(options), which may call absent()."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--version", action="store_true")
    parser.add_argument("--podm", help="path of podm, which makes surfaces")
    parser.add_argument("--image")
    parser.add_argument("--output")
    parser.add_argument("--radius", type=float)
    parser.add_argument("--delta", type=float)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    if options.version:
        print(version(options))
        sys.exit(0)
    for path in ("podm", "image", "output"):  # programs run in the folder of the output
        setattr(options, path, os.path.abspath(getattr(options, path)))
    return options


def run(command, log_path):
    """Runs a program; returns what it printed, wall seconds and peak resident bytes. It must succeed."""
    start = time.perf_counter()
    with open(log_path, "w") as log:
        child = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, cwd=os.path.dirname(log_path))
        _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    text = pathlib.Path(log_path).read_text(errors="replace")
    if child.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit code {child.returncode}\n{text[-1500:]}")
    return text, time.perf_counter() - start, usage.ru_maxrss * 1024


def program(name):
    """Path of a program of PATH, or absent()."""
    return shutil.which(name) or absent(f"{name} is not installed")


def read_ply(path):
    """Label, points and triangles of a binary file of podm, the surface of one label."""
    with open(path, "rb") as file:
        counts = {}
        for line in iter(file.readline, b"end_header\n"):
            if line.startswith(b"element"):
                counts[line.split()[1]] = int(line.split()[2])
            if line.startswith(b"comment label"):
                label = int(line.split()[2])
        points = np.fromfile(file, "<f8", 3 * counts[b"vertex"]).reshape(-1, 3)
        faces = np.fromfile(file, np.dtype([("corners", "u1"), ("vertices", "<i4", 3)]), counts[b"face"])
    return label, points, faces["vertices"]


def boundary_surface(options):
    """podm's surface of the image: points, triangles, the labels on both sides of each (0: outside), seconds.

    podm writes a closed surface for each label; where two labels meet, their triangles are the same and become one."""
    surface = os.path.join(options.output, "surface")
    command = [options.podm, "mesh", options.image, "-o", surface + ".vtu", "--surface", surface + ".ply", "--quiet"]
    for name in ("radius", "delta"):
        if getattr(options, name):
            command += ["--" + name, str(getattr(options, name))]
    _, seconds, _ = run(command, surface + ".log")
    points, triangles, labels = [], [], []
    for path in sorted(pathlib.Path(options.output).glob("surface_*.ply")):
        label, points_of_label, triangles_of_label = read_ply(path)
        triangles.append(triangles_of_label + sum(map(len, points)))
        points.append(points_of_label)
        labels += [label] * len(triangles_of_label)
    points, renamed = np.unique(np.concatenate(points), axis=0, return_inverse=True)
    triangles = renamed.reshape(-1)[np.concatenate(triangles)]
    _, first, same = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True, return_inverse=True)
    sides = np.zeros((len(first), 2), int)
    np.maximum.at(sides[:, 0], same.reshape(-1), labels)
    np.add.at(sides[:, 1], same.reshape(-1), labels)
    sides[:, 1] -= sides[:, 0]
    return points, triangles[first], sides, seconds


def write_record(output, **record):
    """The one line that the contract asks for."""
    with open(os.path.join(output, "record.jsonl"), "w") as file:
        file.write(json.dumps(record) + "\n")
