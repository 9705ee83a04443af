"""Reads rows of trials (results/README.md) into one table."""
import json
import re
from dataclasses import dataclass
from pathlib import Path

import pandas

from . import distributed, machine_state

SCHEMA = 4
# A mesh counts as verified when these pass and no other claim fails; the rest may lack an input, such as the image.
NEEDED_CLAIMS = ("structure", "delaunay", "radius_edge", "boundary_angles")
SIMULATED_CACHES = "its seconds are those of a simulation of caches"
UNDESCRIBED = "no machine described"
ALTERED = "a constant of its model is another"
OF_RANKS = "its ranks have tables and figures of their own"
LONG_LISTS = ["labels", "facet_pairs", "command", "workers", "ranks.rounds", "ranks.by_rank"]
# Phases in no second of equation 1: bettering angles, measuring and writing the mesh, finding the radius for a number
# of cells, drawing a phantom.
UNTIMED = ("perturb", "optimize", "exude", "measure", "write", "calibrate", "draw")
REFINING = ("octree", "initial", "refine", "closing")
# What a series varies; any other choice in a trial's name makes another series.
VARIED = ("algorithm", "threads", "seed", "mesher", "input")
GROWING = "-growing"  # ends the name of trials whose image grows with the cores
BOUNDS_OF = re.compile(r"-bounds-of-\w+$")  # ends the names of trials of one series whose meshers have their own bounds
ON_CORES = re.compile(r"-on-\d+$")  # ends the names of trials of one series, each with a radius for its cores


class RecordError(Exception):
    """Records that cannot be read; the text names file, line and fault."""


@dataclass(frozen=True)
class Records:
    """`frame`: one line a trial, nested keys joined by dots, and the columns of `derived`. `problems`: what was
    skipped."""

    frame: pandas.DataFrame
    problems: list


def load(paths):
    """Rows of the JSON-lines files in `paths` (files, or folders and those within). Raises RecordError."""
    rows, problems = [], []
    for path, is_named in _files(paths):
        rows += _read_file(path, is_named, problems)
    frame = pandas.json_normalize([{**row, **derived(row)} for row in _newest_of_each_turn(rows)], sep=".")
    return Records(frame.drop(columns=LONG_LISTS, errors="ignore"), problems)


def derived(row):
    """What tables and figures need of a row; None where the trial made no mesh."""
    timed = timed_phases(row)
    doubt = doubt_of(row)
    return {
        "basis": row["basis"],
        "mesher": mesher_of(row),
        "machine": machine_of(row),
        "usable_cores": usable_cores(row.get("environment", {})),
        "build": build_of(row),
        "cores": row.get("threads", {}).get("used"),
        "setting": setting_of(row),
        "image": image_of(row),
        "grows": is_growing(row),
        "timed": timed,
        "seconds": sum(timed.values()) if timed else None,
        "whole_s": sum(seconds for phase, seconds in timed.items() if phase != "read") if timed else None,
        "refining_s": sum(timed.get(phase, 0.0) for phase in REFINING) if timed else None,
        "headline": not doubt,
        "doubt": doubt,
        "unproved": unproved_of(row),
        "disturbed": machine_state.is_disturbed(row),
        "moved": machine_state.has_moved(row),
        "on_ranks": distributed.of_row(row),
    }


def timed_phases(row):
    """Seconds by phase that equation 1 counts: virtual ones of a simulated row, whose others ran on the machine at
    hand."""
    phases = row["virtual"]["phases_s"] if row.get("virtual") else row.get("phases_s") or {}
    return {phase: seconds for phase, seconds in phases.items() if phase not in UNTIMED}


def is_virtual(row):
    return row.get("executor") == "virtual"


def simulates_caches(row):
    """Whether valgrind ran the mesher: its counts are simulated, its times mean nothing."""
    counters = (row.get("process") or {}).get("counters", {})
    return any("simulated" in counter["source"] for counter in counters.values() if isinstance(counter, dict))


def mesher_of(row):
    """`podm`, or the name of another mesher."""
    return (row.get("programs", {}).get("peer") or {}).get("name", "podm")


def machine_of(row):
    """Of measured rows the one that measured them. Of simulated rows the described machine, if any, and the model that
    played it, so that neither two descriptions nor two models share a number; the machine that simulates does not
    matter. Rows of before the model had a hash name none."""
    virtual = row.get("virtual") or {}
    described = virtual.get("machine")
    if not described:
        environment = row.get("environment", {})
        return machine_state.name_of(environment) if row["basis"] == "measured" else UNDESCRIBED
    model = f", model {virtual['model_sha256'][:8]}" if virtual.get("model_sha256") else ""
    return f"{described.get('name', 'unnamed')} as described ({described.get('sha256', '')[:8]}{model})"


def setting_of(row):
    """The trial's name without the choices that a series varies."""
    base, *choices = row.get("trial", "").split(",")
    base = base.partition(GROWING)[0] + GROWING if is_growing(row) else ON_CORES.sub("", BOUNDS_OF.sub("", base))
    return ",".join([base, *(one for one in choices if one.partition("=")[0] not in VARIED)])


def is_growing(row):
    return GROWING in row.get("trial", "").split(",")[0]


def image_of(row):
    """Empty where each number of cores has an image of its own."""
    given = row.get("input", {})
    return "" if is_growing(row) else Path(given.get("name") or given.get("path") or "").name


def usable_cores(environment):
    """What a row says of its machine; None where it says nothing."""
    return environment.get("usable_processors")


def build_of(row):
    """Tells programs apart: the mesher's hash, or the commit it was built from, or its version."""
    programs = row.get("programs", {})
    hashed = (programs.get("podm_mpi") or programs.get("podm", {})).get("sha256")
    if hashed:
        return hashed[:12]
    sources = row.get("environment", {}).get("sources")
    if isinstance(sources, dict):
        return sources.get("commit", "")[:12] + ("+changes" if sources.get("dirty") else "")
    return row.get("program", "unknown")


def doubt_of(row):
    """Empty when the row may give a headline number; otherwise the reason why not."""
    if row.get("ranks"):
        return OF_RANKS
    threads, cores = row.get("threads", {}).get("used", 0), usable_cores(row.get("environment", {}))
    if cores and threads > cores and not is_virtual(row):
        return f"{threads} threads on {cores} cores"
    if row.get("asked", {}).get("cost_factor"):
        return unproved_of(row) or ALTERED
    return (unproved_of(row) or (SIMULATED_CACHES if simulates_caches(row) else "")
            or (machine_state.MOVED if machine_state.has_moved(row) else ""))


def unproved_of(row):
    """Empty when the row's mesh was made in its turn and verified; otherwise the reason why not."""
    if row.get("warmup"):
        return "a warm-up"
    status = row.get("status", "ok")
    if status != "ok":
        return f"status {status}: {row.get('reason') or 'no reason given'}"
    verdicts = row.get("verdicts")
    if not verdicts:
        return "the mesh was not verified"
    failed = [claim for claim, verdict in verdicts.items() if verdict == "fail"]
    undecided = [claim for claim in NEEDED_CLAIMS if verdicts.get(claim) not in ("pass", "fail")]
    doubts = [*(f"claim {claim} failed" for claim in failed), *(f"claim {claim} was not run" for claim in undecided)]
    return "; ".join(doubts)


def _newest_of_each_turn(rows):
    """A measurement that an experiment made again counts once, as of its newest row."""
    newest = {turn_of(row): number for number, row in enumerate(rows)}
    return [rows[number] for number in sorted(newest.values())]


def turn_of(row):
    """What a later row replaces. A trial that could not be prepared, or whose options or radius changed since, has
    another key."""
    return (machine_of(row), mesher_of(row), build_of(row), row.get("experiment"), row.get("trial"), row.get("repeat"),
            row.get("warmup"), row.get("input", {}).get("name"))


def _files(paths):
    """Each file and whether it was named itself, for a folder also holds files of another kind; none below folders
    that begin with a dot."""
    for path in map(Path, paths):
        if path.is_dir():
            inside = sorted(path.rglob("*.jsonl"))
            yield from ((one, False) for one in inside
                        if not any(part.startswith(".") for part in one.relative_to(path).parts))
        elif path.is_file():
            yield path, True
        else:
            raise RecordError(f"{path}: no such file or folder; `make experiments` writes records")


def _read_file(path, is_named, problems):
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
        schema = row.get("schema") if isinstance(row, dict) else None
        if not rows and not (isinstance(schema, int) and (is_named or "experiment" in row)):  # lines of another kind
            if is_named:
                problems.append(f"{path}: no rows of trials (line {number} has schema {schema!r}); skipped")
            return []
        if schema != SCHEMA:
            raise RecordError(f"{path}:{number}: schema {schema!r}; this program reads {SCHEMA}")
        rows.append(row)
    return rows
