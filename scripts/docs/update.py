"""Writes the generated tables of the documentation, and with --figures every figure, from their rows.

Exit codes: 0 written, 1 something could not be computed and was left unchanged, 2 bad usage or input.
"""
import argparse
import sys
from pathlib import Path

from figures.whole_file import write_text

from .audit import pages_of
from .errors import DocsError
from .page import Page
from .provenance import Provenance
from .query import answer, parse_query
from .sources import ROOT, Sources
from .tables import generate


def updated(page, sources, provenance, has_figures):
    """Returns (the new text of the page, faults as (place, words))."""
    changes, faults = [], list(page.faults)
    for table in page.tables:
        _try(lambda: generate(table.name, table.arguments, sources, provenance), table, changes, faults)  # noqa: B023
    for figure in page.figures if has_figures else []:
        _try(lambda: answer(parse_query(figure.query, page.rows), sources, provenance)[0],  # noqa: B023
             figure, changes, faults)
    text = page.text
    for start, end, new in sorted(changes, reverse=True):
        text = text[:start] + new + text[end:]
    return text, faults


def _try(compute, part, changes, faults):
    try:
        changes.append((part.start, part.end, compute()))
    except DocsError as error:
        faults.append((part.start, str(error)))


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="update_docs", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=Path, default=ROOT, help="the tree (default: this one)")
    parser.add_argument("--figures", action="store_true", help="write figures too, not only tables")
    options = parser.parse_args(arguments)
    if not options.root.is_dir():
        print(f"update_docs: {options.root}: no such folder", file=sys.stderr)
        return 2
    sources, num_faults, num_written = Sources(options.root.resolve()), 0, 0
    provenance = Provenance(sources)
    for path in pages_of(sources.root):
        page = Page(path.read_text())
        text, faults = updated(page, sources, provenance, options.figures)
        if text != page.text:
            write_text(path, text)
            num_written += 1
        for place, words in faults:
            print(f"update_docs: {path.relative_to(sources.root)}:{page.line_of(place)}: {words}", file=sys.stderr)
        num_faults += len(faults)
    print(f"update_docs: {num_written} pages written")
    return 1 if num_faults else 0
