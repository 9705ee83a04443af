"""Random runs of many workers on small and unusual images: each must end as requested, verify, and equal its replay.

A seed determines each run, together with the options for shapes: with --lines, --box or --thin images and runs are
those of random_shapes.py, otherwise those of random_runs.py. `--seed SEED` repeats one and keeps its files; a run on
threads may need several attempts to fail again. $PODM_PROGRAM is the podm program. Exits with 1 when a run fails, and
names its seed and command.
"""

import argparse
import collections
import concurrent.futures
import itertools
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import traceback

import numpy

import random_images
import random_runs
import random_shapes
from podm_process import PROGRAM

VERIFIER = os.path.join(os.path.dirname(PROGRAM), "podm-verify")
TIMEOUT_S = 1200  # aggressive workers sometimes make 10^8 attempts, which takes minutes
# Claims that hold for a mesh even if its run ends early.
ALWAYS = {"structure", "delaunay", "conformity", "surface", "labels"}
IN_MEMORY = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


class Failed(Exception):
    """The fault of a run."""


def call(*arguments, accepted=(0,)):
    environment = os.environ | ({"TMPDIR": IN_MEMORY} if IN_MEMORY else {})
    try:
        process = subprocess.run([str(argument) for argument in arguments], capture_output=True, text=True,
                                 timeout=TIMEOUT_S, env=environment, check=False)
    except subprocess.TimeoutExpired as error:
        raise Failed(f"{arguments[1]} did not end within {TIMEOUT_S} s") from error
    if process.returncode not in accepted:
        raise Failed(f"{arguments[1]}: exit {process.returncode}: {process.stderr.strip()[-2000:]}")
    return process


def is_turned(run):
    """True if the mesh is turned from the image's frame on output, after which it may not claim to be Delaunay."""
    return "--box" in run.options and (numpy.count_nonzero(run.image.affine[:, :3], axis=0) > 1).any()


def judge(run, record, process):
    """Raises Failed unless the run ended as requested, with a mesh that is as valid as this end allows."""
    reason, verdicts = record["stop_reason"], record["verdicts"]
    always = ALWAYS - ({"delaunay"} if record["optimization"] else set())
    if is_turned(run) and not record["turned"]["is_delaunay"]:
        # Labels are then judged by distances, which large cells exceed.
        always = always - {"delaunay", "labels"}
    if reason != "complete" and record["guarantees"].get("missing_labels"):
        always = always - {"labels"}  # it ended before each large label had a cell
    said = f": {process.stderr.strip()[-2000:]}"
    if reason != "complete" and reason not in run.limits:
        raise Failed(f"ended early by the {reason}, which was not requested{said}")
    if record["cells"] and not always <= set(verdicts):
        raise Failed(f"was verified for {sorted(verdicts)} only{said}")
    # A file promises its lines only if it has them, however the run ended.
    due = set(verdicts) if reason == "complete" else (always | {"lines"}) & set(verdicts)
    differences = (record.get("thin_layers") or {}).get("differences", [])
    failed = sorted(claim for claim in due - ({"topology"} if differences else set()) if verdicts[claim] != "pass")
    if failed:
        raise Failed(f"ended as {reason}, and {', '.join(failed)} do not pass{said}")
    is_whole = reason == "complete" and record["cells"] > 0 and not differences
    unmet = {name: misses for name, misses in record["guarantees"].items() if misses} if reason == "complete" else {}
    if differences and unmet.get("topology") == len(differences):
        del unmet["topology"]  # each is listed, at the least delta
    if not record["cells"]:
        unmet.pop("missing_labels", None)  # judge_empty decides if there had to be a cell
    if unmet or (process.returncode == 0) != is_whole:
        raise Failed(f"ended as {reason} with exit code {process.returncode} and misses {unmet}{said}")


def judge_empty(run, delta_mm):
    """Raises Failed if the object is thick enough that every run must have a cell.

    Let B be a ball of radius b inside, and c the circumcenter of the cell that holds B's center. If no cell has a
    label, c lies outside. The line from c into B then meets the isosurface at a depth of at least b in the circumball.
    So the nearest point z has at least this depth. By R1 a vertex lies within delta of z, and no vertex is inside the
    circumball. Therefore b <= delta. The z that is found is not always the nearest: it may be farther by a part of a
    voxel (isosurface/isosurface.h).
    """
    ball_mm = run.image.ball_inside_mm(run.foreground())
    if ball_mm > delta_mm + numpy.linalg.norm(run.image.spacing):
        raise Failed(f"made no cell, but holds a ball of {ball_mm:.3g} mm, and delta is {delta_mm:.3g} mm")


def carry_out(run, folder):
    """Returns how the run ended; raises Failed."""
    image, mesh, log, record, schedule = (os.path.join(folder, name) for name in (
        run.image_name, run.mesh_name, "run.log", "run.jsonl", "leaves.jsonl"))
    run.image.write(image)
    leaves = ["--schedule", schedule] if run.has_schedule else []
    def made(*options):
        process = call(PROGRAM, "mesh", image, *run.selection, *run.options, "-o", mesh, "--record", record, "--verify",
                       "--quiet", *options, accepted=(0, 1))
        summary = json.loads(pathlib.Path(record).read_text().splitlines()[-1])
        judge(run, summary, process)
        return summary

    if run.optimizes:
        made("--optimize")
    summary = made("--log", log, *leaves)
    call(PROGRAM, "replay", image, *run.selection, log)
    if summary["cells"] and os.path.exists(schedule):
        call(VERIFIER, mesh, "--claims", "conformity", *leaves)
    written = {os.path.basename(path) for path in (image, mesh, log, record, schedule)}
    written |= {"out_facets.vtu"} | ({"out_lines.vtu"} if summary["lines"] else set())
    if left := set(os.listdir(folder)) - written:
        raise Failed(f"left behind {sorted(left)}")
    if not summary["cells"] and summary["stop_reason"] == "complete":
        judge_empty(run, summary["used"]["delta_mm"])
    if not summary["cells"]:
        return "no cell"
    claimed = f", lines {'' if summary['lines']['is_claimed'] else 'not '}claimed" if summary["lines"] else ""
    return summary["stop_reason"] + claimed


def fault_of(run, folder):
    """Returns the fault of the run (or None) and how it ended. Any exception is a fault, so that its seed is printed.
    """
    try:
        return None, carry_out(run, folder)
    except Failed as error:
        return str(error), "failed"
    except Exception:  # a malformed record, a full disk, an error in these tests
        return traceback.format_exc(), "failed"


def kinds_of(run):
    """Returns the properties of a run that the summary counts."""
    given = {option for option in run.options + run.selection if option.startswith("--")}
    kinds = {"algorithm": [run.algorithm], "executor": [run.executor], "image": [run.image.family],
             "damage": sorted(set(run.image.damages)) or ["none"],
             "voxel type": [random_images.TYPES[run.image.datatype].__name__]}
    rare = {"--target-elements", "--radius-of", "--delta", "--leaf-size", "--drop", "--labels", "--merge", "--pin",
            "--topology", "--max-elements", "--max-seconds", "--min-dihedral", "--smooth", "--lines-delta"}
    return kinds | {"option": sorted(given & rare)}


class Draws:
    """Draws the run of a seed, a pair of its number and the options for shapes."""

    def __init__(self):
        with tempfile.TemporaryDirectory() as folder:
            self.phantoms = random_images.Phantoms(PROGRAM, folder)
            self.phantoms_of_shapes = random_images.Phantoms(PROGRAM, folder, random_shapes.PHANTOMS)

    def __call__(self, seed):
        number, shape_options = seed
        if shape_options:
            return random_shapes.draw(number, shape_options, self.phantoms_of_shapes)
        return random_runs.draw(number, self.phantoms)


class Stress:
    """Runs on all processors at once until the budget is spent; counts and reports them."""

    def __init__(self, draws, seeds, seconds, keep):
        self.draws, self.seeds, self.keep = draws, seeds, keep
        self.start = time.monotonic()
        self.deadline = self.start + seconds if seconds else float("inf")
        self.lock = threading.Lock()
        self.runs, self.failed_seeds, self.last_seed = 0, [], None
        self.slowest = (0.0, None)  # seconds, seed
        self.counts = collections.defaultdict(collections.Counter)

    def next_seed(self):
        with self.lock:
            return next(self.seeds, None) if time.monotonic() < self.deadline else None

    def work(self):
        while (seed := self.next_seed()) is not None:
            start = time.monotonic()
            run = self.draws(seed)
            with tempfile.TemporaryDirectory(dir=IN_MEMORY, prefix="podm-stress-") as folder:
                fault, ended = fault_of(run, folder)
            with self.lock:
                self.slowest = max(self.slowest, (round(time.monotonic() - start, 1), seed[0]))
                self.count(run, seed[1], ended, fault)

    def count(self, run, shape_options, ended, fault):
        self.runs += 1
        self.last_seed = run.seed if self.last_seed is None else max(run.seed, self.last_seed)
        for kind, names in (kinds_of(run) | {"ended": [ended]}).items():
            self.counts[kind].update(names)
        if fault:
            self.failed_seeds.append(run.seed)
            self.report_failure(run, shape_options, fault)
        if sys.stderr.isatty() or self.runs % 500 == 0:
            end = "" if sys.stderr.isatty() else "\n"
            print(f"\r{self.runs} runs in {self.seconds():.0f} s, {len(self.failed_seeds)} failed ", end=end,
                  file=sys.stderr, flush=True)

    def report_failure(self, run, shape_options, fault):
        words = " ".join(shape_options)
        print(f"\nseed {run.seed}, {run.image.family} ({', '.join(run.image.damages) or 'sound'}): podm mesh "
              f"{run.image_name} {shlex.join(run.selection + run.options)}\n{fault}\n"
              f"again: make stress SEED={run.seed}" + (f" SHAPES='{words}'" if words else ""), file=sys.stderr)
        if self.keep:
            with open(self.keep, "a") as file:
                seed = f"{run.seed} {words}".rstrip()
                file.write(f"{seed}  # {run.algorithm} on {run.executor}, {run.image.family}\n")

    def seconds(self):
        return time.monotonic() - self.start

    def __call__(self):
        with concurrent.futures.ThreadPoolExecutor() as pool:
            workers = [pool.submit(self.work) for _ in os.sched_getaffinity(0)]
            try:
                concurrent.futures.wait(workers)
            except KeyboardInterrupt:
                self.deadline = 0
        for worker in workers:
            worker.result()

    def summary(self):
        lines = [f"{self.runs} runs in {self.seconds():.0f} s ({60 * self.runs / self.seconds():.0f} a minute), "
                 f"{len(self.failed_seeds)} failed; the slowest, seed {self.slowest[1]}, took {self.slowest[0]} s"]
        for kind, counter in self.counts.items():
            lines.append(f"  {kind:10} " + ", ".join(f"{name} {n}" for name, n in counter.most_common()))
        return "\n".join(lines)

    def record(self):
        version = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()
        return {"schema": "podm-stress/1", "program": version, "processors": len(os.sched_getaffinity(0)),
                "seconds": round(self.seconds(), 1), "runs": self.runs, "last_seed": self.last_seed,
                "failed_seeds": sorted(self.failed_seeds),
                "slowest": dict(zip(("seconds", "seed"), self.slowest)),
                "counts": {kind: dict(counter.most_common()) for kind, counter in self.counts.items()}}


def seeds_in(path):
    """Returns the seed of each line that is not a comment: its number, then its options for shapes."""
    lines = (line.split("#")[0].split() for line in pathlib.Path(path).read_text().splitlines())
    return [(int(words[0]), words[1:]) for words in lines if words]


def repeat(run):
    """Repeats one run and keeps its files. Returns its exit code."""
    folder = tempfile.mkdtemp(prefix=f"podm-stress-{run.seed}-")
    print(f"{run.image.family} of {run.image.voxels.shape} voxels ({', '.join(run.image.damages) or 'sound'}) in "
          f"{folder}\npodm mesh {run.image_name} {shlex.join(run.selection + run.options)}", file=sys.stderr)
    fault, ended = fault_of(run, folder)
    print(fault or ended, file=sys.stderr)
    if fault is None:
        shutil.rmtree(folder)
    return 1 if fault else 0


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    budget = parser.add_mutually_exclusive_group()
    budget.add_argument("--seconds", type=float, help="begin no run after this time [600, unless another is given]")
    budget.add_argument("--runs", type=int, help="as many runs")
    budget.add_argument("--seeds", metavar="FILE", help="the runs of the seeds in FILE")
    budget.add_argument("--seed", type=int, help="this run alone; its files stay if it fails")
    parser.add_argument("--first", type=int, metavar="SEED", help="seed of the first run; others follow [any]")
    parser.add_argument("--keep", metavar="FILE", help="append the seeds that fail to FILE")
    parser.add_argument("--record", metavar="FILE", help="write the counts as JSON")
    shapes = parser.add_argument_group("options of podm mesh for shapes, on images of random_shapes.py")
    shapes.add_argument("--lines", action="store_true")
    shapes.add_argument("--box", choices=["flat"])
    shapes.add_argument("--thin", choices=["keep"])
    return parser.parse_args()


def shape_options_of(options):
    """Returns the options for shapes as words."""
    words = ["--lines"] if options.lines else []
    words += ["--box", options.box] if options.box else []
    return words + (["--thin", options.thin] if options.thin else [])


def main():
    options = parse_arguments()
    draws, shape_options = Draws(), shape_options_of(options)
    if options.seed is not None:
        return repeat(draws((options.seed, shape_options)))
    first = options.first if options.first is not None else int.from_bytes(os.urandom(4), "little")
    numbers = itertools.count(first) if options.runs is None else range(first, first + options.runs)
    seeds = ((number, shape_options) for number in numbers)
    if options.seeds:
        seeds = iter(seeds_in(options.seeds))
    else:
        print(f"seeds from {first} on", file=sys.stderr)
    is_endless = options.runs is None and not options.seeds
    stress = Stress(draws, seeds, (options.seconds or 600) if is_endless else None, options.keep)
    stress()
    print(f"\r{stress.summary()}", file=sys.stderr)
    if options.record:
        record = stress.record() if options.seeds else {"first_seed": first} | stress.record()
        pathlib.Path(options.record).write_text(json.dumps(record, indent=1) + "\n")
    return 1 if stress.failed_seeds else 0


if __name__ == "__main__":
    sys.exit(main())
