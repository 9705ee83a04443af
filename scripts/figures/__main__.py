"""Makes the paper's tables and figures from records: CSV, Markdown, PDF and PNG, and a verdict for each cell.

Published, measured and simulated values stay apart. Only rows whose mesh was verified give numbers.
Exit codes: 0 made, 2 bad usage or input.
"""
import argparse
import json
import sys
from pathlib import Path

from views.mesh import MeshError
from views.read_mesh import read_mesh

from .experiment_verdicts import HOW, WITHDRAWN, VerdictsError, counts, read_experiment_verdicts
from .load import RecordError, load
from .outcome import MEASURED_TABLES, make, readable_experiments, readable_verdicts
from .schedule import ScheduleError, read_schedule
from .whole_file import write_json, write_text
from .write import markdown, write_figure


class ReportError(Exception):
    """A report of podm-verify that cannot be read; the text names the file and the fault."""


def parse_arguments(arguments):
    parser = argparse.ArgumentParser(
        prog="make_figures", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add_inputs(parser)
    parser.add_argument("-o", "--output", type=Path, default=Path("results/runs/figures"),
                        help="folder (default: %(default)s)")
    return parser.parse_args(arguments)


def add_inputs(parser):
    parser.add_argument("--records", type=Path, nargs="+", default=[Path("results/runs")], metavar="PATH",
                        help="JSON-lines files, archives of podm-bench pack, or folders of both, such as one of "
                             "results/reference (default: results/runs)")
    parser.add_argument("--experiment-verdicts", type=Path, metavar="JSON",
                        help="of `podm-bench verdicts --json`: the claims of our experiments")
    parser.add_argument("--verified", type=Path, metavar="JSON",
                        help="report of `podm-verify --json`, for the histograms")
    parser.add_argument("--schedule", type=Path, metavar="JSONL",
                        help="schedule of a run of pdr or pdr-podm, for figure 2 (b)")
    parser.add_argument("--mesh", type=Path, metavar="MESH", help="the mesh of that run, to be cut")


def read_inputs(arguments):
    """Returns the records and the other inputs of `make`, which are None if not given. Raises the errors in
    INPUT_ERRORS."""
    def given(path, read):
        return read(path) if path else None

    return load(arguments.records), {
        "report": given(arguments.verified, read_report), "schedule": given(arguments.schedule, read_schedule),
        "mesh": given(arguments.mesh, read_mesh),
        "experiments": given(arguments.experiment_verdicts, read_experiment_verdicts)}


def read_report(path):
    try:
        report = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise ReportError(f"{path}: {error}") from None
    if not isinstance(report, dict) or report.get("schema") != "podm-verify/1":
        raise ReportError(f"{path}: not a report of schema podm-verify/1")
    return report


INPUT_ERRORS = (RecordError, MeshError, ScheduleError, ReportError, VerdictsError)


def write(outcome, frame, folder):
    folder.mkdir(parents=True, exist_ok=True)
    rows = frame.drop(columns="dihedral_deg.counts", errors="ignore")
    write_text(folder / "rows.csv", rows.to_csv(index=False))
    for name, (data, shown) in outcome.tables.items():
        write_text(folder / f"{name}.csv", data.to_csv(index=False))
        remarks = outcome.remarks if name in MEASURED_TABLES else []
        write_text(folder / f"{name}.md", "".join(f"{remark}\n\n" for remark in remarks) + markdown(shown))
    for name, figure in outcome.figures.items():
        write_figure(figure, folder, name)
    write_json(folder / "verdicts.json", outcome.verdicts)
    claims, cells = readable_verdicts(outcome.verdicts)
    experiments = markdown(readable_experiments(outcome.experiments)) if outcome.experiments else HOW + "\n"
    write_text(folder / "verdicts.md",
               f"# Claims of the paper\n\n{markdown(claims)}\n# Claims of the experiments\n\n{experiments}\n"
               f"# Cells of Tables 1 and 2\n\n{markdown(cells)}")


def print_experiments(found):
    """Prints a line for each claim of the experiments."""
    if found is None:
        print(HOW)
        return
    for line in readable_experiments(found).to_dict("records"):
        what = line["statement"] or line["claim"]
        basis = "" if line["verdict"] == WITHDRAWN else f" ({line['basis']})"
        print(f"{line['verdict'].replace('_', ' '):18} {line['experiment']}: {what}{basis}: {line['reason']}")
    print(f"claims of experiments: {counts(found)}")


def main(arguments=None):
    arguments = parse_arguments(arguments)
    try:
        records, others = read_inputs(arguments)
    except INPUT_ERRORS as error:
        print(f"make_figures: {error}", file=sys.stderr)
        return 2
    outcome = make(records.frame, **others)
    write(outcome, records.frame, arguments.output)
    print_experiments(outcome.experiments)
    for line in records.problems:
        print(f"make_figures: {line}", file=sys.stderr)
    for name, reason in outcome.missing.items():
        print(f"make_figures: {name} not drawn: {reason}", file=sys.stderr)
    made = ", ".join([*outcome.tables, *outcome.figures])
    print(f"make_figures: {len(records.frame)} rows; {made} in {arguments.output}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
