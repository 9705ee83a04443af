"""Judges the claims of all experiments by the rows in a folder and its subfolders, such as results/reference/0.1.0, and
writes the verdicts into one file.

Each folder with rows of an experiment judges it separately, as rows of two folders do not come from one run. Exit
codes: 0 written, 2 bad usage or input.
"""
import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from .experiment_verdicts import SCHEMA, VerdictsError, read_experiment_verdicts
from .whole_file import write_text

ROOT = Path(__file__).resolve().parents[2]
EXPERIMENTS = ROOT / "experiments"


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(prog="reference_verdicts", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="rows, NAME.jsonl of each experiment NAME")
    parser.add_argument("-o", "--output", type=Path, help="file (default: verdicts.json in the folder)")
    parser.add_argument("--bench", type=Path, default=ROOT / "build" / "bin" / "podm-bench", metavar="PODM_BENCH",
                        help="program (default: %(default)s)")
    return parser.parse_args(arguments)


def folders_of(name, folder):
    """Returns the folders with rows of the experiment. Without rows it returns `folder`, so that its claims are
    undecided."""
    return sorted({path.parent for path in folder.rglob(f"{name}.jsonl")}) or [folder]


def judge(bench, experiment, folder):
    """Returns the entry of podm-bench's verdicts. Raises VerdictsError."""
    with tempfile.TemporaryDirectory() as aside:
        made = Path(aside) / "verdicts.json"
        done = subprocess.run([bench, "verdicts", "--results", folder, "--json", made, experiment],
                              capture_output=True, text=True)
        if done.returncode != 0:
            raise VerdictsError(f"{bench} verdicts {experiment}: {done.stderr.strip()}")
        (entry,) = read_experiment_verdicts(made)["experiments"]
        return entry


def verdicts(bench, folder):
    """Judges all experiments in the order of their names. `rows` is the folder below `folder`. Raises VerdictsError."""
    entries = [{**judge(bench, experiment, rows), "rows": str(rows.relative_to(folder))}
               for experiment in sorted(EXPERIMENTS.glob("*.toml")) for rows in folders_of(experiment.stem, folder)]
    return {"schema": SCHEMA, "experiments": entries}


def main(arguments=None):
    arguments = parse_arguments(arguments)
    output = arguments.output or arguments.folder / "verdicts.json"
    try:
        if not arguments.folder.is_dir():
            raise VerdictsError(f"{arguments.folder}: no such folder")
        write_text(output, json.dumps(verdicts(arguments.bench, arguments.folder), indent=1) + "\n")
    except (VerdictsError, OSError) as error:
        print(f"reference_verdicts: {error}", file=sys.stderr)
        return 2
    print(f"reference_verdicts: {output}", file=sys.stderr)
    return 0
