"""Runs of many workers on small and odd images, each verified by podm-verify and replayed to the same hash.

Every run is drawn from its seed alone: `stress.py --first SEED --virtual 1 --threads 0` repeats a virtual one.
$PODM_PROGRAM is the podm program. Exits with 1 when a run fails, and names its seed and command.
"""

import argparse
import concurrent.futures
import os
import pathlib
import random
import subprocess
import sys
import tempfile

import small_images
from podm_process import PROGRAM

VERIFIER = os.path.join(os.path.dirname(PROGRAM), "podm-verify")
MANAGERS = ["aggressive", "random", "global", "local"]
TIMEOUT_S = 300
SIZE = 10


def write_images(folder):
    """Images whose interfaces are as degenerate as voxels can make them: paths or phantoms, and a small radius, mm."""
    voxels = small_images.voxels_of
    shapes = {
        "ball": small_images.ball_voxels(SIZE),
        "voxel": voxels(SIZE, lambda x, y, z: x == y == z == 5),
        "slice": voxels(SIZE, lambda x, y, z: z == 4),
        "full": voxels(SIZE, lambda x, y, z: 1),
        "checkerboard": voxels(SIZE, lambda x, y, z: (x + y + z) % 2),
        "three_labels": voxels(SIZE, lambda x, y, z: 1 + (x > 4) + (y > 4) if z > 2 else 0),
        "edge_contact": voxels(SIZE, lambda x, y, z: (x < 5) == (y < 5) and 0 < x < 9 and 0 < y < 9),
        "noise": voxels(SIZE, lambda x, y, z: hash((x, y, z)) % 3),
    }
    images = [(small_images.write_nifti(folder / f"{name}.nii", shape, (SIZE, SIZE, SIZE)),
               {"voxel": 0.1, "slice": 0.3}.get(name, 1)) for name, shape in shapes.items()]
    return images + [("phantom:spheres@20", 5), ("phantom:torus@24", 5), ("phantom:abdomen@24", 16)]


def draw(seed, is_virtual, images):
    """The arguments of `podm mesh`, all but its outputs."""
    rng = random.Random(2 * seed + is_virtual)
    image, radius_mm = rng.choice(images)
    threads = round(2 ** rng.uniform(1, 8 if is_virtual else 4))
    algorithm = rng.choice(["podm", "podm", "pdr", "pdr-podm"])
    arguments = [image, "--radius", f"{radius_mm * 2 ** rng.uniform(0, 2.5):.3f}", "--threads", threads,
                 "--contention", rng.choice(MANAGERS), "--seed", seed]
    arguments += ["--begging", rng.choice(["random", "hierarchical"]), "--oversubscribe"]
    if algorithm != "podm":
        arguments += ["--algorithm", algorithm, "--initial-ratio", rng.choice([1, 2, 4, 7.5]),
                      "--initial-threads", rng.randint(1, threads)]
        if rng.random() < 0.5:
            arguments += ["--leaf-size", f"{radius_mm * 2 ** rng.uniform(0, 5):.3f}"]
    if algorithm == "pdr-podm":
        nodes = rng.choice([n for n in range(1, threads + 1) if threads % n == 0])
        arguments += ["--nodes", nodes]
    if is_virtual:
        arguments += ["--executor", "virtual", "--virtual-cost", rng.choice(["unit", "measured"])]
    return [str(argument) for argument in arguments]


def call(*arguments):
    process = subprocess.run(arguments, capture_output=True, text=True, timeout=TIMEOUT_S)
    return None if process.returncode == 0 else f"exit {process.returncode}: {process.stderr.strip()[-2000:]}"


def fault_of(seed, is_virtual, images):
    """What is wrong with the run; None when it ends, verifies and equals its replay."""
    arguments = draw(seed, is_virtual, images)
    with tempfile.TemporaryDirectory() as folder:
        mesh, log = os.path.join(folder, "out.vtu"), os.path.join(folder, "run.log")
        try:
            leaves = ["--schedule", os.path.join(folder, "leaves.jsonl")] if "--algorithm" in arguments else []
            fault = call(PROGRAM, "mesh", *arguments, "-o", mesh, "--log", log, "--verify", *leaves) \
                or call(PROGRAM, "replay", arguments[0], log) \
                or (leaves and call(VERIFIER, mesh, *leaves))
        except subprocess.TimeoutExpired:
            fault = f"did not end within {TIMEOUT_S} s"
    return fault and f"seed {seed}: podm mesh {' '.join(arguments)}\n{fault}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--virtual", type=int, default=2000, help="runs in virtual time [%(default)s]")
    parser.add_argument("--threads", type=int, default=200, help="runs on threads [%(default)s]")
    parser.add_argument("--first", type=int, default=1, help="seed of the first run of each kind [%(default)s]")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, \
            concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        images = write_images(pathlib.Path(folder))
        runs = [(seed, is_virtual) for is_virtual, count in ((True, options.virtual), (False, options.threads))
                for seed in range(options.first, options.first + count)]
        faults, ended = [], 0
        for fault in pool.map(lambda run: fault_of(*run, images), runs):
            ended += 1
            if fault:
                faults.append(fault)
                print(fault, file=sys.stderr)
            if sys.stderr.isatty():
                print(f"\r{ended} of {len(runs)} runs, {len(faults)} failed ", end="", file=sys.stderr)
    print(f"{options.virtual} virtual runs and {options.threads} runs on threads: {len(faults)} failed",
          file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
