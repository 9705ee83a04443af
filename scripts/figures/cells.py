"""A verdict for each cell of Tables 1 and 2."""
from . import paper, resolution, scaling
from .reasons import why_missing

RATIO_TOLERANCE = 0.15  # for a ratio to one core
# A share agrees within this factor of the paper's share, or within one unit of the last digit that the paper prints.
# For zero hops the remote share is compared, so that half a percent makes a difference.
SHARE_FACTOR, SHARE_DIGIT = 2.0, 1e-4
COLUMNS = ("cells", "seconds", "rate", "speedup", "efficiency")


def cells(frame, series, hops):
    made = []
    for basis in scaling.BASES:
        made += _cells_of_table1(frame, scaling.first_of(series, basis), basis)
        made += _cells_of_table2(frame, hops, basis)
    return made


def near_share(published):
    """Returns (least, most) of the values that agree with a share of all accesses, or of accesses that leave their
    node."""
    return (min(published / SHARE_FACTOR, published - SHARE_DIGIT),
            max(published * SHARE_FACTOR, published + SHARE_DIGIT))


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
    """`deviation`: our value over the paper's, minus 1. The verdict compares the ratios to PODM on one core."""
    value = float(ours[cell["column"]])
    ratio = value / our_base
    cell.update(value=value, n=int(ours["n"]), deviation=value / cell["paper"] - 1, ratio_to_one_core=ratio,
                paper_ratio_to_one_core=paper_ratio)
    difference = ratio / paper_ratio - 1
    if cell["cores"] == 1 and cell["algorithm"] == "podm":
        cell.update(verdict="reference", reason="ratios refer to PODM on one core")
    elif cell["column"] == "cells":
        cell.update(verdict="reference", reason="rows are selected by it: cells grow with the cores, as in the paper")
    else:
        interval = _interval_of_ratio(cell, ours, ratio)
        least, most = ((1 + sign * RATIO_TOLERANCE) * paper_ratio for sign in (-1, 1))
        word = resolution.verdict(ratio, interval, least, most)
        doubt = resolution.doubt(interval) if word == resolution.NOT_RESOLVED else ""
        cell.update(verdict=word, reason=f"ratio to one core {ratio:.3g}, the paper's {paper_ratio:.3g}: "
                                         f"{100 * difference:+.0f} %{doubt}")


def _interval_of_ratio(cell, ours, ratio):
    """Returns the interval of a ratio. Each column's ratio to one core is the speed-up, or its inverse, times a
    constant."""
    interval = resolution.of_line(ours, "speedup", cell["basis"])
    if interval is resolution.EXACT:
        return interval
    spread = interval.map(lambda speedup: speedup / ours["speedup"])
    return spread.map(lambda factor: ratio / factor if cell["column"] == "seconds" else ratio * factor)


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
                none = {name: 0.0 for name in ("share", "share_low", "share_high")}
                _judge_share(cell, {**ours.loc[(cores, 0)], **none}, hop)
            else:
                cell["reason"] = why_missing(frame, None, basis, "pdr-podm", cores, needs_hops=True)
            made.append(cell)
    return made


def _judge_share(cell, ours, hop):
    """`deviation`: the difference of the shares. For zero hops the remaining shares are compared, as they are the small
    ones."""
    share = float(ours["share"])
    compared = [1 - one if hop == 0 else one for one in (share, cell["paper"])]
    what = "leave their node" if hop == 0 else f"take {hop} hops"
    interval = resolution.of_line(ours, "share", cell["basis"])
    if interval is not resolution.EXACT and hop == 0:
        interval = interval.map(lambda one: 1 - one)
    word = resolution.verdict(compared[0], interval, *near_share(compared[1]))
    doubt = resolution.doubt(interval) if word == resolution.NOT_RESOLVED else ""
    cell.update(value=share, n=int(ours["n"]), deviation=share - cell["paper"], verdict=word,
                reason=f"{100 * compared[0]:.2f} % {what}, in the paper {100 * compared[1]:.2f} %{doubt}")
