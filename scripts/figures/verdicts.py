"""What our records say about the paper: a verdict for each claim, and for each cell of Tables 1 and 2.

Machines differ, so only shapes are judged: ratios to one core, the crossover, the trend of efficiency, the share of
visits without hops. `agrees` and `differs` are within and beyond the tolerance; `better` is beyond it on the good
side; `reference` is the value that ratios refer to; `cannot_fill` says why there is none of ours.
"""
import pandas

from . import paper, scaling, table2

SCHEMA = "podm-figures/1"
RATIO_TOLERANCE = 0.15  # of a ratio to one core
SHARE_TOLERANCE = 0.01  # of all visits
HIGHER_IS_BETTER = {"cells": None, "seconds": False, "rate": True, "speedup": True, "efficiency": True}


def verdicts(frame, series, hops):
    """`hops`: the table of table2(). Measured and simulated are judged apart."""
    return {"schema": SCHEMA, "claims": claims(frame, series, hops), "cells": cells(frame, series, hops)}


def cells(frame, series, hops):
    made = []
    for basis in ("measured", "simulated"):
        made += _cells_of_table1(frame, scaling.first_of(series, basis), basis)
        made += _cells_of_table2(frame, hops, basis)
    return made


def _cells_of_table1(frame, series, basis):
    published = paper.corrected_table1()
    base = published.loc["podm", 1]
    made = []
    for (algorithm, cores), row in published.iterrows():
        has_ours = series is not None and (algorithm, cores) in series.table.index
        for column in HIGHER_IS_BETTER:
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
        return
    higher_is_better = HIGHER_IS_BETTER[cell["column"]]
    if abs(difference) <= RATIO_TOLERANCE:
        verdict = "agrees"
    elif higher_is_better is not None and (difference > 0) == higher_is_better:
        verdict = "better"
    else:
        verdict = "differs"
    cell.update(verdict=verdict, reason=f"ratio to one core {ratio:.3g}, the paper's {paper_ratio:.3g}")


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
    difference = float(ours["share"]) - cell["paper"]
    good = difference if hop == 0 else -difference
    verdict = "agrees" if abs(difference) <= SHARE_TOLERANCE else "better" if good > 0 else "differs"
    cell.update(value=float(ours["share"]), n=int(ours["n"]), deviation=difference, verdict=verdict,
                reason=f"{100 * difference:+.2f} points of share")


def why_missing(frame, series, basis, algorithm, cores, needs_hops=False):
    """Why a cell has no value of ours: the machine, the lack of a run, or runs that did not verify."""
    wanted = frame
    for column, value in (("basis", basis), ("algorithm", algorithm), ("cores", cores)):
        wanted = wanted[wanted[column] == value] if column in wanted else wanted.iloc[:0]
    if len(wanted):
        doubts = sorted(set(wanted.loc[~wanted["headline"], "doubt"]))
        if doubts and not wanted["headline"].any():
            return "no row to count: " + doubts[0]
        if needs_hops:
            return table2.why_no_hops(wanted)
        if series is None:
            return "no row of PODM on one core of this input, program and machine to refer to"
        return f"rows are of another series than {series.label()}"
    return lack_of_cores(frame, basis, cores) or f"no {basis} row of {algorithm} with {cores} cores"


def lack_of_cores(frame, basis, cores):
    """"needs 32 cores, has 2" where no machine of the rows has as many; empty otherwise. Simulations need none."""
    usable = frame["usable_cores"].dropna() if "usable_cores" in frame else pandas.Series(dtype=float)
    if basis == "simulated" or usable.empty or usable.max() >= cores:
        return ""
    return f"needs {cores} cores, has {int(usable.max())}"


def claims(frame, series, hops):
    """The paper's findings as statements on shapes."""
    made = []
    for basis in ("measured", "simulated"):
        one = scaling.first_of(series, basis)
        made += [_crossover(frame, one, basis), *_trends(frame, one, basis), _zero_hops(hops, frame, basis)]
    return made


def _claim(name, statement, published, basis):
    return {"claim": name, "statement": statement, "paper": published, "basis": basis, "value": None,
            "verdict": "cannot_fill", "reason": ""}


def crossover(table):
    """The fewest cores from which on PDR.PODM makes more elements per second than PODM; None without one."""
    both = table["rate"].unstack("algorithm").reindex(columns=list(paper.ALGORITHMS)).dropna()
    ahead = both["pdr-podm"] > both["podm"]
    behind = both.index[~ahead]
    after = both.index[both.index > behind.max()] if len(behind) else both.index
    return int(after.min()) if len(after) else None


def _crossover(frame, series, basis):
    published = crossover(paper.table1())
    claim = _claim("crossover", "PDR.PODM overtakes PODM between 128 and 160 cores", published, basis)
    both = [] if series is None else _common_cores(series.table)
    if not both or max(both) < published:
        claim["reason"] = lack_of_cores(frame, basis, published) or f"no rows of both algorithms up to {published} cores"
        return claim
    ours = crossover(series.table)
    claim.update(value=ours, verdict="agrees" if ours == published else "differs",
                 reason=f"PDR.PODM is ahead from {ours} cores on" if ours else "PDR.PODM is not ahead at the most cores")
    return claim


def _common_cores(table):
    sets = [set(table.loc[name].index) if name in table.index else set() for name in paper.ALGORITHMS]
    return sorted(set.intersection(*sets))


def _trends(frame, series, basis):
    """Efficiency at the most cores over that at the fewest beyond one core: what is kept of it."""
    for algorithm, statement in (("podm", "PODM's efficiency collapses: 106.6 % on 32 cores, 17.5 % on 256"),
                                 ("pdr-podm", "PDR.PODM keeps its efficiency: 90.7 % on 32 cores, 64.0 % on 256")):
        published = paper.table1().loc[algorithm]["efficiency"]
        claim = _claim(f"efficiency trend of {algorithm}", statement, float(published[256] / published[32]), basis)
        ours = None if series is None or algorithm not in series.table.index else series.table.loc[algorithm]["efficiency"]
        if ours is None or not {32, 256} <= set(ours.index):
            claim["reason"] = lack_of_cores(frame, basis, 256) or "no rows with 32 and with 256 cores"
        else:
            kept = float(ours[256] / ours[32])
            near = abs(kept - claim["paper"]) <= RATIO_TOLERANCE
            claim.update(value=kept, verdict="agrees" if near else "better" if kept > claim["paper"] else "differs",
                         reason=f"{100 * kept:.0f} % of the efficiency on 32 cores is left on 256")
        yield claim


def _zero_hops(hops, frame, basis):
    least = float(paper.table2().loc[0].min())
    claim = _claim("zero-hop share", "at least 98.85 % of the accesses of PDR.PODM stay on the node", least, basis)
    ours = hops[(hops["basis"] == basis) & (hops["algorithm"] == "pdr-podm")]
    zero = ours[ours["hops"] == 0]
    if ours.empty or ours["hops"].max() == 0:
        claim["reason"] = "a single NUMA node: no hop is possible" if len(ours) else table2.why_no_hops(frame)
        return claim
    worst = float(zero["share"].min())
    claim.update(value=worst, verdict="agrees" if worst >= least - SHARE_TOLERANCE else "differs",
                 reason=f"least share {100 * worst:.2f} %, up to {int(zero['cores'].max())} cores")
    return claim
