"""Computes the hashes of a fixed set of meshes, made on one thread and by 64 workers in virtual time. The hashes show
whether a program still makes the same meshes.

Exit codes: 0 written or equal, 1 a hash differs, 2 bad usage or input.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from figures.whole_file import write_json

ROOT = Path(__file__).resolve().parents[2]
HASHES = ROOT / "results" / "reference" / "canonical_hashes.json"
SCHEMA = "podm-canonical-hashes/1"
LONGEST_S = 1200  # of one mesh, also where the processor is emulated
VIRTUAL = ["--executor", "virtual", "--threads", "64", "--seed", "1", "--pin", "compact",
           "--topology", "experiments/machines/blacklight.toml"]
MESHES = {
    "abdomen": ["phantom:abdomen@64", "--radius", "12"],
    "spheres": ["phantom:spheres@48", "--delta", "2"],
    "smooth-torus": ["phantom:torus@40", "--radius", "12", "--smooth", "6"],
    "no-slivers": ["phantom:abdomen@48", "--radius", "16", "--min-dihedral", "8", "--optimize"],
    "sizes": ["phantom:spheres@48", "--radius", "8", "--size-near", "1,0=2:3", "--grade", "0.3"],
    "leaves": ["phantom:abdomen@64", "--radius", "12", "--algorithm", "pdr-podm"],
    "virtual-podm": ["phantom:abdomen@64", "--radius", "10", *VIRTUAL],
    "virtual-pdr-podm": ["phantom:abdomen@64", "--radius", "10", "--algorithm", "pdr-podm", "--cores-per-node", "16",
                         *VIRTUAL],
    "virtual-podm-home": ["phantom:abdomen@64", "--radius", "10", "--algorithm", "podm-home", "--cores-per-node", "16",
                          *VIRTUAL],
}


class HashesError(Exception):
    """A mesh that was not made, or hashes that cannot be read; the text gives the name and the reason."""


def compute(program):
    """Returns {name: {"arguments": [...], "mesh_sha256": ...}} of MESHES."""
    with tempfile.TemporaryDirectory() as folder:
        return {name: {"arguments": arguments, "mesh_sha256": _hash_of(program, name, arguments, Path(folder))}
                for name, arguments in MESHES.items()}


def _hash_of(program, name, arguments, folder):
    record = folder / f"{name}.jsonl"
    try:
        done = subprocess.run([program, "mesh", *arguments, "--quiet", "--record", record, "-o", folder / "mesh.vtu"],
                              cwd=ROOT, capture_output=True, text=True, check=False, timeout=LONGEST_S)
    except subprocess.TimeoutExpired as error:
        raise HashesError(f"{name}: {program} did not end within {LONGEST_S} s") from error
    if not record.exists():
        raise HashesError(f"{name}: {program} ended with {done.returncode}: {done.stderr.strip()}")
    return json.loads(record.read_text())["mesh_sha256"]


def read(path):
    """Reads the hashes of a file. Raises HashesError."""
    try:
        found = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise HashesError(f"{path}: {error}") from None
    if not isinstance(found, dict) or found.get("schema") != SCHEMA:
        raise HashesError(f"{path}: not hashes of schema {SCHEMA}")
    return found["meshes"]


def differences(ours, theirs):
    """Returns the names of the meshes that differ, or that only one side has."""
    return [name for name in sorted({*ours, *theirs}) if ours.get(name) != theirs.get(name)]


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="canonical_hashes", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--podm", type=Path, default=ROOT / "build/bin/podm", help="the program (default: %(default)s)")
    parser.add_argument("--write", type=Path, nargs="?", const=HASHES, metavar="FILE",
                        help=f"write the hashes (default: {HASHES.relative_to(ROOT)}); beside new rows, "
                             "results/reference/RELEASE/WHAT/canonical_hashes.json")
    options = parser.parse_args(arguments)
    try:
        found = compute(options.podm.resolve())
        if options.write:
            write_json(options.write, {"schema": SCHEMA, "meshes": found})
            return 0
        changed = differences(found, read(HASHES))
    except (HashesError, OSError) as error:
        print(f"canonical_hashes: {error}", file=sys.stderr)
        return 2
    for name in changed:
        print(f"canonical_hashes: {name} is another mesh, or of other arguments, than in {HASHES.relative_to(ROOT)}; "
              "where that is meant, scripts/canonical_hashes --write", file=sys.stderr)
    return 1 if changed else 0
