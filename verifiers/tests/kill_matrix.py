"""Tests the verifier: the claim that a mutant attacks must reject it, and must accept its harmless neighbour.

Usage: kill_matrix.py PODM PODM_VERIFY [RANKS]. Prints the matrix. Exits with 1 if it has a hole: a mutant ALIVE, a
mutant that offends against a claim it must pass (IMPURE), or a neighbour REJECTED. With RANKS, PODM_VERIFY is
podm-verify-mpi: it judges the meshes in pieces on RANKS ranks. A mesh that cannot be in pieces is left out.
"""

import dataclasses
import json
import pathlib
import subprocess
import sys
import tempfile

from box_mutants import OPERATORS
from medit_mesh import MeditMesh
from mutants import Mutant, MutantFixture
from pvtu_mesh import MeshInPieces

NOT_ON_RANKS = ("box", "lines", "topology")  # claims that podm-verify-mpi refuses


def run(verifier, case, claim, folder):
    """Returns the exit code and verdict of the claim (None without a report), and its warnings."""
    mesh, report = folder / f"case{getattr(case.mesh, 'extension', '.mesh')}", folder / "report.json"
    report.unlink(missing_ok=True)
    if isinstance(case.mesh, str):
        mesh.write_text(case.mesh)
    else:
        case.mesh.write(mesh, case.digits)
    claims = ["--claims", claim] if claim else []
    process = subprocess.run([verifier, mesh, "--json", report, *claims, *case.options], capture_output=True, text=True,
                             timeout=300, check=False)
    if process.returncode not in (0, 1) or not report.exists():
        return process.returncode, None, 0
    result = json.loads(report.read_text())["claims"][claim or "structure"]
    return process.returncode, result["verdict"], result["num_warnings"]


def in_pieces(case, num_pieces):
    """Returns the case with its mesh in pieces; None if it cannot be."""
    if isinstance(case.mesh, MeshInPieces):
        return case
    if not isinstance(case.mesh, MeditMesh) or case.digits != 17:
        return None
    return dataclasses.replace(case, mesh=MeshInPieces(case.mesh, num_pieces))


def pair_on_ranks(pair, num_ranks):
    """Returns a mutant and its neighbour in more pieces than ranks; None if that is not possible."""
    cases = [in_pieces(case, num_ranks + 1) for case in (pair.mutant, pair.neighbour)]
    if None in cases:
        return None
    for case in cases:
        case.options = [*case.options, "--in-process", str(num_ranks)]
    return Mutant(*cases, tuple(claim for claim in pair.still_passes if claim not in NOT_ON_RANKS))


def word(is_killed, is_pure):
    return "ALIVE" if not is_killed else "killed" if is_pure else "IMPURE"


def main():
    podm, verifier = sys.argv[1:3]
    num_ranks = int(sys.argv[3]) if len(sys.argv) > 3 else 0
    holes = 0
    print(f"{'operator':<35} {'claim':<16} {'mutant':<10} neighbour")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        fixture = MutantFixture(podm, folder)
        for function, claim, exit_code in OPERATORS:
            pair = function(fixture)
            if num_ranks > 0:
                pair = pair_on_ranks(pair, num_ranks) if claim not in NOT_ON_RANKS else None
            if pair is None:
                print(f"{function.__name__:<35} not of a mesh in pieces")
                continue
            code, verdict, _ = run(verifier, pair.mutant, claim, folder)
            is_killed = code == exit_code and verdict == ("fail" if claim else None)
            is_pure = all(run(verifier, pair.mutant, other, folder)[:2] == (0, "pass") for other in pair.still_passes)
            code, verdict, warnings = run(verifier, pair.neighbour, claim or "structure", folder)
            is_accepted = code == 0 and verdict == "pass" and warnings == pair.neighbour.warnings
            holes += (not is_killed) + (not is_pure) + (not is_accepted)
            print(f"{function.__name__:<35} {claim or 'the reader':<16} {word(is_killed, is_pure):<10} "
                  f"{'accepted' if is_accepted else 'REJECTED'}   {function.__doc__}")
    print(f"{len(OPERATORS)} operators, {holes} holes")
    return 1 if holes else 0


if __name__ == "__main__":
    sys.exit(main())
