"""Makes the paper's tables and figures from records: CSV, Markdown, PDF and PNG, and a verdict for each cell.

Published, measured and simulated values stay apart, and no row gives a number unless its mesh verified.
Exit codes: 0 made, 2 bad usage or input.
"""
import argparse
import json
import sys
from pathlib import Path

from .load import RecordError, load
from .mesh import MeshError, read_vtu
from .outcome import make, readable_verdicts
from .schedule import ScheduleError, read_schedule
from .write import markdown, write_figure, write_json, write_text


class ReportError(Exception):
    """A report of podm-verify that cannot be read; the text names file and fault."""


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
                        help="JSON-lines files, or folders of them (default: results/runs)")
    parser.add_argument("--verified", type=Path, metavar="JSON", help="report of `podm-verify --json`, for the histograms")
    parser.add_argument("--schedule", type=Path, metavar="JSONL",
                        help="schedule of a run of pdr or pdr-podm, for figure 2 (b)")
    parser.add_argument("--mesh", type=Path, metavar="VTU", help="the mesh of that run, to be cut")


def read_inputs(arguments):
    """(records, report, schedule, mesh), the last three None where not asked for. Raises what INPUT_ERRORS lists."""
    records = load(arguments.records)
    report = read_report(arguments.verified) if arguments.verified else None
    schedule = read_schedule(arguments.schedule) if arguments.schedule else None
    mesh = read_vtu(arguments.mesh) if arguments.mesh else None
    return records, report, schedule, mesh


def read_report(path):
    try:
        report = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise ReportError(f"{path}: {error}") from None
    if not isinstance(report, dict) or report.get("schema") != "podm-verify/1":
        raise ReportError(f"{path}: not a report of schema podm-verify/1")
    return report


INPUT_ERRORS = (RecordError, MeshError, ScheduleError, ReportError)


def write(outcome, frame, folder):
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / "rows.csv", frame.to_csv(index=False))
    for name, (data, shown) in outcome.tables.items():
        write_text(folder / f"{name}.csv", data.to_csv(index=False))
        write_text(folder / f"{name}.md", markdown(shown))
    for name, figure in outcome.figures.items():
        write_figure(figure, folder, name)
    write_json(folder / "verdicts.json", outcome.verdicts)
    claims, cells = readable_verdicts(outcome.verdicts)
    write_text(folder / "verdicts.md", f"# Claims\n\n{markdown(claims)}\n# Cells of Tables 1 and 2\n\n{markdown(cells)}")


def main(arguments=None):
    arguments = parse_arguments(arguments)
    try:
        records, report, schedule, mesh = read_inputs(arguments)
    except INPUT_ERRORS as error:
        print(f"make_figures: {error}", file=sys.stderr)
        return 2
    outcome = make(records.frame, report, schedule, mesh)
    write(outcome, records.frame, arguments.output)
    for line in records.problems:
        print(f"make_figures: {line}", file=sys.stderr)
    for name, reason in outcome.missing.items():
        print(f"make_figures: {name} not drawn: {reason}", file=sys.stderr)
    print(f"make_figures: {len(records.frame)} rows; {', '.join([*outcome.tables, *outcome.figures])} in {arguments.output}",
          file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
