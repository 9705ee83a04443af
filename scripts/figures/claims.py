"""A verdict for each finding of the paper: statements on shapes, each with the opposite that would refute it."""
import math

from . import paper, resolution, scaling, table2, table3
from .cells import RATIO_TOLERANCE, SHARE_FACTOR, near_share
from .reasons import lack_of_cores, of_basis
from .style import NAMES

CROSSOVER = (128, 160)  # the paper's: PODM ahead on the first, PDR.PODM on the second
ABOVE_ONE = math.nextafter(1, 2)
TURNING = 128  # PODM's speed-up falls from this number of cores on
# Bound on the mean absolute deviation of speed-ups from the paper's. Simulations are fitted to PODM's column only.
DEVIATIONS = {"podm": 0.08, "pdr-podm": 0.15}


def claims(frame, series, hops):
    made = []
    for basis in scaling.BASES:
        shown = scaling.simulated_sizes(series) if basis == "simulated" else [scaling.first_of(series, basis)]
        for one in shown or [None]:
            judged = [_crossover(frame, one, basis), *_trends(frame, one, basis), *_turns(frame, one, basis),
                      *_deviations(frame, one, basis)]
            made += [_with_size(claim, one) for claim in judged] if len(shown) > 1 else judged
        made += [_zero_hops(hops, frame, basis), _zero_hop_cells(hops, frame, basis)]
    return made + _latencies(frame)


def _with_size(claim, series):
    """Adds the size to the claim; each size has its own verdict."""
    size = f", {scaling.short(series.cells_per_core)} cells per core"
    return {**claim, "claim": claim["claim"] + size, "statement": claim["statement"] + size}


def _claim(name, statement, published, basis):
    return {"claim": name, "statement": statement, "paper": published, "basis": basis, "value": None,
            "verdict": "cannot_fill", "reason": ""}


def _decide(claim, agrees, value, reason):
    return _conclude(claim, resolution.AGREES if agrees else resolution.DIFFERS, value, reason)


def _conclude(claim, word, value, reason, *intervals):
    """Sets the verdict. The doubts are added to the reason of a claim that is not resolved."""
    doubts = [resolution.doubt(one) for one in intervals] if word == resolution.NOT_RESOLVED else []
    claim.update(value=value, verdict=word, reason=reason + next(filter(None, doubts), ""))
    return claim


def crossover(table):
    """Returns (the most cores with PODM ahead, the fewest cores from which on PDR.PODM makes more elements per second).
    Without such a number the first is 0 and the second None."""
    both = table["rate"].unstack("algorithm").reindex(columns=list(paper.ALGORITHMS)).dropna()
    ahead = both["pdr-podm"] > both["podm"]
    behind = max(both.index[~ahead], default=0)
    return int(behind), min((int(cores) for cores in both.index if cores > behind), default=None)


def _crossover(frame, series, basis):
    """The claim is decided if our bracket is disjoint from the paper's or lies within it, or if it contains the paper's
    and is at most one doubling wide."""
    last, first = CROSSOVER
    claim = _claim("crossover", f"PDR.PODM overtakes PODM between {last} and {first} cores", list(CROSSOVER), basis)
    both = _common_cores(series.table) if series is not None else []
    if not both or max(both) < first:
        most = f"no rows of both algorithms with {first} cores or more"
        claim["reason"] = lack_of_cores(frame, basis, first) or most
        return claim
    behind, ahead = crossover(series.table)
    if (open_on := _unresolved_orders(series, basis)):
        claim.update(value=[behind, ahead], verdict=resolution.NOT_RESOLVED,
                     reason=f"which is ahead on {', '.join(map(str, open_on))} cores is not resolved")
        return claim
    if ahead is None:
        return _decide(claim, False, [behind, None], f"PDR.PODM is not ahead on {behind} cores, the most with rows")
    reason = f"PDR.PODM is ahead from {ahead} cores on, " + (f"not on {behind}" if behind else "the fewest with rows")
    is_within = last <= behind and ahead <= first
    if ahead <= last or behind >= first:
        return _decide(claim, False, [behind, ahead], reason)
    if is_within or (behind and ahead <= 2 * behind):
        return _decide(claim, True, [behind, ahead], reason)
    claim.update(value=[behind, ahead], reason=f"{reason}: {last} and {first} cores would decide")
    return claim


def _unresolved_orders(series, basis):
    """Returns the numbers of cores beyond one on which the intervals do not show which algorithm is ahead."""
    def order(cores):
        lines = [series.table.loc[algorithm, cores] for algorithm in ("pdr-podm", "podm")]
        one, other = (resolution.of_line(line, "speedup", basis) for line in lines)
        ratio = lines[0]["speedup"] / lines[1]["speedup"]
        return resolution.verdict(ratio, one.over(other) if one else resolution.EXACT, most=1)

    return [cores for cores in _common_cores(series.table) if cores > 1 and order(cores) == resolution.NOT_RESOLVED]


def _common_cores(table):
    sets = [set(table.loc[name].index) if name in table.index else set() for name in paper.ALGORITHMS]
    return sorted(set.intersection(*sets))


def _trends(frame, series, basis):
    """The efficiency at the most cores over the efficiency at the fewest cores beyond one core."""
    for algorithm, statement in (("podm", "PODM's efficiency collapses: 106.6 % on 32 cores, 17.5 % on 256"),
                                 ("pdr-podm", "PDR.PODM keeps most: 90.7 % on 32 cores, 64.0 % on 256")):
        published = paper.table1().loc[algorithm]["efficiency"]
        claim = _claim(f"efficiency of {algorithm}", statement, float(published[256] / published[32]), basis)
        ours = _lines(series, algorithm)
        if ours is None or not {32, 256} <= set(ours.index):
            claim["reason"] = lack_of_cores(frame, basis, 256) or "no rows with 32 and with 256 cores"
        else:
            kept, interval = _quotient(ours.loc[256], ours.loc[32], "efficiency", basis)
            bounds = (claim["paper"] - RATIO_TOLERANCE, claim["paper"] + RATIO_TOLERANCE)
            _conclude(claim, resolution.verdict(kept, interval, *bounds), kept,
                      f"{100 * kept:.0f} % of the efficiency on 32 cores is left on 256, in the paper "
                      f"{100 * claim['paper']:.0f} %", interval)
        yield claim


def _turns(frame, series, basis):
    """The speed-up at each number of cores over that at the next smaller one, from TURNING on."""
    for algorithm, verb, sign in (("podm", "falls", -1), ("pdr-podm", "rises", 1)):
        claim = _claim(f"speed-up of {algorithm} beyond {TURNING} cores",
                       f"{NAMES[algorithm]}'s speed-up {verb} with each step from {TURNING} to 256 cores",
                       _steps(paper.table1().loc[algorithm]["speedup"]), basis)
        ours = _lines(series, algorithm)
        if ours is None or not {TURNING, 256} <= set(ours.index):
            claim["reason"] = lack_of_cores(frame, basis, 256) or f"no rows with {TURNING} and with 256 cores"
        else:
            inside = ours[(ours.index >= TURNING) & (ours.index <= 256)].sort_index()
            pairs = zip(inside.iloc, inside.iloc[1:].iloc)
            steps, intervals = zip(*(_quotient(after, before, "speedup", basis) for before, after in pairs))
            bounds = {"least": ABOVE_ONE} if sign > 0 else {"most": 1 / ABOVE_ONE}
            word = resolution.together([resolution.verdict(step, interval, **bounds)
                                        for step, interval in zip(steps, intervals)])
            factors = ", ".join(f"{step:.2f}" for step in steps)
            _conclude(claim, word, list(steps), f"from step to step times {factors}", *intervals)
        yield claim


def deviations(table, algorithm):
    """Returns our speed-up over the paper's, minus 1, by number of cores beyond one."""
    published = paper.corrected_table1().loc[algorithm]["speedup"]
    ours = table.loc[algorithm]["speedup"] if algorithm in table.index else published.iloc[:0]
    return (ours / published - 1).drop(index=1, errors="ignore").dropna()


def _deviations(frame, series, basis):
    """The mean absolute deviation over the numbers of cores beyond one. The largest number of cores must be present."""
    for algorithm, most in DEVIATIONS.items():
        claim = _claim(f"deviation of {algorithm}",
                       f"{NAMES[algorithm]}'s speed-ups deviate from the paper's by at most {100 * most:.0f} % in the "
                       "mean", most, basis)
        found = deviations(series.table, algorithm) if series is not None else []
        if len(found) < 2 or found.index.max() < 256:
            claim["reason"] = lack_of_cores(frame, basis, 256) or "no rows with 256 cores and with fewer"
        else:
            mean, worst = float(found.abs().mean()), int(found.abs().idxmax())
            interval = _interval_of_mean(series, algorithm, found.index, basis)
            _conclude(claim, resolution.verdict(mean, interval, most=most), mean,
                      f"{100 * mean:.1f} % in the mean of {len(found)} numbers of cores, at most "
                      f"{100 * found[worst]:+.0f} %, on {worst} cores", interval)
        yield claim


def _steps(speedup):
    inside = speedup[(speedup.index >= TURNING) & (speedup.index <= 256)].sort_index()
    return [float(after / before) for before, after in zip(inside, inside.iloc[1:])]


def _interval_of_mean(series, algorithm, counts, basis):
    """The interval of the mean absolute deviation: the means of the least and of the greatest absolute deviations that
    the intervals of the speed-ups allow."""
    if basis != "measured":
        return resolution.EXACT
    published = paper.corrected_table1().loc[algorithm]["speedup"]
    lines = _lines(series, algorithm)
    ends = [sorted(abs(lines.loc[cores, f"speedup_{end}"] / published[cores] - 1) for end in ("low", "high"))
            for cores in counts]
    holds_paper = [lines.loc[cores, "speedup_low"] <= published[cores] <= lines.loc[cores, "speedup_high"]
                   for cores in counts]
    lows = [0.0 if holds else low for holds, (low, _) in zip(holds_paper, ends)]
    return resolution.Interval(sum(lows) / len(lows), sum(high for _, high in ends) / len(ends),
                               lines.loc[list(counts), "coverage"].min())


def _quotient(above, below, column, basis):
    """Returns (the quotient of two lines' numbers, its interval)."""
    intervals = [resolution.of_line(line, column, basis) for line in (above, below)]
    exact = resolution.EXACT in intervals
    return float(above[column] / below[column]), resolution.EXACT if exact else intervals[0].over(intervals[1])


def _lines(series, algorithm):
    has_any = series is not None and algorithm in series.table.index
    return series.table.loc[algorithm] if has_any else None


def _zero_hops(hops, frame, basis):
    least = float(paper.table2().loc[0].min())
    claim = _claim("zero-hop share", "at least 98.85 % of PDR.PODM's accesses stay on their node", least, basis)
    zero = hops[(hops["basis"] == basis) & (hops["algorithm"] == "pdr-podm") & (hops["hops"] == 0)]
    beyond = zero[zero["nodes"] > 1]
    if beyond.empty:
        claim["reason"] = ("a single computing node: no hop is possible" if len(zero)
                           else table2.why_no_hops(of_basis(frame, basis)))
        return claim
    worst = float(beyond["share"].min())
    bound = 1 - SHARE_FACTOR * (1 - least)
    intervals = [resolution.of_line(line, "share", basis) for line in beyond.to_dict("records")]
    words = [resolution.verdict(share, interval, least=bound) for share, interval in zip(beyond["share"], intervals)]
    return _conclude(claim, resolution.together(words), worst,
                     f"least share {100 * worst:.2f} %, up to {int(beyond['cores'].max())} cores: "
                     f"{100 * (1 - worst):.2f} % leave their node, in the paper {100 * (1 - least):.2f} % at most",
                     *intervals)


def _zero_hop_cells(hops, frame, basis):
    """Judges Table 2 for each number of cores by the rule of its cells; all of them must agree."""
    published = paper.table2().loc[0]
    published = published[published < 1]  # on one blade no access can leave it
    claim = _claim("zero-hop share by number of cores",
                   f"on each of {len(published)} numbers of cores as many of PDR.PODM's accesses leave their node as "
                   "in the paper, within a factor of two", len(published), basis)
    ours = hops[(hops["basis"] == basis) & (hops["algorithm"] == "pdr-podm") & (hops["hops"] == 0)]
    ours = ours.set_index("cores").reindex(published.index).dropna(subset="share")
    remote, theirs = 1 - ours["share"], 1 - published[ours.index]
    intervals = [resolution.of_line(line, "share", basis) for line in ours.to_dict("records")]
    intervals = [one if one is resolution.EXACT else one.map(lambda share: 1 - share) for one in intervals]
    words = [resolution.verdict(one, interval, *near_share(paper_share))
             for one, interval, paper_share in zip(remote, intervals, theirs)]
    if len(ours) < len(published) and resolution.DIFFERS not in words:
        claim["reason"] = (f"{len(ours)} of {len(published)} numbers of cores have rows" if len(ours)
                           else table2.why_no_hops(of_basis(frame, basis)))
        return claim
    agree = words.count(resolution.AGREES)
    times = ", ".join(f"{one:.3g}" for one in remote / theirs)
    return _conclude(claim, resolution.together(words), agree, f"{agree} of {len(published)} agree; times as many as "
                     f"the paper's leave their node: {times}", *intervals)


def _latencies(frame):
    """Compares the order of Table 3's cycles, as the values belong to each machine. Only for measured rows."""
    costs = table3.costs(frame)
    own, another = costs[~costs["is_another"]], costs[costs["is_another"]]
    within = _claim("latency within a node", "each level of memory costs more than the one before it: 4, 11, 40 and "
                    "about 200 cycles", [4, 11, 40, 200], "measured")
    if len(own) < 3 or own["cycles"].isna().any():
        within["reason"] = "no row measured two caches and the node's memory"
    else:
        steps = [_quotient(high, low, "cycles", "measured") for low, high in zip(own.iloc, own.iloc[1:].iloc)]
        _conclude_steps(within, steps, ABOVE_ONE, own["cycles"].tolist(),
                        ", ".join(f"{cycles:.3g}" for cycles in own["cycles"]) + " cycles")
    beyond = _claim("latency beyond a node", "memory of another node costs more than that of the own: about 1500 "
                    "against 200 cycles", 7.5, "measured")
    if own.empty or another.empty or another["cycles"].isna().any() or own["cycles"].isna().iloc[-1]:
        beyond["reason"] = "no row measured memory levels" if own.empty else "one NUMA node"
    else:
        steps = [_quotient(line, own.iloc[-1], "cycles", "measured") for line in another.iloc]
        ratio = min(value for value, _ in steps)
        _conclude_steps(beyond, steps, 1 + RATIO_TOLERANCE, ratio, f"{ratio:.3g} times as many cycles")
    return [within, beyond]


def _conclude_steps(claim, steps, least, value, reason):
    words = [resolution.verdict(ratio, interval, least=least) for ratio, interval in steps]
    _conclude(claim, resolution.together(words), value, reason, *(interval for _, interval in steps))
