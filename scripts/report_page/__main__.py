"""Makes one HTML page from records. It answers four questions: does it work, how fast is it, how does it scale, which
claims of the paper hold. The details follow: verdicts, tables, figures, a mesh to turn and cut, the environment.

It needs no network. Exit codes: 0 made, 2 bad usage or input.
"""
import argparse
import sys
from pathlib import Path

from figures.__main__ import INPUT_ERRORS, add_inputs, read_inputs
from figures.outcome import make
from figures.whole_file import write_text

from .page import page
from .viewer import TooManyCells, pack


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="report", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add_inputs(parser)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/runs/report.html"),
                        help="file (default: %(default)s)")
    arguments = parser.parse_args(arguments)
    try:
        records, others = read_inputs(arguments)
    except INPUT_ERRORS as error:
        print(f"report: {error}", file=sys.stderr)
        return 2
    packed, fault = None, "No mesh was given (--mesh)."
    try:
        packed = pack(others["mesh"]) if others["mesh"] else None
    except TooManyCells as error:
        fault = f"No mesh is shown: {error}."
        print(f"report: {error}", file=sys.stderr)
    outcome = make(records.frame, **others)
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    write_text(arguments.output, page(records, outcome, packed, fault))
    for line in records.problems:
        print(f"report: {line}", file=sys.stderr)
    print(f"report: {len(records.frame)} rows, {arguments.output}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
