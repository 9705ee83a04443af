"""Reads rows of trials (results/README.md) into one table."""
import json
from dataclasses import dataclass
from pathlib import Path

import pandas

SCHEMAS = (1, 2)
# A mesh counts as verified when these pass and no other claim fails; the rest may lack an input, such as the image.
NEEDED_CLAIMS = ("structure", "delaunay", "radius_edge", "boundary_angles")
SIMULATED_CACHES = "its seconds are those of a simulation of caches"
LONG_LISTS = ["labels", "facet_pairs", "command"]


class RecordError(Exception):
    """Records that cannot be read; the text names file, line and fault."""


@dataclass(frozen=True)
class Records:
    """`frame`: one line a trial, nested keys joined by dots, and the columns of `derived`. `problems`: what was
    skipped."""

    frame: pandas.DataFrame
    problems: list


def load(paths):
    """Rows of the JSON-lines files in `paths` (files, or folders whose *.jsonl are read). Raises RecordError."""
    rows, problems = [], []
    for path in _files(paths):
        rows += _read_file(path, problems)
    frame = pandas.json_normalize([{**row, **derived(row)} for row in rows], sep=".")
    return Records(frame.drop(columns=LONG_LISTS, errors="ignore"), problems)


def derived(row):
    """What the figures need of a row, under one name whatever the schema; None where the trial made no mesh."""
    phases = row.get("phases_s") or {}
    if row.get("virtual"):  # what was simulated; the other phases ran on the machine at hand
        phases = {"refine": row["virtual"]["refine_s"]}
    doubt = doubt_of(row)
    return {
        "basis": "simulated" if row.get("executor") == "virtual" or simulates_caches(row) else "measured",
        "machine": row.get("environment", {}).get("cpu", "unknown machine"),
        "usable_cores": usable_cores(row.get("environment", {})),
        "build": build_of(row),
        "cores": row.get("threads", {}).get("used"),
        "seconds": sum(phases.values()) - phases.get("write", 0.0) if phases else None,
        "headline": not doubt,
        "doubt": doubt,
    }


def simulates_caches(row):
    """Whether valgrind ran the mesher: its counts are simulated, its times mean nothing."""
    counters = (row.get("process") or {}).get("counters", {})
    return any("simulated" in counter["source"] for counter in counters.values() if isinstance(counter, dict))


def usable_cores(environment):
    """Of the machine of a row: schema 2 names them, schema 1 holds them among `cores`; None where neither is there."""
    cores = environment.get("cores")
    return environment.get("usable_processors", cores.get("usable") if isinstance(cores, dict) else None)


def build_of(row):
    """Tells programs apart: the mesher's hash, or the commit it was built from, or its version."""
    hashed = row.get("programs", {}).get("podm", {}).get("sha256")
    if hashed:
        return hashed[:12]
    sources = row.get("environment", {}).get("sources")
    if isinstance(sources, dict):
        return sources.get("commit", "")[:12] + ("+changes" if sources.get("dirty") else "")
    return row.get("program", "unknown")


def doubt_of(row):
    """Empty when the row may give a headline number; otherwise the reason why not."""
    if row.get("warmup"):
        return "a warm-up"
    threads, cores = row.get("threads", {}).get("used", 0), usable_cores(row.get("environment", {}))
    if cores and threads > cores and row.get("executor") != "virtual":
        return f"{threads} threads on {cores} cores"
    status = row.get("status", "ok")
    if status != "ok":
        return f"status {status}: {row.get('reason') or 'no reason given'}"
    verdicts = row.get("verdicts")
    if not verdicts:
        return "the mesh was not verified"
    failed = [claim for claim, verdict in verdicts.items() if verdict == "fail"]
    undecided = [claim for claim in NEEDED_CLAIMS if verdicts.get(claim) not in ("pass", "fail")]
    doubts = [*(f"claim {claim} failed" for claim in failed), *(f"claim {claim} was not run" for claim in undecided)]
    return "; ".join(doubts) or (SIMULATED_CACHES if simulates_caches(row) else "")


def _files(paths):
    for path in map(Path, paths):
        if path.is_dir():
            yield from sorted(path.glob("*.jsonl"))
        elif path.is_file():
            yield path
        else:
            raise RecordError(f"{path}: no such file or folder; `make experiments` writes records")


def _read_file(path, problems):
    lines = path.read_text(errors="replace").splitlines()
    rows = []
    for number, line in enumerate(lines, start=1):
        if not line.strip():
            continue
        try:
            row = json.loads(line)
        except json.JSONDecodeError as error:
            if number == len(lines):  # a run that was killed while it wrote
                problems.append(f"{path}:{number}: last line is broken and was skipped: {error.msg}")
                break
            raise RecordError(f"{path}:{number}: not JSON: {error.msg} in column {error.colno}") from None
        if not isinstance(row, dict) or "schema" not in row:
            problems.append(f"{path}: no rows of trials (line {number} has no `schema`); the file was skipped")
            return []
        if row["schema"] not in SCHEMAS:
            raise RecordError(f"{path}:{number}: schema {row['schema']!r}; this program reads "
                              f"{' and '.join(map(str, SCHEMAS))}")
        rows.append(row)
    return rows
