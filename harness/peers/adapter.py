"""What the adapters of this folder share: the contract's command line, runs of podm, its surface, the record."""
import argparse
import dataclasses
import hashlib
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
# Phases of podm that turn the image in memory into a mesh in memory.
WHOLE = ("transform", "allocate", "octree", "initial", "refine", "closing", "extract")


def absent(reason):
    """Ends the adapter: its mesher cannot run here."""
    print(reason)
    sys.exit(EXIT_ABSENT)


def refuse(reason):
    """Ends the adapter: its mesher cannot take this image."""
    print(reason, file=sys.stderr)
    sys.exit(EXIT_ABSENT)


def parse_arguments(version, keeps_lines=False):
    """The contract's options. Answers --version with version(options), which may call absent()."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--version", action="store_true")
    parser.add_argument("--podm", help="path of podm, which makes surfaces")
    parser.add_argument("--image")
    parser.add_argument("--output")
    parser.add_argument("--radius", type=float)
    parser.add_argument("--delta", type=float)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--lines", action="store_true")
    options = parser.parse_args()
    if options.version:
        print(version(options))
        sys.exit(0)
    if options.lines and not keeps_lines:
        refuse("this mesher keeps no lines where labels meet")
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


def podm_version(options):
    """"podm 0.1.0 (1a2b3c4d5e6f)": its version and the beginning of its program's hash; "podm" where none is given."""
    if not options.podm:
        return "podm"
    version = subprocess.run([options.podm, "--version"], check=True, capture_output=True, text=True).stdout
    digest = hashlib.sha256(pathlib.Path(options.podm).read_bytes()).hexdigest()
    return f"{version.splitlines()[0]} ({digest[:12]})"


def run_podm(options, mesh, *switches, radius=None):
    """Meshes the image into the file `mesh`; returns podm's record."""
    record = mesh + ".jsonl"
    pathlib.Path(record).unlink(missing_ok=True)  # podm appends
    command = [options.podm, "mesh", options.image, "-o", mesh, "--record", record, "--quiet",
               "--threads", str(options.threads), *switches]
    for name, bound in (("--radius", radius), ("--delta", options.delta)):
        command += [name, repr(bound)] if bound else []
    run(command, mesh + ".log")
    return json.loads(pathlib.Path(record).read_text())


def whole_seconds(record):
    """Seconds of podm from the image in memory to the mesh in memory."""
    return sum(seconds for phase, seconds in record["phases_s"].items() if phase in WHOLE)


def surface_alone(options, *switches):
    """podm's record of a mesh that the surface alone drives: the surface of any radius that is not far below delta.

    Without delta podm derives delta from the radius, so the radius is given then and all its cells are made."""
    radius = None if options.delta else options.radius
    return run_podm(options, os.path.join(options.output, "surface.vtu"), *switches, radius=radius)


def evidence_of(record):
    """What a row keeps of another run of podm."""
    return {key: record[key] for key in ("cells", "vertices", "boundary_facets", "phases_s", "mesh_sha256")}


@dataclasses.dataclass(frozen=True)
class Surface:
    """The boundary that podm has made. `sides`: the labels on both sides of each triangle (0: outside). `seconds`:
    from the image in memory to the mesh in memory that has this boundary. `evidence`: of that run."""

    points: np.ndarray
    triangles: np.ndarray
    sides: np.ndarray
    seconds: float
    evidence: dict


def boundary_surface(options):
    """podm writes a closed surface for each label; where two labels meet, their triangles are the same and become
    one."""
    record = surface_alone(options, "--surface", os.path.join(options.output, "surface.ply"))
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
    return Surface(points, triangles[first], sides, whole_seconds(record), evidence_of(record))


def write_record(output, **record):
    """The one line that the contract asks for."""
    with open(os.path.join(output, "record.jsonl"), "w") as file:
        file.write(json.dumps(record) + "\n")
