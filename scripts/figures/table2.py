"""Table 2: shares of accesses by hops between the accessing node and the node that owns the accessed memory.

As in the paper, reads of the mesh are counted: visits of its cells and vertices. Beside them is the share with the
other kinds included: writes of the mesh, reads of the image and of its transform.
"""
import numpy
import pandas

from . import paper, scaling
from .spread import order_interval
from .table1 import in_order, marked

COLUMNS = ["basis", "kind", "algorithm", "cores", "nodes", "hops", "share", "share_low", "share_high", "coverage",
           "share_all_kinds", "visits", "n", "series"]
PAPER_NODE = 16  # cores per blade of the paper's machine
KINDS = "hops_by_kind."


def table2(frame):
    """One line per basis, algorithm, number of cores and hops. A cell uses the rows of one trial and size; counts of
    its repeats and seeds are added."""
    published = paper.table2().melt(ignore_index=False, var_name="cores", value_name="share").reset_index()
    blocks = [published.assign(basis="published", kind="published", algorithm="pdr-podm",
                               nodes=-(-published["cores"] // PAPER_NODE), series="Table 2 of the paper")]
    for rows in _shown(frame):
        blocks += _blocks_of(rows)
    table = pandas.concat(blocks, ignore_index=True).reindex(columns=COLUMNS)
    return table.astype({"n": "Int64", "nodes": "Int64", "cores": int})


def readable(table):
    """One line per number of cores, algorithm and basis; one column per hops, in percent, with the mark of the
    basis."""
    lines = []
    for (cores, algorithm, basis), group in table.groupby(["cores", "algorithm", "basis"]):
        shares = {row["hops"]: marked(_percent(row["share"], row["share_low"], row["share_high"]), basis)
                  for _, row in group.iterrows()}
        zero = group[group["hops"] == 0].iloc[0]
        lines.append({"cores": cores, "algorithm": algorithm, "basis": basis, "kind": zero["kind"],
                      **{f"{hops} hops": shares.get(hops, "") for hops in range(int(table["hops"].max()) + 1)},
                      "0 hops, all kinds": marked(_percent(zero["share_all_kinds"]), basis)})
    shown = in_order(pandas.DataFrame(lines))
    return shown.assign(basis=shown["kind"]).drop(columns="kind")


def why_no_hops(frame):
    """Returns the text that rows have in place of counts, or that there is no row."""
    rows = scaling.headline_rows(frame)
    reasons = [] if rows.empty or "hops" not in rows else [hops for hops in rows["hops"] if isinstance(hops, str)]
    return reasons[-1] if reasons else "no verified row counts hops"


def zero_hop_share(counts):
    """Returns the zero-hop share of one row's counts, or the reason why there is none."""
    return counts[0] / sum(counts) if isinstance(counts, list) and sum(counts) else counts


def _percent(share, low=numpy.nan, high=numpy.nan):
    """Returns "99.12 %", with its interval in brackets if there is one."""
    if pandas.isna(share):
        return ""
    return f"{100 * share:.2f} %" + ("" if pandas.isna(low) else f" [{100 * low:.2f}, {100 * high:.2f}]")


def _blocks_of(rows):
    """Yields a block per number of cores and algorithm."""
    size = scaling.short((rows["cells"] / rows["cores"]).median())
    for (algorithm, cores), group in rows.groupby(["algorithm", "cores"]):
        group = scaling.of_one_size(group)
        kind = f"simulated, {size} cells per core" if _grows(rows) else "simulated, one mesh on any number of cores"
        yield _block(group).assign(algorithm=algorithm, cores=cores,
                                   kind=kind if group["basis"].iloc[0] == "simulated" else group["basis"].iloc[0])


def _grows(rows):
    """True if the cells grow with the cores."""
    per_core = rows["cells"] / rows["cores"]
    return per_core.max() / per_core.min() <= (1 + scaling.SIZE_TOLERANCE) ** 2


def _block(group):
    counts = _sum_of(group["hops"])
    nodes = group["leaves.nodes"].max() if "leaves.nodes" in group else numpy.nan
    return pandas.DataFrame({
        "basis": group["basis"].iloc[0], "hops": range(len(counts)), "share": counts / counts.sum(), "visits": counts,
        "share_all_kinds": _shares_of_all_kinds(group, len(counts)), "n": len(group), "nodes": nodes,
        "series": _label(group.iloc[-1]), **_bounds_of_shares(group, len(counts))})


def _bounds_of_shares(group, length):
    """Returns the interval of each share over the rows. Virtual workers give the same shares in each run."""
    if group["basis"].iloc[0] != "measured":
        return {}
    shares = [[*counts, *[0] * (length - len(counts))] / numpy.sum(counts) for counts in group["hops"]]
    return dict(zip(("share_low", "share_high", "coverage"), zip(*map(order_interval, zip(*shares)))))


def _shares_of_all_kinds(group, length):
    """Returns nan if a row lacks some kind."""
    kinds = [name for name in group if name.startswith(KINDS)]
    lists = [counts for name in kinds for counts in group[name]]
    if not lists or not all(isinstance(counts, list) for counts in lists):
        return numpy.full(length, numpy.nan)
    counts = _sum_of(lists)[:length]
    return counts / counts.sum()


def _label(row):
    parts = (row["experiment"], row["setting"], row["image"], f"{row['cells'] / 1e6:.2g} M cells", row["machine"])
    return ", ".join(part for part in parts if part)


def _shown(frame):
    """Returns for each basis the rows of one machine, program, trial and image: those with the most core counts, then
    the most cells, then the newest."""
    rows = scaling.headline_rows(frame)
    if rows.empty or "hops" not in rows:
        return []
    rows = rows[[isinstance(hops, list) and sum(hops) > 0 for hops in rows["hops"]] & (rows["cores"] > 1)]
    chosen = {}
    for values, group in rows.groupby(scaling.KEY, sort=False) if len(rows) else ():
        has_pdr_podm = (group["algorithm"] == "pdr-podm").any()
        rank = (has_pdr_podm, group["cores"].nunique(), group["cells"].max(), group.index.max())
        if values[0] not in chosen or rank > chosen[values[0]][0]:
            chosen[values[0]] = (rank, group)
    return [group for _, group in chosen.values()]


def _sum_of(lists):
    total = numpy.zeros(max(map(len, lists)))
    for counts in lists:
        total[: len(counts)] += counts
    return total
