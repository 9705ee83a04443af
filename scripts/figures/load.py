"""Reads rows of trials (results/README.md) into one table."""
import json
import re
from dataclasses import dataclass
from pathlib import Path

import pandas

from . import distributed, machine_state, submitted

SCHEMA = 4
# A mesh is verified if these claims pass and no other claim fails. Other claims may lack an input, such as the image.
NEEDED_CLAIMS = ("structure", "delaunay", "radius_edge", "boundary_angles")
SIMULATED_CACHES = "its seconds are those of a simulation of caches"
UNDESCRIBED = "no machine described"
ALTERED = "a constant of its model is changed"
OF_RANKS = "its ranks have tables and figures of their own"
LONG_LISTS = ["labels", "facet_pairs", "command", "workers", "ranks.rounds", "ranks.by_rank"]
# Phases that equation 1 does not count: improving angles, measuring and writing the mesh, searching the radius for a
# number of cells, drawing a phantom.
UNTIMED = ("perturb", "optimize", "exude", "measure", "write", "calibrate", "draw")
REFINING = ("octree", "initial", "refine", "closing")
# The choices that vary within a series; any other choice in a trial's name makes another series.
VARIED = ("algorithm", "threads", "seed", "mesher", "input")
GROWING = "-growing"  # ends the name of trials whose image grows with the cores
BOUNDS_OF = re.compile(r"-bounds-of-\w+$")  # ends the names of trials of one series whose meshers have their own bounds
ON_CORES = re.compile(r"-on-\d+$")  # ends the names of trials of one series, each with a radius for its cores


class RecordError(Exception):
    """Records that cannot be read; the text names the file, the line and the fault."""


@dataclass(frozen=True)
class Records:
    """`frame`: one line per trial, nested keys joined by dots, and the columns of `derived`. `problems`: what was
    skipped."""

    frame: pandas.DataFrame
    problems: list


def load(paths):
    """Reads rows from the JSON-lines files and the archives of `podm-bench pack` in `paths` (files, or folders with all
    files below). Raises RecordError."""
    rows, problems = [], []
    for path, is_named in _files(paths):
        for name, text in _texts(path):
            rows += _rows_of(name, text, is_named, problems)
    frame = pandas.json_normalize([{**row, **derived(row)} for row in _newest_of_each_turn(rows)], sep=".")
    return Records(frame.drop(columns=LONG_LISTS, errors="ignore"), problems)


def derived(row):
    """Returns the values of a row that tables and figures need; None if the trial made no mesh."""
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
    """Returns the seconds of the phases that equation 1 counts. For a simulated row these are virtual seconds; its
    other phases ran on the present machine."""
    phases = row["virtual"]["phases_s"] if row.get("virtual") else row.get("phases_s") or {}
    return {phase: seconds for phase, seconds in phases.items() if phase not in UNTIMED}


def is_virtual(row):
    return row.get("executor") == "virtual"


def simulates_caches(row):
    """True if valgrind ran the mesher: its counts are then simulated, and its times mean nothing."""
    counters = (row.get("process") or {}).get("counters", {})
    return any("simulated" in counter["source"] for counter in counters.values() if isinstance(counter, dict))


def mesher_of(row):
    """Returns `podm` or the name of another mesher."""
    return (row.get("programs", {}).get("peer") or {}).get("name", "podm")


def machine_of(row):
    """Returns the name of the machine. For measured rows this is the machine that measured them. For simulated rows it
    is the described machine, if any, with the model that simulated it, so that two descriptions or two models never
    share a number; the machine that runs the simulation does not matter. Older rows have no hash of the model."""
    virtual = row.get("virtual") or {}
    described = virtual.get("machine")
    if not described:
        environment = row.get("environment", {})
        return machine_state.name_of(environment) if row["basis"] == "measured" else UNDESCRIBED
    model = f", model {virtual['model_sha256'][:8]}" if virtual.get("model_sha256") else ""
    return f"{described.get('name', 'unnamed')} as described ({described.get('sha256', '')[:8]}{model})"


def setting_of(row):
    """Returns the trial's name without the choices that vary within a series."""
    base, *choices = row.get("trial", "").split(",")
    base = base.partition(GROWING)[0] + GROWING if is_growing(row) else ON_CORES.sub("", BOUNDS_OF.sub("", base))
    return ",".join([base, *(one for one in choices if one.partition("=")[0] not in VARIED)])


def is_growing(row):
    return GROWING in row.get("trial", "").split(",")[0]


def image_of(row):
    """Returns the image's name; empty if each number of cores has its own image."""
    given = row.get("input", {})
    return "" if is_growing(row) else Path(given.get("name") or given.get("path") or "").name


def usable_cores(environment):
    """Returns the number of usable processors; None if the row does not give it."""
    return environment.get("usable_processors")


def build_of(row):
    """Returns a name that distinguishes programs: the mesher's hash, or the commit of its sources, or its version."""
    programs = row.get("programs", {})
    hashed = (programs.get("podm_mpi") or programs.get("podm", {})).get("sha256")
    if hashed:
        return hashed[:12]
    sources = row.get("environment", {}).get("sources")
    if isinstance(sources, dict):
        return sources.get("commit", "")[:12] + ("+changes" if sources.get("dirty") else "")
    return row.get("program", "unknown")


def doubt_of(row):
    """Returns an empty text if the row may give a headline number, otherwise the reason why not."""
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
    """Returns an empty text if the row's mesh was made in its turn and verified, otherwise the reason why not."""
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
    """Keeps only the newest row of a measurement that an experiment repeated."""
    newest = {turn_of(row): number for number, row in enumerate(rows)}
    return [rows[number] for number in sorted(newest.values())]


def turn_of(row):
    """Returns the key under which a later row replaces an earlier row. The trial's own key does not serve: it changes
    if the trial could not be prepared, or if its options or radius changed."""
    return (machine_of(row), mesher_of(row), build_of(row), row.get("experiment"), row.get("trial"), row.get("repeat"),
            row.get("warmup"), row.get("input", {}).get("name"))


def _files(paths):
    """Yields each file, and True if the file itself was named. A folder may also hold other kinds of files. Folders
    below it whose names begin with a dot are skipped."""
    for path in map(Path, paths):
        if path.is_dir():
            inside = sorted([*path.rglob("*.jsonl"), *path.rglob("*" + submitted.ENDING)])
            yield from ((one, False) for one in inside
                        if not any(part.startswith(".") for part in one.relative_to(path).parts))
        elif path.is_file():
            yield path, True
        else:
            raise RecordError(f"{path}: no such file or folder; `make experiments` writes records")


def _texts(path):
    """Yields the name and the text of a file, or those of an archive's files of rows."""
    if not path.name.endswith(submitted.ENDING):
        yield path, path.read_text(errors="replace")
        return
    try:
        yield from submitted.texts_of(path)
    except submitted.ArchiveError as error:
        raise RecordError(str(error)) from None


def _rows_of(path, text, is_named, problems):
    lines = text.splitlines()
    rows = []
    for number, line in enumerate(lines, start=1):
        if not line.strip():
            continue
        try:
            row = json.loads(line)
        except json.JSONDecodeError as error:
            if number == len(lines):  # the run was killed during the write
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
