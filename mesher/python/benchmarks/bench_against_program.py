"""Compares podm.mesh with podm mesh on the same image: seconds of alternating runs, and peak memory of each.

    PYTHONPATH=build/python /usr/bin/python3 mesher/python/benchmarks/bench_against_program.py build/bin/podm

Both read the same voxels, mesh and write a .vtu: the program from a .nii file, Python from an array in memory, each in
a process of its own. Prints the ratio of the medians of seconds for each order, and exits with 1 if one is above the
bound. The peak memory of Python is the increase over its memory with the array.
"""

import argparse
import json
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

import nibabel
import numpy as np

BOUND = 1.03

IN_PYTHON = """
import json, sys, time
import numpy as np, podm
image_path, mesh_path, order, radius, threads = sys.argv[1:]
image = np.array(np.load(image_path), order=order)
affine = np.load(image_path + ".affine.npy")
def peak():
    return 1024 * int(next(line for line in open("/proc/self/status") if line.startswith("VmHWM")).split()[1])
before = peak()
start = time.monotonic()
mesh = podm.mesh(image, affine=affine, radius=float(radius), threads=int(threads))
mesh.save(mesh_path)
print(json.dumps({"seconds": time.monotonic() - start, "cells": len(mesh.cells), "peak": peak() - before}))
"""


def run_python(folder, order, arguments):
    command = [sys.executable, "-c", IN_PYTHON, folder / "image.npy", folder / "mesh.vtu", order, str(arguments.radius),
               str(arguments.threads)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def run_program(folder, arguments):
    command = [arguments.program, "mesh", folder / "image.nii", "-o", folder / "mesh.vtu", "--radius",
               str(arguments.radius), "--threads", str(arguments.threads)]
    start = time.monotonic()
    stderr = subprocess.run(command, check=True, capture_output=True, text=True).stderr
    seconds = time.monotonic() - start
    return {"seconds": seconds, "peak": float(re.search(r"^memory +(\S+) GiB", stderr, re.MULTILINE)[1]) * 2**30}


def make_image(folder, program, size):
    """Makes the phantom, as a file for the program and as a file of numpy."""
    path = folder / "image.nii"
    subprocess.run([program, "phantom", "abdomen", "--size", str(size), "-o", path], check=True, capture_output=True)
    image = nibabel.load(path)
    np.save(folder / "image.npy", np.asarray(image.dataobj))
    np.save(folder / "image.npy.affine.npy", image.affine)
    return image.shape


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path, help="podm")
    parser.add_argument("--size", type=int, default=320, help="of the phantom, voxels (default: %(default)s)")
    parser.add_argument("--radius", type=float, default=3.1, help="mm: some 3 million cells (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=1, help="of both (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=5, help="runs of each, in turns (default: %(default)s)")
    arguments = parser.parse_args()
    seconds = {"program": [], "C": [], "F": []}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        shape = make_image(folder, arguments.program, arguments.size)
        for round_number in range(arguments.rounds):
            of_program = run_program(folder, arguments)
            seconds["program"].append(of_program["seconds"])
            for order in "CF":
                run = run_python(folder, order, arguments)
                seconds[order].append(run["seconds"])
            print(f"round {round_number}: {run['cells']} cells, podm mesh {seconds['program'][-1]:.2f} s, podm.mesh "
                  f"{seconds['C'][-1]:.2f} s (C), {seconds['F'][-1]:.2f} s (F), peak above the array "
                  f"{run['peak'] / 2**20:.0f} MiB, podm mesh {of_program['peak'] / 2**20:.0f} MiB in all", flush=True)
    median = {which: statistics.median(runs) for which, runs in seconds.items()}
    ratios = {order: median[order] / median["program"] for order in "CF"}
    print(f"{' x '.join(map(str, shape))} voxels; medians of {arguments.rounds}: podm mesh {median['program']:.2f} s; "
          + "; ".join(f"{order} order {median[order]:.2f} s, ratio {ratio:.3f}" for order, ratio in ratios.items()))
    return int(max(ratios.values()) > BOUND)


if __name__ == "__main__":
    sys.exit(main())
