"""Judges the bounds on dihedral angles that a run was asked for: by rule R7 (--min-dihedral) and by optimisation."""
from .html import Bar

REGULAR_DEG = 70.53  # the dihedral angles of a regular tetrahedron
NO_BOUND = ("Dihedral angles have no bound without <code>--optimize</code> or <code>--min-dihedral</code>: the "
            "extremes are of few cells, as the histograms show.")
UNMOVED = {"spacing": "other vertices too near", "shape": "no better place found", "surface": "held by the surface",
           "not_reached": "not reached before the run ended"}
OBSTACLES = {"frozen_facets": "two facets of one surface", "junction": "three labels meet",
             "frozen_vertices": "all vertices on surfaces", "other": "none of these"}


def judged(record):
    """(verdict, statement, reason) for each bound that was asked for. A cell out of bounds is a fail here, though
    podm counts it and misses no guarantee by it."""
    return [*_of_perturbation(record), *_of_optimization(record)]


def asked(record):
    """(least, largest) of the narrowest bounds asked for, degrees; None where there are none."""
    bounds = [_perturbed_bounds(record), _optimized_bounds(record)]
    bounds = [one for one in bounds if one]
    return (max(low for low, _ in bounds), min(high for _, high in bounds)) if bounds else None


def bars_of(record):
    """The extremes, beside the bounds where there are any."""
    quality, bounds = record["quality"], asked(record)
    least, largest = quality["min_dihedral_deg"], quality["max_dihedral_deg"]
    if bounds is None:
        return [Bar("smallest dihedral angle", least / REGULAR_DEG, f"{least:.3g}°, largest {largest:.4g}°", "own")]
    return [Bar("smallest dihedral angle", least / REGULAR_DEG, f"{least:.4g}°, bound {bounds[0]:g}°", "own"),
            Bar("largest dihedral angle", largest / 180, f"{largest:.4g}°, bound {bounds[1]:g}°", "own")]


def _perturbed_bounds(record):
    told = record["perturbed"]
    return (told["min_dihedral_deg"], told["max_dihedral_deg"]) if told else None


def _optimized_bounds(record):
    told = record["options"]["optimize"]
    return (told["least_dihedral_deg"], told["largest_dihedral_deg"]) if told else None


def _statement(bounds, option):
    return f"all cells have dihedral angles from {bounds[0]:g} to {bounds[1]:g} degrees ({option})"


def _of_perturbation(record):
    option = f"--min-dihedral {record['options']['min_dihedral_deg']:g}"
    bounds, told = _perturbed_bounds(record), record["perturbed"]
    if not told:
        if record["options"]["min_dihedral_deg"] > 0:
            yield "not_run", f"no vertex was moved ({option})", "the run ended before"
        return
    before = sum(told["before"].values())
    if record["optimization"] is not None:  # it changed cells after R7 had counted them
        yield _by_extremes(record, bounds, option)
        return
    left = sum(told["after"].values())
    reason = f"cells out of bounds: {left:,}, before {before:,}{_listed(told['unmoved'], UNMOVED)}"
    yield "fail" if left else "pass", _statement(bounds, option), reason


def _of_optimization(record):
    bounds, told = _optimized_bounds(record), record["optimization"]
    if bounds and told:
        left, before = told["beyond_bounds"], told["beyond_bounds_before"]
        reason = f"cells out of bounds: {left:,}, before {before:,}{_listed(told['obstacles'], OBSTACLES)}"
        yield "fail" if left else "pass", _statement(bounds, "--optimize"), reason
    elif bounds:
        yield "not_run", "the mesh was not optimised (--optimize)", "the run ended before"


def _by_extremes(record, bounds, option):
    least, largest = record["quality"]["min_dihedral_deg"], record["quality"]["max_dihedral_deg"]
    holds = bounds[0] <= least and largest <= bounds[1]
    return ("pass" if holds else "fail", _statement(bounds, option),
            f"after optimisation they are from {least:.4g} to {largest:.4g} degrees")


def _listed(counts, words):
    listed = [f"{words.get(name, name)} {count:,}" for name, count in counts.items() if count]
    return f" ({', '.join(listed)})" if listed else ""
