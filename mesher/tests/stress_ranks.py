"""Meshes on ranks. podm-verify and podm-verify-mpi prove each from its pieces, and podm replay makes it again.
ci/ranks.sh calls this script.

`random` makes runs of podm-mpi with its ranks in one process. A seed alone determines phantom, ranks, algorithm,
threads, initial ratio, R7 and the cuts of blocks. Some runs are killed or end at a limit, and a run on another number
of ranks resumes their checkpoint; a seed does not determine the moment of a kill. `images` meshes every image of a
folder on several numbers of ranks, in one process and over MPI, and prints a table. Both exit with 1 when a run fails,
and name it. The programs are $PODM_PROGRAM, $PODM_MPI_PROGRAM and $PODM_MPIRUN.
"""

import argparse
import concurrent.futures
import dataclasses
import json
import os
import pathlib
import random
import shlex
import subprocess
import sys
import tempfile
import time

from mpi_environment import mpi_environment

PROGRAM, MPI_PROGRAM = os.environ["PODM_PROGRAM"], os.environ["PODM_MPI_PROGRAM"]
MPIRUN = os.environ.get("PODM_MPIRUN", "mpirun")
VERIFIER, VERIFIER_ON_RANKS = (os.path.join(os.path.dirname(PROGRAM), name)
                               for name in ("podm-verify", "podm-verify-mpi"))
# fidelity is left out: meshes that are coarser than a structure miss it, on one machine and on ranks.
CLAIMS = {"structure", "radius_edge", "boundary_angles", "size", "delaunay", "conformity", "surface", "labels",
          "surface_vertices"}
PHANTOMS = [("spheres", 48), ("torus", 48), ("abdomen", 96)]
IMAGE_SUFFIXES = (".nrrd", ".nii", ".nii.gz", ".mha", ".inr", ".inr.gz")
IN_PROCESS_RANKS, MPI_RANKS = (2, 3, 5, 8), (2, 4)
TIMEOUT_S = 3600


class Failed(Exception):
    """The fault of a run."""


def call(command, accepted=(0,)):
    with mpi_environment() as environment:
        process = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=TIMEOUT_S,
                                 env=environment, check=False)
    if process.returncode not in accepted:
        raise Failed(f"exit {process.returncode} of {shlex.join(map(str, command))}\n"
                     f"{(process.stdout + process.stderr).strip()[-3000:]}")
    return process


def record_in(folder):
    return json.loads((folder / "run.jsonl").read_text())


@dataclasses.dataclass
class Sample:
    """An image, and the sizes at which one machine makes about the requested number of cells."""
    path: pathlib.Path
    radius_mm: float
    delta_mm: float
    cells: int  # on one machine

    @classmethod
    def of(cls, path, cells):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            call([PROGRAM, "mesh", path, "--target-elements", cells, "-o", folder / "out.vtu", "--quiet", "--record",
                  folder / "run.jsonl"])
            record = record_in(folder)
            return cls(path, record["used"]["radius_mm"], record["used"]["delta_mm"], record["cells"])


@dataclasses.dataclass
class Cut:
    """The early end of a run, and the number of ranks in process that resume it."""
    limit: list    # options; none: the run is killed
    kill_s: float  # after its first checkpoint
    ranks: int


@dataclasses.dataclass
class OnRanks:
    """The name of a run, and the part of its command that differs between runs."""
    sample: Sample
    name: str
    launcher: list
    options: list
    ranks: list = dataclasses.field(default_factory=list)  # options
    cut: Cut | None = None

    def command(self, folder):
        """Returns the command of the run, or of the run that resumes it."""
        if self.cut is None:
            return [*self.of_mesh(folder, self.ranks), "--record", folder / "run.jsonl", "--log", folder / "run.log"]
        return [*self.of_mesh(folder, ["--in-process", self.cut.ranks]), "--record", folder / "run.jsonl",
                "--checkpoint", folder / "saved", "--resume"]

    def command_to_cut(self, folder):
        return [*self.of_mesh(folder, self.ranks), "--checkpoint", folder / "saved", "--checkpoint-seconds", 1e-6,
                *self.cut.limit]

    def of_mesh(self, folder, ranks):
        return [*self.launcher, MPI_PROGRAM, "mesh", self.sample.path, "--radius", self.sample.radius_mm, "--delta",
                self.sample.delta_mm, *ranks, *self.options, "--oversubscribe", "-o", folder / "out.pvtu", "--quiet"]


@dataclasses.dataclass
class Made:
    """The results of a verified run."""
    cells: int
    rounds: int
    deferred: float   # cells that wait after round 0, relative to all cells
    in_zones: float   # share of insertions, without later rounds in which only one rank refined
    imbalance: float
    more_cells: float  # excess over one machine, relative to its cells

    @classmethod
    def of(cls, record, sample):
        ranks, rounds = record["ranks"], record["ranks"]["rounds"]
        insertions = sum(one["insertions"] for one in rounds)
        by_many = sum(one["insertions"] for i, one in enumerate(rounds) if i == 0 or one["ranks_refining"] > 1)
        return cls(record["cells"], len(rounds), rounds[0]["deferred"] / record["cells"], by_many / max(1, insertions),
                   ranks["imbalance"], record["cells"] / sample.cells - 1)


def prove(run, folder):
    """Raises Failed unless the mesh is complete, verified, and equal to the replay of its logs."""
    record = record_in(folder)
    if record["stop_reason"] != "complete" or any(record["guarantees"].values()):
        raise Failed(f"ended as {record['stop_reason']}, guarantees missed: {record['guarantees']}")
    report = folder / "report.json"
    for verifier in [VERIFIER], [VERIFIER_ON_RANKS, "--in-process", 1 + record["cells"] % 5]:
        call([*verifier, folder / "out.pvtu", "--image", run.sample.path, "--radius", run.sample.radius_mm, "--claims",
              ",".join(sorted(CLAIMS)), "--json", report, "--quiet"], accepted=(0, 1))
        claims = json.loads(report.read_text())["claims"]
        unproved = {claim for claim in CLAIMS if claims.get(claim, {}).get("verdict") != "pass"}
        if unproved:
            raise Failed(f"{verifier} does not prove {', '.join(sorted(unproved))}: {json.dumps(claims)[:3000]}")
    ranks = range(record["ranks"]["number"])
    logs = [] if run.cut else [f"run.log.{i}" for i in ranks]
    if logs:
        call([PROGRAM, "replay", run.sample.path, *(folder / log for log in logs)])
    if len(logs) > 1:
        call([MPI_PROGRAM, "replay", run.sample.path, folder / "run.log", "--in-process", len(logs)])
    files = {*logs, *["saved"] * (run.cut is not None), "out.pvtu", "out_facets.pvtu", "run.jsonl",
             "report.json", *(f"out_{i}{facets}.vtu" for i in ranks for facets in ("", "_facets"))}
    if left := {path.name for path in folder.iterdir()} ^ files:
        raise Failed(f"left behind, or lacks: {sorted(left)}")
    return Made.of(record, run.sample)


def begin(run, folder):
    """Carries out a run until its cut, or until its end if that comes first."""
    command = run.command_to_cut(folder)
    if run.cut.limit:
        call(command, accepted=(0, 1))
        return
    with mpi_environment() as environment, \
            subprocess.Popen([str(word) for word in command], env=environment, stdout=subprocess.DEVNULL) as process:
        while process.poll() is None and not (folder / "saved" / "checkpoint.txt").exists():
            time.sleep(0.01)
        time.sleep(run.cut.kill_s)
        process.kill()


def carry_out(run):
    """Returns the results, or None after printing the fault."""
    with tempfile.TemporaryDirectory(prefix="podm-ranks-") as name:
        folder = pathlib.Path(name)
        try:
            if run.cut:
                begin(run, folder)
            call(run.command(folder))
            return prove(run, folder)
        except (Failed, subprocess.TimeoutExpired) as error:
            if run.cut:
                print(shlex.join(map(str, run.command_to_cut(folder))), f"# killed after {run.cut.kill_s} s")
            print(f"FAILED: {run.name}\n{shlex.join(map(str, run.command(folder)))}\n{error}", flush=True)
            return None


def drawn(seed, samples):
    rng = random.Random(seed)
    sample, ranks, threads = rng.choice(samples), drawn_ranks(rng), rng.randint(1, 2)
    ratio = round(rng.uniform(1, 2), 3)
    algorithm = rng.choice([["podm"], ["pdr"], ["pdr-podm", "--nodes", threads, "--cores-per-node", 2]])
    if algorithm[0] == "pdr-podm":
        threads *= 2
    moves = ["--min-dihedral", round(rng.uniform(4, 15), 1)] if rng.random() < 0.4 else []
    executor = rng.choice(["threads", "virtual"])
    return OnRanks(sample, f"seed {seed}", [], ["--seed", seed, "--threads", threads, "--initial-ratio", ratio,
                                                "--executor", executor, *moves, "--algorithm", *algorithm],
                   ["--in-process", ranks], drawn_cut(rng, sample))


def drawn_ranks(rng):
    """Returns few ranks more often than many, which take longer."""
    return rng.randint(2, 64 if rng.random() < 0.2 else 9)


def drawn_cut(rng, sample):
    if rng.random() < 0.6:
        return None
    limit = rng.choice([[], ["--max-elements", round(rng.uniform(0.05, 0.9) * sample.cells)],
                        ["--max-seconds", round(rng.uniform(0.1, 3), 2)]])
    return Cut(limit, round(rng.uniform(0, 1), 2), rng.choice([1, drawn_ranks(rng)]))


def run_random(options):
    with tempfile.TemporaryDirectory(prefix="podm-ranks-") as name, \
            concurrent.futures.ThreadPoolExecutor(options.at_once) as pool:
        samples = []
        for phantom, size in PHANTOMS:
            path = pathlib.Path(name) / f"{phantom}.nii.gz"
            call([PROGRAM, "phantom", phantom, "--size", size, "-o", path])
            samples.append(Sample.of(path, options.cells))
        seeds = range(options.first, options.first + options.runs)
        runs = [drawn(seed, samples) for seed in seeds]
        made = []
        for one in pool.map(carry_out, runs):
            made.append(one)
            if len(made) % 100 == 0:
                print(f"{len(made)} of {len(runs)} runs, {made.count(None)} failed", file=sys.stderr, flush=True)
    print(f"seeds {seeds.start} to {seeds.stop - 1} of about {options.cells} cells: {len(made)} runs, "
          f"{sum(run.cut is not None for run in runs)} of them cut and resumed, {made.count(None)} failed", end="")
    good = [one for one, run in zip(made, runs) if one is not None and run.cut is None]
    if good:
        print(f"; of those not cut: at most {max(one.rounds for one in good)} rounds, "
              f"{max(one.deferred for one in good):.1%} of the cells deferred in round 0; at least "
              f"{min(one.in_zones for one in good):.1%} of the insertions not by one rank alone in a later round; "
              f"cells {min(one.more_cells for one in good):+.2%} to {max(one.more_cells for one in good):+.2%} of one "
              "machine's")
    return None not in made


def run_images(options):
    paths = sorted(path for path in pathlib.Path(options.folder).iterdir() if path.name.endswith(IMAGE_SUFFIXES))
    if not paths:
        sys.exit(f"{options.folder}: no image")
    print("| image | radius, mm | ranks | cells | over one machine's | rounds | deferred in round 0 | "
          "not by one rank alone | imbalance | claims | replay |\n" + 11 * "|---" + "|", flush=True)
    are_all_made = True
    for path in paths:
        sample = Sample.of(path, options.cells)
        runs = [OnRanks(sample, f"{path.name}, {number} in process", [], [], ["--in-process", number])
                for number in IN_PROCESS_RANKS]
        runs += [OnRanks(sample, f"{path.name}, {number} of MPI", [MPIRUN, "-n", number],
                         ["--threads", 1]) for number in MPI_RANKS]
        for run in runs:
            made = carry_out(run)
            are_all_made = are_all_made and made is not None
            if made is not None:
                print(f"| {path.name} | {sample.radius_mm:.4g} | {run.name.partition(', ')[2]} | {made.cells} | "
                      f"{made.more_cells:+.2%} | {made.rounds} | {made.deferred:.2%} | {made.in_zones:.2%} | "
                      f"{made.imbalance:.3f} | {len(CLAIMS)} proved | equal |", flush=True)
    return are_all_made


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    commands = parser.add_subparsers(required=True)
    of_seeds = commands.add_parser("random")
    of_seeds.set_defaults(run=run_random)
    of_seeds.add_argument("--first", type=int, default=1, metavar="SEED")
    of_seeds.add_argument("--runs", type=int, required=True)
    of_seeds.add_argument("--at-once", type=int, default=2)
    of_images = commands.add_parser("images")
    of_images.set_defaults(run=run_images)
    of_images.add_argument("folder")
    for command in of_seeds, of_images:
        command.add_argument("--cells", type=int, required=True, help="of each mesh, about")
    return parser.parse_args()


if __name__ == "__main__":
    asked = parse_arguments()
    sys.exit(0 if asked.run(asked) else 1)
