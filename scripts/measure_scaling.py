#!/usr/bin/python3
"""Weak scaling of `podm mesh` on this machine: cells per second of refinement, in interleaved rounds.

Each round runs one process of one thread; THREADS such processes side by side, the machine's ceiling; and one process of
THREADS threads with THREADS times the cells. Every run becomes a JSON line of OUTPUT.
"""
import argparse
import json
import os
import statistics
import subprocess
import tempfile

from warm_memory import warm_memory


def start(args, folder, number, radius, threads):
    record = os.path.join(folder, f"record{number}.jsonl")
    command = [args.podm, "mesh", args.image, "--radius", str(radius), "--threads", str(threads), "--quiet",
               "-o", os.path.join(folder, f"mesh{number}.vtu"), "--record", record]
    return subprocess.Popen(command), record


def finish(started):
    rows = []
    for process, record in started:
        if process.wait() != 0:
            raise SystemExit(f"podm exited with {process.returncode}")
        with open(record) as lines:
            rows.append(json.loads(lines.readlines()[-1]))
    return rows


def measure(args, kind):
    warm_memory(args.threads * 2**30)
    finer = args.radius / args.threads ** (1 / 3)
    runs = {"alone": [(args.radius, 1)], "side by side": [(args.radius, 1)] * args.threads,
            "together": [(finer, args.threads)]}[kind]
    with tempfile.TemporaryDirectory() as folder:
        rows = finish([start(args, folder, n, *run) for n, run in enumerate(runs)])
    return {"kind": kind, "threads": args.threads, "cells": [row["cells"] for row in rows],
            "refine_s": [row["phases_s"]["refine"] for row in rows],
            "cells_per_second": sum(row["refine_cells_per_second"] for row in rows),
            "cells_per_second_in_all": sum(row["cells_per_second"] for row in rows),
            "lock_conflicts": sum(row["outcomes"]["lock_conflict"] for row in rows),
            "committed": sum(row["outcomes"]["committed"] for row in rows),
            "phases_s": [row["phases_s"] for row in rows], "overhead_s": [row["overhead_s"] for row in rows]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("image")
    parser.add_argument("output", help="JSON lines are appended here")
    parser.add_argument("--radius", type=float, required=True, help="r_t of a run of one thread, mm")
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="default: all cores")
    parser.add_argument("--rounds", type=int, default=7, help="default 7")
    parser.add_argument("--podm", default="build/bin/podm", help="default build/bin/podm")
    args = parser.parse_args()
    kinds = ["alone", "side by side", "together"]
    runs = []
    for number in range(args.rounds):
        for kind in kinds if number % 2 == 0 else kinds[::-1]:
            runs.append({"round": number, "image": os.path.basename(args.image), "radius_mm": args.radius,
                         **measure(args, kind)})
            with open(args.output, "a") as output:
                output.write(json.dumps(runs[-1]) + "\n")
    rate = {kind: [run["cells_per_second"] for run in runs if run["kind"] == kind] for kind in kinds}
    for kind in kinds:
        print(f"{kind:13} {statistics.median(rate[kind]) / 1e6:7.3f} M cells/s refining")
    for base in "alone", "side by side":
        ratio = statistics.median(a / b for a, b in zip(rate["together"], rate[base]))
        print(f"together / {base}: {ratio:.3f} (median of {args.rounds} rounds)")
    together = [run for run in runs if run["kind"] == "together"]
    share = statistics.median(run["lock_conflicts"] / run["committed"] for run in together)
    print(f"rollbacks: {100 * share:.4f} % of operations")


if __name__ == "__main__":
    main()
