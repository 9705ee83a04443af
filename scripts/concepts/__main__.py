"""Draws the pictures of docs/concepts, of runs on a phantom: the same on any machine.

Exit codes: 0 drawn, 1 podm failed, 2 bad usage.
"""
import argparse
import io
import subprocess
import sys
import tempfile
from pathlib import Path

import nibabel
import numpy
from figures.fig2b import fig2b
from figures.schedule import read_schedule
from PIL import Image
from views.read_mesh import read_mesh

from .operation_log import read_log
from .pictures import conflict, operations, refinement
from .triangulation import Labels

ROOT = Path(__file__).resolve().parents[2]
ONE_WORKER = ["--threads", "1"]
MANY_WORKERS = ["--executor", "virtual", "--threads", "16", "--seed", "1"]
LEAVES = [*MANY_WORKERS, "--algorithm", "pdr-podm", "--nodes", "4", "--cores-per-node", "4", "--initial-ratio", "2"]


def runs(podm, size, radius, folder):
    """The image, and what three runs left in the folder."""
    image = folder / "image.nii.gz"
    subprocess.run([podm, "phantom", "abdomen", "--size", str(size), "-o", image], check=True, capture_output=True)
    for name, arguments in (("one", ONE_WORKER), ("many", MANY_WORKERS),
                            ("leaves", [*LEAVES, "--schedule", folder / "leaves.jsonl"])):
        subprocess.run([podm, "mesh", image, "--radius", str(radius), "--delta", str(radius), *arguments, "--quiet",
                        "--log", folder / f"{name}.log", "-o", folder / f"{name}.vtu"], check=True)
    return nibabel.load(image)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="concept_pictures", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--podm", type=Path, default=ROOT / "build" / "bin" / "podm", help="default: build/bin/podm")
    parser.add_argument("--size", type=int, default=128, help="voxels of the phantom along an axis (default: 128)")
    parser.add_argument("--radius", type=float, default=12, help="of the cells, mm (default: 12)")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "docs" / "concepts" / "pictures",
                        help="folder (default: docs/concepts/pictures)")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            image = runs(options.podm.resolve(), options.size, options.radius, folder)
        except (OSError, subprocess.CalledProcessError) as error:
            print(f"concept_pictures: {error}", file=sys.stderr)
            return 1
        labels = Labels(numpy.asarray(image.dataobj).astype(int), numpy.linalg.inv(image.affine))
        log = read_log(folder / "one.log")
        figures = {"refinement": refinement(log, labels), "operations": operations(log, labels),
                   "conflict": conflict(read_log(folder / "many.log")),
                   "leaves": fig2b(read_schedule(folder / "leaves.jsonl"), read_mesh(folder / "leaves.vtu"))}
    options.output.mkdir(parents=True, exist_ok=True)
    for name, figure in figures.items():
        figure.patch.set(alpha=1, facecolor="white")
        made = io.BytesIO()
        figure.savefig(made, dpi=110)
        Image.open(made).convert("RGB").quantize(128).save(options.output / f"{name}.png", optimize=True)
    print(f"concept_pictures: {len(figures)} pictures in {options.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
