"""Tests the verifier: the claim that a mutant attacks must reject it, and must accept its harmless neighbour.

Usage: kill_matrix.py PODM PODM_VERIFY. Prints the matrix. Exits with 1 if it has a hole: a mutant ALIVE, a mutant that
offends against a claim it must pass (IMPURE), or a neighbour REJECTED.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

from mutants import MutantFixture
from tolerance_mutants import OPERATORS


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


def word(is_killed, is_pure):
    return "ALIVE" if not is_killed else "killed" if is_pure else "IMPURE"


def main():
    podm, verifier = sys.argv[1:]
    holes = 0
    print(f"{'operator':<35} {'claim':<16} {'mutant':<10} neighbour")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        fixture = MutantFixture(podm, folder)
        for function, claim, exit_code in OPERATORS:
            pair = function(fixture)
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
