#!/usr/bin/python3
"""Times `podm mesh` and CGAL's mesher on one image in interleaved rounds and prints medians.

Needs build/bin/podm and a build of harness/peers/cgal_mesh3 (GPL, cmake -DPODM_BUILD_CGAL_PEER=ON). Both are given as many
threads; on one, CGAL's sequential meshers run too. podm's rate counts refinement only, CGAL's the meshing call only:
loading, transform and writing are left out. Every run becomes a JSON line of OUTPUT.
"""
import argparse
import json
import os
import statistics
import subprocess
import tempfile

from warm_memory import warm_memory


def run_podm(args, folder):
    record = os.path.join(folder, "record.jsonl")
    command = [args.podm, "mesh", args.image, "-o", os.path.join(folder, "mesh.vtu"), "--record", record, "--quiet",
               "--threads", str(args.threads)]
    for option in ("radius", "delta"):
        if getattr(args, option) is not None:
            command += ["--" + option, str(getattr(args, option))]
    subprocess.run(command, check=True)
    with open(record) as lines:
        row = json.loads(lines.readlines()[-1])
    return {"cells": row["cells"], "seconds": row["phases_s"]["refine"], "peak_rss_bytes": row["peak_rss_bytes"]}


def run_cgal(program, args, threads):
    command = [program, args.image, "--facet-distance", str(args.facet_distance), "--threads", str(threads)]
    if args.cell_size is not None:
        command += ["--cell-size", str(args.cell_size)]
    row = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return {"cells": row["cells"], "seconds": row["seconds"], "peak_rss_bytes": row["peak_rss_bytes"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("image", help="an .inr or .inr.gz file, the format that both read")
    parser.add_argument("output", help="JSON lines are appended here")
    parser.add_argument("--radius", type=float, help="podm's r_t, mm (default: none, the surface drives)")
    parser.add_argument("--delta", type=float, help="podm's delta, mm (default: podm's own)")
    parser.add_argument("--cell-size", type=float, help="CGAL's, mm (default: none)")
    parser.add_argument("--facet-distance", type=float, default=1.0, help="CGAL's, mm (default 1)")
    parser.add_argument("--threads", type=int, default=1, help="default 1")
    parser.add_argument("--rounds", type=int, default=3, help="default 3")
    parser.add_argument("--podm", default="build/bin/podm", help="default build/bin/podm")
    parser.add_argument("--peers", default="build/bin", help="folder of cgal_mesh3 (default build/bin)")
    args = parser.parse_args()

    peers = {"CGAL parallel": (os.path.join(args.peers, "cgal_mesh3"), args.threads)}
    if args.threads == 1:
        peers |= {"CGAL sequential": (os.path.join(args.peers, "cgal_mesh3"), 0),
                  "CGAL sequential, unsorted": (os.path.join(args.peers, "cgal_mesh3_unsorted"), 0)}
    runs = []
    with tempfile.TemporaryDirectory() as folder:
        for number in range(args.rounds):
            warm_memory()
            measured = {"podm": run_podm(args, folder)}
            for name, (program, threads) in peers.items():
                warm_memory()
                measured[name] = run_cgal(program, args, threads)
            runs += [{"round": number, "mesher": name, **row} for name, row in measured.items()]
    options = {key: value for key, value in vars(args).items() if key not in ("podm", "peers", "output", "image")}
    with open(args.output, "a") as output:
        for row in runs:
            output.write(json.dumps({"image": os.path.basename(args.image), "options": options, **row}) + "\n")
    rates = {}
    for name in ["podm", *peers]:
        rows = [row for row in runs if row["mesher"] == name]
        rates[name] = [row["cells"] / row["seconds"] for row in rows]
        ahead = statistics.median(podm / rate for podm, rate in zip(rates["podm"], rates[name]))
        peak = max(row["peak_rss_bytes"] for row in rows) / 2**20
        print(f"{name:28} {rows[0]['cells']:>10} cells {statistics.median(rates[name]) / 1e6:7.3f} M cells/s {peak:8.0f} MiB"
              f"   podm is {ahead:.2f} times as fast")


if __name__ == "__main__":
    main()
