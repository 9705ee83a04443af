"""A verdict for each finding of the paper: statements on shapes, each with the mirror that would refute it."""
from . import paper, scaling, table2, table3
from .cells import RATIO_TOLERANCE, SHARE_FACTOR, shares_agree
from .reasons import lack_of_cores, of_basis
from .style import NAMES

CROSSOVER = (128, 160)  # the paper's: PODM ahead on the first, PDR.PODM on the second
TURNING = 128  # cores from which on PODM's speed-up falls
# Mean absolute deviation of speed-ups from the paper's; in simulations PODM's column is fitted, the other is not.
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
    """Each size has a verdict of its own."""
    size = f", {scaling.short(series.cells_per_core)} cells a core"
    return {**claim, "claim": claim["claim"] + size, "statement": claim["statement"] + size}


def _claim(name, statement, published, basis):
    return {"claim": name, "statement": statement, "paper": published, "basis": basis, "value": None,
            "verdict": "cannot_fill", "reason": ""}


def _decide(claim, agrees, value, reason):
    claim.update(value=value, verdict="agrees" if agrees else "differs", reason=reason)
    return claim


def crossover(table):
    """(most cores with PODM ahead, fewest from which on PDR.PODM makes more elements per second): 0 or None where there
    is no such number."""
    both = table["rate"].unstack("algorithm").reindex(columns=list(paper.ALGORITHMS)).dropna()
    ahead = both["pdr-podm"] > both["podm"]
    behind = max(both.index[~ahead], default=0)
    return int(behind), min((int(cores) for cores in both.index if cores > behind), default=None)


def _crossover(frame, series, basis):
    """Decided where the bracket lies apart from the paper's, within it, or holds it without being wider than one
    doubling."""
    last, first = CROSSOVER
    claim = _claim("crossover", f"PDR.PODM overtakes PODM between {last} and {first} cores", list(CROSSOVER), basis)
    both = _common_cores(series.table) if series is not None else []
    if not both or max(both) < first:
        most = f"no rows of both algorithms with {first} cores or more"
        claim["reason"] = lack_of_cores(frame, basis, first) or most
        return claim
    behind, ahead = crossover(series.table)
    if ahead is None:
        return _decide(claim, False, [behind, None], f"PDR.PODM is not ahead on {behind} cores, the most there are")
    reason = f"PDR.PODM is ahead from {ahead} cores on, " + (f"not on {behind}" if behind else "the fewest there are")
    is_within = last <= behind and ahead <= first
    if ahead <= last or behind >= first:
        return _decide(claim, False, [behind, ahead], reason)
    if is_within or (behind and ahead <= 2 * behind):
        return _decide(claim, True, [behind, ahead], reason)
    claim.update(value=[behind, ahead], reason=f"{reason}: {last} and {first} cores would decide")
    return claim


def _common_cores(table):
    sets = [set(table.loc[name].index) if name in table.index else set() for name in paper.ALGORITHMS]
    return sorted(set.intersection(*sets))


def _trends(frame, series, basis):
    """Efficiency at the most cores over that at the fewest beyond one core: what is kept of it."""
    for algorithm, statement in (("podm", "PODM's efficiency collapses: 106.6 % on 32 cores, 17.5 % on 256"),
                                 ("pdr-podm", "PDR.PODM keeps most: 90.7 % on 32 cores, 64.0 % on 256")):
        published = paper.table1().loc[algorithm]["efficiency"]
        claim = _claim(f"efficiency of {algorithm}", statement, float(published[256] / published[32]), basis)
        ours = _column(series, algorithm, "efficiency")
        if ours is None or not {32, 256} <= set(ours.index):
            claim["reason"] = lack_of_cores(frame, basis, 256) or "no rows with 32 and with 256 cores"
        else:
            kept = float(ours[256] / ours[32])
            _decide(claim, abs(kept - claim["paper"]) <= RATIO_TOLERANCE, kept,
                    f"{100 * kept:.0f} % of the efficiency on 32 cores is left on 256, in the paper "
                    f"{100 * claim['paper']:.0f} %")
        yield claim


def _turns(frame, series, basis):
    """The speed-up at each number of cores over that at the next smaller one, from TURNING on."""
    for algorithm, verb, sign in (("podm", "falls", -1), ("pdr-podm", "rises", 1)):
        claim = _claim(f"speed-up of {algorithm} beyond {TURNING} cores",
                       f"{NAMES[algorithm]}'s speed-up {verb} with each step from {TURNING} to 256 cores",
                       _steps(paper.table1().loc[algorithm]["speedup"]), basis)
        ours = _column(series, algorithm, "speedup")
        if ours is None or not {TURNING, 256} <= set(ours.index):
            claim["reason"] = lack_of_cores(frame, basis, 256) or f"no rows with {TURNING} and with 256 cores"
        else:
            steps = _steps(ours)
            told = ", ".join(f"{step:.2f}" for step in steps)
            _decide(claim, all((step - 1) * sign > 0 for step in steps), steps, f"from step to step times {told}")
        yield claim


def deviations(table, algorithm):
    """By number of cores beyond one: the speed-up over the paper's, less 1."""
    published = paper.corrected_table1().loc[algorithm]["speedup"]
    ours = table.loc[algorithm]["speedup"] if algorithm in table.index else published.iloc[:0]
    return (ours / published - 1).drop(index=1, errors="ignore").dropna()


def _deviations(frame, series, basis):
    """The mean of their sizes over the numbers of cores beyond one, of which the most has to be there."""
    for algorithm, most in DEVIATIONS.items():
        claim = _claim(f"deviation of {algorithm}",
                       f"{NAMES[algorithm]}'s speed-ups deviate from the paper's by at most {100 * most:.0f} % in the "
                       "mean", most, basis)
        found = deviations(series.table, algorithm) if series is not None else []
        if len(found) < 2 or found.index.max() < 256:
            claim["reason"] = lack_of_cores(frame, basis, 256) or "no rows with 256 cores and with fewer"
        else:
            mean, worst = float(found.abs().mean()), int(found.abs().idxmax())
            _decide(claim, mean <= most, mean, f"{100 * mean:.1f} % in the mean of {len(found)} numbers of cores, at "
                    f"most {100 * found[worst]:+.0f} %, on {worst} cores")
        yield claim


def _steps(speedup):
    inside = speedup[(speedup.index >= TURNING) & (speedup.index <= 256)].sort_index()
    return [float(after / before) for before, after in zip(inside, inside.iloc[1:])]


def _column(series, algorithm, column):
    has_any = series is not None and algorithm in series.table.index
    return series.table.loc[algorithm][column] if has_any else None


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
    return _decide(claim, 1 - worst <= SHARE_FACTOR * (1 - least), worst,
                   f"least share {100 * worst:.2f} %, up to {int(beyond['cores'].max())} cores: "
                   f"{100 * (1 - worst):.2f} % leave their node, in the paper {100 * (1 - least):.2f} % at most")


def _zero_hop_cells(hops, frame, basis):
    """Table 2 number of cores by number of cores, by the rule of its cells; all of them have to agree."""
    published = paper.table2().loc[0]
    published = published[published < 1]  # on one blade no access can leave it
    claim = _claim("zero-hop share by number of cores",
                   f"on each of {len(published)} numbers of cores as many of PDR.PODM's accesses leave their node as "
                   "in the paper, within a factor of two", len(published), basis)
    ours = hops[(hops["basis"] == basis) & (hops["algorithm"] == "pdr-podm") & (hops["hops"] == 0)]
    ours = ours.set_index("cores")["share"].reindex(published.index).dropna()
    if len(ours) < len(published):
        claim["reason"] = (f"{len(ours)} of {len(published)} numbers of cores have rows" if len(ours)
                           else table2.why_no_hops(of_basis(frame, basis)))
        return claim
    agree = sum(shares_agree(1 - share, 1 - published[cores]) for cores, share in ours.items())
    times = ", ".join(f"{(1 - share) / (1 - published[cores]):.3g}" for cores, share in ours.items())
    return _decide(claim, agree == len(published), agree, f"{agree} of {len(published)} agree; times as many as the "
                   f"paper's leave their node: {times}")


def _latencies(frame):
    """The order of Table 3's cycles is compared, which are a machine's own. Measured, or not at all."""
    costs = table3.costs(frame)
    own = costs[~costs["is_another"]]["cycles"].tolist()
    another = costs[costs["is_another"]]["cycles"].tolist()
    within = _claim("latency within a node", "each level of memory costs more than the one before it: 4, 11, 40 and "
                    "some 200 cycles", [4, 11, 40, 200], "measured")
    if len(own) < 3 or any(cycles != cycles for cycles in own):
        within["reason"] = "no row measured two caches and the node's memory"
    else:
        _decide(within, all(low < high for low, high in zip(own, own[1:])), own,
                ", ".join(f"{cycles:.3g}" for cycles in own) + " cycles")
    beyond = _claim("latency beyond a node", "memory of another node costs more than that of the own: some 1500 "
                    "against 200 cycles", 7.5, "measured")
    if not own or not another or any(cycles != cycles for cycles in (own[-1], *another)):
        beyond["reason"] = "one NUMA node" if own else "no row measured memory levels"
    else:
        ratio = min(another) / own[-1]
        _decide(beyond, ratio >= 1 + RATIO_TOLERANCE, ratio, f"{ratio:.3g} times as many cycles")
    return [within, beyond]
