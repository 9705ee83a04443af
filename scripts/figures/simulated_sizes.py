"""Simulated speed-ups of every size beside the paper's: how far a column depends on the cells per core, and how much of
the workers' time the fitted constants decide."""
import pandas

from . import paper, scaling, style
from .deviation import ROLES
from .table1 import with_bounds

NOT_SIMULATED = "not simulated"
# Causes of worker time that the constants of the network and of remote memory decide.
FITTED_CAUSES = ("memory_remote", "network_queue")
BLADE = 16  # cores that share a memory on the paper's machine
NOTE = ("Each size is relative to PODM on one core with the same number of cells per core. Brackets: interval of "
        "order statistics over seeds; of five seeds the least and the greatest, which hold the median with 94 %. The "
        f"paper's {scaling.short(3e6)} cells per core were {NOT_SIMULATED}, and no value here is extrapolated to them.")


def speedups(series):
    """One line per number of cores beyond one, as text. For each algorithm: the paper's speed-up over PODM on one core,
    the simulated speed-ups by cells per core, and the greatest of these over the least."""
    published, sizes = paper.corrected_table1()["speedup"], scaling.simulated_sizes(series)
    lines = []
    for cores in (count for count in scaling.core_counts([one.table for one in sizes]) if count > 1):
        line = {"cores": cores}
        for algorithm in style.NAMES:
            simulated = [one for one in sizes if _has_rows(one, algorithm)]
            if simulated:
                line.update(_of_algorithm(algorithm, cores, simulated, published))
        lines.append(line)
    return pandas.DataFrame(lines)


def _has_rows(series, algorithm):
    """True if the series has rows of the algorithm on more than one core."""
    return any(name == algorithm and cores > 1 for name, cores in series.table.index)


def readable(table):
    return table


def _of_algorithm(algorithm, cores, sizes, published):
    name, line, found = style.NAMES[algorithm], {}, []
    if algorithm in ROLES:
        line[f"{name}: paper"] = f"{published[algorithm, cores]:.1f}" if (algorithm, cores) in published else ""
        name += f", {ROLES[algorithm]}"
    for one in sizes:
        text = NOT_SIMULATED
        if (algorithm, cores) in one.table.index:
            row = one.table.loc[algorithm, cores]
            found.append(row["speedup"])
            text = with_bounds(row["speedup"], row["speedup_low"], row["speedup_high"], 1)
        line[f"{name}: {scaling.short(one.cells_per_core)}"] = text
    if len(sizes) > 1:
        line[f"{name}: greatest over least"] = f"{max(found) / min(found):.2f}" if len(found) > 1 else ""
    return line


def depends_on_size(series, cores=256):
    """Returns a sentence on PDR.PODM's column if two sizes or more were simulated on `cores` cores; empty otherwise."""
    found = {scaling.short(one.cells_per_core): one.table.loc["pdr-podm", cores]["speedup"]
             for one in scaling.simulated_sizes(series) if ("pdr-podm", cores) in one.table.index}
    if len(found) < 2:
        return ""
    values, sizes = (" and ".join([", ".join(some[:-1]), some[-1]])
                     for some in ([f"{one:.0f}" for one in found.values()], list(found)))
    return (f"Simulated, PDR.PODM's column is not fitted and depends on the cells per core: {values} times PODM on one "
            f"core on {cores} cores with {sizes} cells per core. The paper's {scaling.short(3e6)} per core were "
            f"{NOT_SIMULATED}.")


def fitted_shares(frame, series):
    """One line per algorithm and size, for more than one blade: the greatest shares of worker time, over numbers of
    cores, for memory of other blades and for queueing in the network. Empty if rows have no causes."""
    lines = []
    for one in scaling.simulated_sizes(series):
        rows = scaling.rows_of(frame, one)
        causes = [column for column in rows if column.startswith("virtual.worker_s.")]
        if not {f"virtual.worker_s.{cause}" for cause in FITTED_CAUSES} <= set(causes):
            continue
        shares = rows[causes].div(rows[causes].sum(axis=1), axis=0)
        for algorithm in (name for name in style.NAMES if name in set(rows["algorithm"])):
            beyond = shares[(rows["algorithm"] == algorithm) & (rows["cores"] > BLADE)]
            if len(beyond):
                lines.append({"algorithm": algorithm, "cells_per_core": one.cells_per_core, "n": len(beyond),
                              **{cause: beyond[f"virtual.worker_s.{cause}"].max() for cause in FITTED_CAUSES}})
    return pandas.DataFrame(lines)


def readable_shares(table):
    words = dict(zip(FITTED_CAUSES, ("memory of other blades", "queueing in the network")))
    return pandas.DataFrame({
        "algorithm": [style.NAMES[name] for name in table["algorithm"]],
        "cells per core": [scaling.short(size) for size in table["cells_per_core"]], "rows": table["n"],
        **{f"{words[cause]}, at most, % of worker time": [f"{100 * share:.2f}" for share in table[cause]]
           for cause in FITTED_CAUSES}})
