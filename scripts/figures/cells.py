"""A verdict for each cell of Tables 1 and 2."""
from . import paper, scaling
from .reasons import why_missing

RATIO_TOLERANCE = 0.15  # of a ratio to one core
# A share agrees within this factor of the paper's (where no hop is counted, of the remote share, so that half a percent
# tells), or within one unit of the last digit that the paper prints.
SHARE_FACTOR, SHARE_DIGIT = 2.0, 1e-4
COLUMNS = ("cells", "seconds", "rate", "speedup", "efficiency")


def cells(frame, series, hops):
    made = []
    for basis in scaling.BASES:
        made += _cells_of_table1(frame, scaling.first_of(series, basis), basis)
        made += _cells_of_table2(frame, hops, basis)
    return made


def shares_agree(ours, published):
    """The share of all accesses, or of those that leave their node."""
    is_near = published / SHARE_FACTOR <= ours <= published * SHARE_FACTOR
    return is_near or abs(ours - published) <= SHARE_DIGIT


def _cells_of_table1(frame, series, basis):
    published = paper.corrected_table1()
    base = published.loc["podm", 1]
    made = []
    for (algorithm, cores), row in published.iterrows():
        has_ours = series is not None and (algorithm, cores) in series.table.index
        for column in COLUMNS:
            cell = _cell("1", basis, algorithm, cores, column, float(row[column]))
            if has_ours:
                ours, our_base = series.table.loc[algorithm, cores], series.table.loc["podm", 1]
                _judge_ratio(cell, ours, row[column] / base[column], our_base[column])
            else:
                cell["reason"] = why_missing(frame, series, basis, algorithm, cores)
            made.append(cell)
    return made


def _cell(table, basis, algorithm, cores, column, published):
    return {"table": table, "basis": basis, "algorithm": algorithm, "cores": int(cores), "column": column,
            "paper": published, "value": None, "n": 0, "deviation": None, "ratio_to_one_core": None,
            "paper_ratio_to_one_core": None, "verdict": "cannot_fill", "reason": ""}


def _judge_ratio(cell, ours, paper_ratio, our_base):
    """`deviation`: ours over the paper's value, less 1. The verdict compares the ratios to PODM on one core."""
    value = float(ours[cell["column"]])
    ratio = value / our_base
    cell.update(value=value, n=int(ours["n"]), deviation=value / cell["paper"] - 1, ratio_to_one_core=ratio,
                paper_ratio_to_one_core=paper_ratio)
    difference = ratio / paper_ratio - 1
    if cell["cores"] == 1 and cell["algorithm"] == "podm":
        cell.update(verdict="reference", reason="ratios refer to PODM on one core")
    elif cell["column"] == "cells":
        cell.update(verdict="reference", reason="rows are chosen by it: cells grow with the cores, as the paper's")
    else:
        cell.update(verdict="agrees" if abs(difference) <= RATIO_TOLERANCE else "differs",
                    reason=f"ratio to one core {ratio:.3g}, the paper's {paper_ratio:.3g}: {100 * difference:+.0f} %")


def _cells_of_table2(frame, hops, basis):
    made = []
    ours = hops[(hops["basis"] == basis) & (hops["algorithm"] == "pdr-podm")].set_index(["cores", "hops"])
    published = paper.table2()
    for cores in published.columns:
        for hop, share in published[cores].items():
            cell = _cell("2", basis, "pdr-podm", cores, f"{hop} hops", float(share))
            if (cores, hop) in ours.index:
                _judge_share(cell, ours.loc[cores, hop], hop)
            elif cores in ours.index.get_level_values("cores"):
                _judge_share(cell, {"share": 0.0, "n": ours.loc[(cores, 0), "n"]}, hop)
            else:
                cell["reason"] = why_missing(frame, None, basis, "pdr-podm", cores, needs_hops=True)
            made.append(cell)
    return made


def _judge_share(cell, ours, hop):
    """`deviation`: of the shares. Without hops the shares that remain are compared, as they are the small ones."""
    share = float(ours["share"])
    compared = [1 - one if hop == 0 else one for one in (share, cell["paper"])]
    what = "leave their node" if hop == 0 else f"take {hop} hops"
    cell.update(value=share, n=int(ours["n"]), deviation=share - cell["paper"],
                verdict="agrees" if shares_agree(*compared) else "differs",
                reason=f"{100 * compared[0]:.2f} % {what}, in the paper {100 * compared[1]:.2f} %")
