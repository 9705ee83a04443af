"""Table 2: shares of the visits of cells and vertices by hops between the visiting and the owning node."""
import numpy
import pandas

from . import paper, scaling
from .table1 import in_order

COLUMNS = ["basis", "algorithm", "cores", "hops", "share", "visits", "n"]


def table2(frame):
    """One line a basis, algorithm, number of cores and hops. Counts of a setting's verified rows are added up."""
    published = paper.table2().melt(ignore_index=False, var_name="cores", value_name="share").reset_index()
    blocks = [published.assign(basis="published", algorithm="pdr-podm", visits=numpy.nan, n=numpy.nan)]
    rows = _rows_with_hops(frame)
    for (basis, algorithm, cores), group in rows.groupby(["basis", "algorithm", "cores"]) if len(rows) else ():
        counts = _sum_of(group["hops"])
        blocks.append(pandas.DataFrame({
            "hops": range(len(counts)), "share": counts / counts.sum(), "visits": counts, "basis": basis,
            "algorithm": algorithm, "cores": cores, "n": len(group),
        }))
    return pandas.concat(blocks, ignore_index=True)[COLUMNS].astype({"n": "Int64"})


def readable(table):
    """One line a number of cores, algorithm and basis; hops across, in percent."""
    wide = table.pivot_table(index=["cores", "algorithm", "basis"], columns="hops", values="share")
    wide.columns = [f"{hops} hops" for hops in wide.columns]
    shown = wide.applymap(lambda share: "" if pandas.isna(share) else f"{100 * share:.2f} %").reset_index()
    return in_order(shown)


def why_no_hops(frame):
    """What rows say in place of counts, or that there is no row."""
    rows = scaling.headline_rows(frame)
    said = [] if rows.empty or "hops" not in rows else [hops for hops in rows["hops"] if isinstance(hops, str)]
    return said[-1] if said else "no verified row counts hops"


def _rows_with_hops(frame):
    """Of one machine, program and input: those with the most core counts, then the newest."""
    rows = scaling.headline_rows(frame)
    if rows.empty or "hops" not in rows:
        return rows.iloc[:0]
    rows = rows[[isinstance(hops, list) and sum(hops) > 0 for hops in rows["hops"]]]
    if rows.empty:
        return rows
    chosen = {}
    for values, group in rows.groupby(scaling.KEY, sort=False):
        rank = (group["cores"].nunique(), group.index.max())
        if rank > chosen.get(values[0], ((0, 0), None))[0]:
            chosen[values[0]] = (rank, group)
    return pandas.concat([group for _, group in chosen.values()])


def _sum_of(lists):
    total = numpy.zeros(max(map(len, lists)))
    for counts in lists:
        total[: len(counts)] += counts
    return total
