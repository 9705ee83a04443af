"""Synthetic rows, schedules and meshes for tests; never results."""
import copy
import itertools
import random

PASSED = {claim: "pass" for claim in ("structure", "delaunay", "radius_edge", "boundary_angles", "size", "conformity")}
ROW = {
    "schema": 4, "experiment": "weak", "repeat": 1, "warmup": False, "status": "ok", "reason": "",
    "algorithm": "podm", "input": {"name": "phantom:synthetic", "path": "inputs/synthetic.nii.gz"},
    "threads": {"asked": 1, "used": 1}, "virtual": None, "replay": None,
    "phases_s": {"read": 1.0, "transform": 1.0, "refine": 24.0, "extract": 1.18, "measure": 3.0, "write": 5.0,
                 "calibrate": 60.0, "draw": 7.0},
    "cells": 3_000_000, "quality": {"max_radius_edge": 1.92, "min_facet_angle_deg": 30.4}, "verdicts": PASSED,
    "programs": {"podm": {"sha256": "ab" * 32, "version": "podm 0.1.0"}},
    "environment": {"cpu": "Synthetic CPU", "usable_processors": 2, "kernel": "Linux", "compiler": "GNU 12"},
}
SEEDS = itertools.count(1)  # no row replaces another
BIG_MACHINE = ROW["environment"] | {"usable_processors": 256}


def row(algorithm="podm", cores=1, **changes):
    """Makes a row. A run in virtual time has virtual seconds; the present machine's seconds then have no meaning."""
    made = copy.deepcopy(ROW)
    made.update(algorithm=algorithm, threads={"asked": cores, "used": cores}, cells=3_000_000 * cores,
                trial=f"synthetic,algorithm={algorithm},threads={cores},seed={next(SEEDS)}")
    made.update(changes)
    if made.get("executor") == "virtual" and not made["virtual"]:
        timed = {phase: made["phases_s"][phase] for phase in ("initial", "refine") if phase in made["phases_s"]}
        timed["refine"] += sum(made["phases_s"].get(phase, 0) for phase in ("read", "transform", "octree", "extract"))
        made["virtual"] = {"cost": "measured", "refine_s": sum(timed.values()), "phases_s": timed}
        made.update(phases_s={"read": 1.0, "refine": 1e6, "write": 9.0}, process={"wall_s": 1234.5},
                    overhead_s={"contention": 3.0, "begging": 2.0, "rollback": 1.0})
    counted = made.get("process", {}).get("counters", {}).values()
    on_simulated_core = any("simulated" in one["source"] for one in counted if isinstance(one, dict))
    made["basis"] = "simulated" if made.get("executor") == "virtual" or on_simulated_core else "measured"
    return made


def like_the_paper(published, repeats=5, spread=0.02, **changes):
    """Yields rows with the seconds of `figures.paper.table1`, times a random factor, for a machine of 256 cores."""
    changes.setdefault("environment", BIG_MACHINE)
    noise = random.Random(1)
    for (algorithm, cores), line in published.iterrows():
        for repeat in range(1, repeats + 1):
            total = line["seconds"] * (1 + noise.uniform(-spread, spread))
            phases = {"read": 0.02 * total, "transform": 0.03 * total, "refine": 0.9 * total, "extract": 0.05 * total,
                      "write": 9.0}
            if algorithm == "pdr-podm":
                phases.update(octree=0.02 * total, initial=0.18 * total, refine=0.7 * total)
            yield row(algorithm, cores, cells=int(line["cells"]), phases_s=phases, repeat=repeat, **changes)


def with_hops(rows, shares):
    """Adds counts by hops to each row of PDR.PODM: `shares` of each number of cores, 16 cores per node."""
    for one in rows:
        cores = one["threads"]["used"]
        if one["algorithm"] == "pdr-podm" and cores in shares:
            one["hops"] = [int(1e7 * share) for share in shares[cores]]
            one["leaves"] = {"nodes": -(-cores // 16)}
        yield one


def simulated_size(cells_per_core, speedup_of, counts=(1, 32, 256), zero_hops=None, algorithms=("podm", "pdr-podm"),
                   **changes):
    """Yields rows of one size of a simulated weak scaling: 0.1 M cells/s on one core; beyond one core the speed-ups are
    those of `speedup_of` (algorithm, cores)."""
    name = f"{cells_per_core // 1000}k"
    for algorithm, cores in itertools.product(algorithms, counts):
        speedup = 1 if cores == 1 else speedup_of(algorithm, cores)
        seconds = cells_per_core * cores / (1e5 * speedup)
        made = row(algorithm, cores, experiment="simulated_weak", executor="virtual", cells=cells_per_core * cores,
                   trial=f"{name}-on-{cores},algorithm={algorithm}", input={"name": f"phantom:synthetic@{name}"},
                   phases_s={"refine": seconds}, **changes)
        if zero_hops is not None and cores > 16:
            made.update(hops=[int(1e9 * zero_hops), int(1e9 * (1 - zero_hops))], leaves={"nodes": cores // 16})
        yield made


def with_losses(rows, **shares):
    """Adds worker seconds by cause to each row in virtual time: these shares of all its cores' seconds."""
    for one in rows:
        whole = sum(one["virtual"]["phases_s"].values()) * one["threads"]["used"]
        one["virtual"]["worker_s"] = {cause: share * whole for cause, share in shares.items()}
        yield one


def with_levels(cycles):
    """Returns a row that measured memory levels: caches, the own node's memory, another node's."""
    modules = ["L1 cache", "L2 cache", "L3 cache", "memory of the own node 0", "memory of another node 1"]
    return row(memory_levels=[{"level": level, "module": module, "size_bytes": 2**20, "cycles": cost}
                              for level, (module, cost) in enumerate(zip(modules, cycles), start=1)])


def peer(name, cells=1_000_000, **changes):
    """Returns a row of another mesher, which begins with a surface, promises one claim and misses another."""
    changes = {"phases_s": {"surface": 4.0, "refine": 10.0, "write": 3.0}, **changes}
    made = row(name, cells=cells, promises=["structure"], verdicts={**PASSED, "delaunay": "fail"}, **changes)
    made["programs"]["peer"] = {"name": name, "version": "synthetic"}
    return made


def solved(iterations, image="synthetic", optimize=None, min_dihedral=None, mesher=None, angles=(5, 170), **changes):
    """Returns a row whose mesh was given to a solver. Its dihedral angles are `angles`, in equal numbers."""
    made = peer(mesher) if mesher else row()
    name = mesher or f"{'both' if optimize else 'r7' if min_dihedral else 'none'}"
    one = {"iterations": iterations, "smallest_eigenvalue": 0.1, "largest_eigenvalue": 2.5, "seconds": 1.0}
    by_preconditioner = {"unknowns": 9, "jacobi": one, "amg": {**one, "iterations": iterations // 10}}
    counts = [0] * 180
    for angle in angles:
        counts[int(angle)] += 6 * made["cells"] // len(angles)
    asked = {"threads": 1, "solve": True, "optimize": optimize, "min_dihedral": min_dihedral}
    made.update(experiment="solvers", trial=f"1M-{name}", input={"name": image},
                asked={key: value for key, value in asked.items() if value is not None},
                solve={"solver": "synthetic", "poisson": by_preconditioner, "elasticity": by_preconditioner},
                dihedral_deg={"least": min(angles), "largest": max(angles), "counts": counts}, **changes)
    return made


def experiment_verdicts(**verdicts):
    """Returns verdicts as podm-bench writes them: claims by name and verdict, all of one experiment."""
    interval = {"low": 1.25, "high": 1.75, "coverage": 0.75, "rounds": 3}
    claims = [{"name": name, "statement": f"{name} is so", "basis": "measured", "verdict": verdict,
               "reason": f"because of <{name}>", "value": 1.5, "interval": interval, "rounds_needed": None,
               "bound": "at least 2", "sizes": [], "n": 3}
              for name, verdict in verdicts.items() if verdict != "withdrawn"]
    withdrawn = [{"name": name, "statement": "", "verdict": verdict, "reason": f"because of <{name}>",
                  "superseded_by": "another"} for name, verdict in verdicts.items() if verdict == "withdrawn"]
    return {"schema": "podm-bench-verdicts/2", "experiments": [
        {"experiment": "weak_scaling", "title": "Weak scaling", "claim": "so", "paper": "Table 1", "claims": claims,
         "withdrawn": withdrawn}]}


def paper_verdicts(lines, verdict="holds", **of_claims):
    """Returns podm-bench's verdicts on the claims that judge lines of results/paper/claims.toml. `of_claims`: other
    verdicts by name."""
    claims = {}
    for side in ("measured", "simulated"):
        for line in lines:
            for name in line[side].get("claims", []):
                is_of_both = name in claims and claims[name]["basis"] != side
                claims[name] = {"name": name, "statement": f"{name} is so", "basis": "any" if is_of_both else side,
                                "verdict": of_claims.get(name, verdict), "reason": f"because of <{name}>",
                                "value": 1.5, "bound": 2.0, "n": 3}
    found = experiment_verdicts()
    found["experiments"][0]["claims"] = list(claims.values())
    return found


def schedule(side=9):
    """Returns a flat grid of leaves, two of which are active at the same time, with disjoint rings."""
    leaves = [[i, j, 0, 1] for j in range(side) for i in range(side)]
    head = {"schema": "podm-schedule/1", "algorithm": "pdr-podm", "leaves": leaves,
            "mesh_to_grid": [0.1, 0, 0, 0, 0, 0.1, 0, 0, 0, 0, 0.1, 0]}
    active = [(2 + 2 * side, 0, 0.0, 1.0, 900), (6 + 6 * side, 1, 0.5, 1.5, 800), (0, 0, 2.0, 3.0, 999)]
    return [head] + [{"leaf": leaf, "node": node, "begin_s": begin, "end_s": end, "operations": operations,
                      "deferred": 0, "touched_leaves": [leaf]} for leaf, node, begin, end, operations in active]


def report():
    """Returns a report of podm-verify with the parts that figure 1 reads."""
    def histogram(name, low, high, minimum, maximum):
        return {"name": name, "unit": "", "low": low, "high": high, "minimum": minimum, "maximum": maximum,
                "counts": [0, 3, 9, 20, 11, 5, 1, 0]}

    return {"schema": "podm-verify/1", "mesh": {"path": "synthetic.vtu", "cells": 49},
            "claims": {"radius_edge": {"histograms": [histogram("radius_edge_ratio", 0.6, 2.0, 0.62, 1.92),
                                                      histogram("dihedral_angle", 0, 180, 2.0, 170.0)]},
                       "boundary_angles": {"histograms": [histogram("boundary_facet_angle", 0, 180, 30.2, 118.0)]}}}


def box_mesh(side=4):
    """Returns a cube of side^3 unit cubes of six tetrahedra each: points, cells and labels; there are two labels."""
    import numpy

    steps = numpy.stack(numpy.meshgrid(*[range(side + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    number = {tuple(point): index for index, point in enumerate(steps)}
    cells, labels = [], []
    for corner in numpy.ndindex(side, side, side):
        for order in itertools.permutations(range(3)):  # Kuhn: one path along the axes per order of the axes
            path = [numpy.array(corner)]
            for axis in order:
                path.append(path[-1] + numpy.eye(3, dtype=int)[axis])
            cells.append([number[tuple(point)] for point in path])
            labels.append(1 + (corner[0] >= side // 2))
    return steps.astype(float), numpy.array(cells), numpy.array(labels)


def write_vtu(path, points, cells, labels):
    """Writes an ASCII .vtu file, a form that podm does not write."""
    def array(name, kind, values, extra=""):
        return f'<DataArray type="{kind}" Name="{name}" format="ascii"{extra}>{" ".join(map(str, values))}</DataArray>'

    count = len(cells)
    path.write_text(
        '<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">'
        f"""<Points>{array("Points", "Float64", points.ravel(), ' NumberOfComponents="3"')}</Points>"""
        f'<Cells>{array("connectivity", "Int64", cells.ravel())}{array("offsets", "Int64", range(4, 4 * count + 1, 4))}'
        f'{array("types", "UInt8", [10] * count)}</Cells>'
        f'<CellData>{array("label", "Int32", labels)}</CellData></Piece></UnstructuredGrid></VTKFile>')
