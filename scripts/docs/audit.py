"""Recomputes every figure of the documentation from the rows that its query names, and every generated table.

Exit codes: 0 all agree, 1 something does not, 2 bad usage or input.
"""
import argparse
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from .errors import DocsError
from .freshness import stale_folders
from .page import Page
from .provenance import Provenance
from .query import answer, parse_query
from .sources import ROOT, Sources
from .tables import generate


@dataclass
class Report:
    """`faults`: "file:line: words". `folders`: RELEASE/WHAT of the rows that the figures and tables use."""

    faults: list
    folders: set
    num_figures: int = 0
    num_tables: int = 0
    num_marked: int = 0


def pages_of(root):
    """Returns every Markdown file that git tracks or would track; without git, every one outside build folders."""
    listed = subprocess.run(["git", "-C", root, "ls-files", "-z", "--cached", "--others", "--exclude-standard", "*.md"],
                            capture_output=True, text=True, check=False)
    if listed.returncode == 0 and listed.stdout:
        return sorted(root / name for name in listed.stdout.split("\0") if name and (root / name).exists())
    return sorted(path for path in root.rglob("*.md")
                  if not any(part.startswith((".", "build")) for part in path.relative_to(root).parts))


def audit(root):
    sources, report = Sources(root), Report([], set())
    provenance = Provenance(sources)
    for path in pages_of(sources.root):
        _audit_page(path, sources, provenance, report)
    return report


def _audit_page(path, sources, provenance, report):
    page, name = Page(path.read_text()), path.relative_to(sources.root)

    def fault(place, words):
        report.faults.append(f"{name}:{page.line_of(place)}: {words}")

    for place, words in page.faults:
        fault(place, words)
    for figure in page.figures:
        try:
            query = parse_query(figure.query, page.rows)
            expected, _ = answer(query, sources, provenance)
            report.folders |= {sources.release_folder(one) for one in query.rows.names}
            if figure.text != expected:
                fault(figure.start, f"'{figure.text}' is {expected} by its rows")
        except DocsError as error:
            fault(figure.start, f"'{figure.text}': {error}")
    for table in page.tables:
        try:
            if generate(table.name, table.arguments, sources, provenance) != table.body:
                fault(table.start, f"table {table.name} is not what its rows give; scripts/update_docs writes it")
            report.folders |= {sources.release_folder(file) for one in table.arguments for file in sources.files(one)}
        except DocsError as error:
            fault(table.start, str(error))
    for number in page.uncovered:
        fault(number.start, f"'{number.text}' has neither a query nor the mark 'not measured'")
    report.num_figures += len(page.figures)
    report.num_tables += len(page.tables)
    report.num_marked += page.num_marked


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="audit", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=Path, default=ROOT, help="the tree (default: this one)")
    options = parser.parse_args(arguments)
    if not options.root.is_dir():
        print(f"audit: {options.root}: no such folder", file=sys.stderr)
        return 2
    report = audit(options.root.resolve())
    warnings, faults = stale_folders(options.root.resolve(), report.folders - {None})
    for line in [*report.faults, *faults]:
        print(f"audit: {line}", file=sys.stderr)
    for line in warnings:
        print(f"audit: warning: {line}", file=sys.stderr)
    print(f"audit: {report.num_figures} figures and {report.num_tables} tables recomputed, {report.num_marked} numbers "
          f"marked as not measured, {len(report.faults) + len(faults)} faults")
    return 1 if report.faults or faults else 0
