"""Fits the unmeasured constants of the paper's machine to PODM's speed-ups in the paper's Table 1.

A simulation of 256 workers takes minutes, and a fit needs hundreds of trials. The fit therefore simulates only their
queueing. Each worker computes for as long as its rows give for the work of an attempt and its way to other memory. It
then asks both routers for as many accesses as the rows give per insertion; routers serve as in
mesher/workers/remote_memory.h. Workers that lose their time to each other, in contention and begging, are left out, as
many as in the row. Rows should therefore come from constants that are near: fit a second time to rows simulated with
the constants of the first fit. Full simulations with the fitted constants show how good the surrogate was:
scripts/report prints them beside the paper's.

The fit uses no value of PDR.PODM, no efficiency and nothing of Table 2.
"""
import argparse
import heapq
import json
import random
import sys
import tomllib
from collections import deque
from dataclasses import dataclass
from pathlib import Path

import numpy
from scipy.optimize import minimize

from . import paper, scaling, style
from .load import RecordError, load

CELLS_PER_INSERTION = 22  # made by one insertion; 16 of them replace other cells
CONSTANTS = ("miss_share", "router_accesses_per_s", "retries")
STARTS = ((0.04, 4e6, 0.0125), (0.02, 2e6, 0.02), (0.1, 1e7, 0.004))
SIMPLEX = (1.5, 1.4, 1.6)  # first steps, factors
ATTEMPTS_PER_WORKER, MOST_ATTEMPTS = 120, 60_000
SECONDS = [f"virtual.worker_s.{name}" for name in ("compute", "memory_remote", "network_queue")]
ACCESSES = ["hops_by_kind.mesh_reads", "hops_by_kind.mesh_writes"]
# Columns that a row must have beside its hops. Rows on one node have no hops.
NEEDED = [*SECONDS, "virtual.refine_s", "virtual.machine.constants.core_speed", "counters.cells_created"]


@dataclass(frozen=True)
class Run:
    """The values of a row of PODM on `cores` workers: seconds of computing on the reference core, remote accesses and
    the links on their ways, insertions, and `loss`, the whole time over the time of attempts."""

    cores: int
    cells: float
    reference_s: float
    links: float
    routed: float
    insertions: float
    loss: float


def runs_of(frame):
    """Returns (runs, series): for each number of cores in Table 1 the newest row of PODM, of the simulated series that
    figures show first. Raises RecordError, which lists the missing rows, if there are too few rows for a fit."""
    series = scaling.first_of(scaling.weak_series(frame), "simulated")
    if series is None:
        raise RecordError(f"no verified simulated row of podm on one core{_doubts(frame)}")
    rows = scaling.rows_of(frame, series)
    rows = rows[rows["algorithm"] == "podm"]
    missing_columns = [name for name in NEEDED if name not in rows or rows[name].isna().all()]
    if missing_columns:
        raise RecordError(f"rows of {series.label()} do not record {', '.join(missing_columns)}: "
                          "rows of a newer mesher do")
    rows = rows.dropna(subset=NEEDED)
    runs = {cores: _run(row) for cores, row in rows.set_index(rows["cores"]).sort_index(kind="stable").iterrows()
            if cores in _published()}
    if 1 not in runs or len(runs) - 2 < len(CONSTANTS):
        raise RecordError(f"{len(CONSTANTS)} constants need rows of podm on one core and {len(CONSTANTS) + 1} other "
                          f"numbers; of {series.label()} there are none on {_words(missing(runs))}{_doubts(frame)}")
    return runs, series


def missing(runs):
    """Returns the numbers of cores of Table 1 that have no run."""
    return [cores for cores in _published() if cores not in runs]


def _published():
    return list(paper.table1().loc["podm"].index)


def _words(counts):
    return f"{', '.join(map(str, counts))} core{'' if counts == [1] else 's'}"


def _doubts(frame):
    """Returns ": why" for the simulated rows that do not count, or an empty text. A failed row names no algorithm."""
    if frame.empty:
        return ""
    doubts = sorted(set(frame[(frame["basis"] == "simulated") & ~frame["headline"]]["doubt"]))
    return f": {'; '.join(doubts)}" if doubts else ""


def _run(row):
    cores, seconds = int(row["cores"]), sum(row[name] for name in SECONDS)
    hops = [(links, count) for kind in ACCESSES if isinstance(row.get(kind), list)
            for links, count in enumerate(row[kind])]
    return Run(cores=cores, cells=row["cells"],
               reference_s=row["virtual.worker_s.compute"] * row["virtual.machine.constants.core_speed"],
               links=float(sum(links * count for links, count in hops)),
               routed=float(sum(count for links, count in hops if links > 1)),
               insertions=row["counters.cells_created"] / CELLS_PER_INSERTION,
               loss=cores * row["virtual.refine_s"] / seconds)


def refining_seconds(run, machine, constants):
    """Returns the simulated seconds that PODM refines, by the surrogate. `constants`: by name."""
    link_s = machine["memory"]["cycles_per_hop"] / machine["processor"]["clock_ghz"] / 1e9
    busy_s = run.reference_s / machine["processor"]["core_speed"] + constants["miss_share"] * run.links * link_s
    accesses = constants["miss_share"] * run.routed / run.insertions
    if accesses == 0:
        return busy_s * run.loss / run.cores
    num_attempting = max(1, round(run.cores / run.loss))  # the others wait for each other
    return run.insertions * _seconds_between_attempts(num_attempting, busy_s / run.insertions, accesses, constants)


def _seconds_between_attempts(num_workers, busy_s, accesses, constants):
    """Returns the mean time between attempts of all workers, after a warm-up of a third of the attempts."""
    draw = random.Random(1)
    service_s = 1 / constants["router_accesses_per_s"]
    ready = [(busy_s * draw.random(), worker) for worker in range(num_workers)]
    heapq.heapify(ready)
    queues, num_waiting = (deque(), deque()), [0.0, 0.0]
    attempts = min(MOST_ATTEMPTS, ATTEMPTS_PER_WORKER * num_workers)
    first, began_s = attempts // 3, 0.0
    for attempt in range(attempts):
        now_s, worker = heapq.heappop(ready)
        began_s = now_s if attempt == first else began_s
        waits_s = 0.0
        for router, queue in enumerate(queues):
            while queue and queue[0][0] <= now_s:
                num_waiting[router] -= queue.popleft()[1]
            asked = accesses / 2 * draw.expovariate(1)
            served_s = queue[-1][0] if queue else now_s
            waits_s += asked * (served_s - now_s)
            queue.append((served_s + asked * service_s * (1 + constants["retries"] * num_waiting[router]), asked))
            num_waiting[router] += asked
        heapq.heappush(ready, (now_s + waits_s + busy_s * draw.uniform(0.5, 1.5), worker))
    return (now_s - began_s) / (attempts - first)


def speedups(runs, machine, constants):
    """Returns the speed-ups over one core by number of cores."""
    rates = {cores: run.cells / refining_seconds(run, machine, constants) for cores, run in runs.items()}
    return {cores: rate / rates[1] for cores, rate in rates.items()}


def deviations(runs, machine, constants):
    """Returns our speed-up over the paper's, minus 1, by number of cores above one."""
    published = paper.corrected_table1().loc["podm"]["speedup"]
    return {cores: ours / published[cores] - 1 for cores, ours in speedups(runs, machine, constants).items()
            if cores > 1}


def fit(runs, machine):
    """Returns the constants with the least mean absolute deviation, and this deviation."""
    def mean(logarithms):
        constants = dict(zip(CONSTANTS, numpy.exp(logarithms)))
        if constants["miss_share"] > 1:
            return 10.0
        return float(numpy.mean(numpy.abs(list(deviations(runs, machine, constants).values()))))

    found = []
    for start in STARTS:
        steps = numpy.ones((4, 3)) + numpy.vstack([numpy.zeros(3), numpy.diag(numpy.array(SIMPLEX) - 1)])
        found.append(minimize(mean, numpy.log(start), method="Nelder-Mead",
                              options={"maxfev": 90, "xatol": 0.02, "fatol": 0.001,
                                       "initial_simplex": numpy.log(numpy.array(start) * steps)}))
    best = min(found, key=lambda one: one.fun)
    return dict(zip(CONSTANTS, map(float, numpy.exp(best.x)))), float(best.fun)


def leaving_one_out(runs, machine):
    """Returns by number of cores its deviation with constants that were fitted to the other numbers of cores."""
    missed = {}
    for cores in [cores for cores in runs if cores > 1]:
        constants, _ = fit({other: run for other, run in runs.items() if other != cores}, machine)
        missed[cores] = deviations({1: runs[1], cores: runs[cores]}, machine, constants)[cores]
        print(f"without {cores} cores: {100 * missed[cores]:+.1f} %", file=sys.stderr)
    return missed


def sensitivity_figure(runs, machine, constants):
    """Draws PODM's speed-ups with each constant halved and doubled, one panel each."""
    published = paper.corrected_table1().loc["podm"]["speedup"]
    shown = ("core_speed", *CONSTANTS)
    drawn, panels = style.new_figure(columns=len(shown), width=14.0, height=3.6)
    for axes, name in zip(panels, shown):
        axes.plot(published.index, published, "s", color=style.INK, label="published (PODM)")
        for factor, line in ((0.5, ":"), (1, "-"), (2, "--")):
            changed, of_machine = dict(constants), {**machine, "processor": dict(machine["processor"])}
            if name == "core_speed":
                of_machine["processor"][name] *= factor
            else:
                changed[name] *= factor
            ours = speedups(runs, of_machine, changed)
            axes.plot(list(ours), list(ours.values()), line, color="#d1495b", label=f"surrogate, {factor:g} times")
        axes.set(title=name, xlabel="simulated cores", ylabel="speed-up")
    style.legend(panels[-1])
    style.finish(drawn, "PODM's speed-up when one constant of the machine changes; all else as fitted")
    return drawn


def read_machine(path):
    """Reads the machine's description and checks the values that the surrogate uses. Raises RecordError."""
    try:
        machine = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise RecordError(f"{path}: {getattr(error, 'strerror', None) or error}") from None
    for section, key in (("memory", "cycles_per_hop"), ("processor", "clock_ghz"), ("processor", "core_speed")):
        value = machine.get(section, {}).get(key)
        if not isinstance(value, (int, float)) or value <= 0:
            raise RecordError(f"{path}: {section}.{key} must be a number above 0")
    return machine


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("records", nargs="+", type=Path,
                        help="rows of podm on the machine, all of one size: JSON lines")
    parser.add_argument("--machine", required=True, type=Path, help="its description (TOML)")
    parser.add_argument("--leave-one-out", action="store_true", help="also fit without each point; some minutes")
    parser.add_argument("-o", "--output", required=True, type=Path,
                        help="folder for machine_fit.json and machine_fit.png")
    asked = parser.parse_args(arguments)
    try:
        machine = read_machine(asked.machine)
        runs, series = runs_of(load(asked.records).frame)
    except RecordError as error:
        print(f"fit_machine: {error}", file=sys.stderr)
        return 2
    print(f"fit_machine: {series.label()}" + (f"; no row on {_words(missing(runs))}" if missing(runs) else ""),
          file=sys.stderr)
    constants, mean = fit(runs, machine)
    result = {"schema": "podm-machine-fit/1", "machine": machine.get("name", asked.machine.stem),
              "records": [str(path) for path in asked.records],
              "core_speed": machine["processor"]["core_speed"], "constants": constants, "mean_absolute_deviation": mean,
              "deviations": deviations(runs, machine, constants)}
    if asked.leave_one_out:
        result["leaving_one_out"] = leaving_one_out(runs, machine)
    asked.output.mkdir(parents=True, exist_ok=True)
    (asked.output / "machine_fit.json").write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    sensitivity_figure(runs, machine, constants).savefig(asked.output / "machine_fit.png")
    print(f"mean absolute deviation {100 * mean:.1f} %: " + ", ".join(f"{name} = {value:.3g}"
                                                                     for name, value in constants.items()))
    return 0
