"""Finds out which result of the simulated machine depends on which constant. Each constant is switched off and doubled,
one at a time (experiments/simulated_ablation.toml), and the findings are judged again."""
from dataclasses import dataclass
from typing import Callable

import pandas

from . import load, scaling
from .table2 import zero_hop_share

EXPERIMENT = "simulated_ablation"
UNCHANGED = ("as they are", 1.0)
HOLDS, FAILS, NOT_SIMULATED = "holds", "does not hold", "not simulated"


@dataclass(frozen=True)
class Finding:
    """`holds`: a function of the rates and zero-hop shares by (algorithm, cores). It needs all entries of `needs`."""

    statement: str
    needs: tuple
    holds: Callable


PODM, PDR, HOME = "podm", "pdr-podm", "podm-home"
FINDINGS = (
    Finding("PODM ahead of PDR.PODM on 16 cores, one blade", ((PODM, 16), (PDR, 16)),
            lambda rate, hops: rate[PODM, 16] > rate[PDR, 16]),
    Finding("PODM ahead on 128", ((PODM, 128), (PDR, 128)), lambda rate, hops: rate[PODM, 128] > rate[PDR, 128]),
    Finding("PDR.PODM ahead on 256", ((PODM, 256), (PDR, 256)), lambda rate, hops: rate[PDR, 256] > rate[PODM, 256]),
    Finding("PODM slower on 256 than on 128", ((PODM, 128), (PODM, 256)),
            lambda rate, hops: rate[PODM, 256] < rate[PODM, 128]),
    Finding("PDR.PODM faster on 256 than on 128", ((PDR, 128), (PDR, 256)),
            lambda rate, hops: rate[PDR, 256] > rate[PDR, 128]),
    Finding("PODM at home ahead of both on 256", ((PODM, 256), (PDR, 256), (HOME, 256)),
            lambda rate, hops: rate[HOME, 256] > max(rate[PODM, 256], rate[PDR, 256])),
    Finding("PODM at home at 75 % efficiency or more on 256", ((PODM, 1), (HOME, 256)),
            lambda rate, hops: rate[HOME, 256] >= 0.75 * 256 * rate[PODM, 1]),
    Finding("PODM on 256 within 8 % of the paper's 44.7, the fit", ((PODM, 1), (PODM, 256)),
            lambda rate, hops: abs(rate[PODM, 256] / rate[PODM, 1] / 44.7 - 1) <= 0.08),
    Finding("more of PDR.PODM's accesses than of PODM's without a hop on 128 and 256",
            tuple((algorithm, cores) for algorithm in (PODM, PDR) for cores in (128, 256)),
            lambda rate, hops: all(hops[PDR, cores] > hops[PODM, cores] for cores in (128, 256))),
)


def ablation(frame):
    """One line per constant and factor, first the line with unchanged constants: each finding `holds`, `does not hold`
    or was `not simulated`. Only rows of the newest program count; two models never share a program."""
    rows = _rows(frame)
    if rows.empty:
        return pandas.DataFrame()
    lines = []
    for (constant, factor), group in rows.groupby(["constant", "factor"], sort=False):
        rate = {index: (some["cells"] / some["seconds"]).median()
                for index, some in group.groupby(["algorithm", "cores"])}
        hops = {index: pandas.to_numeric(some["hops"].map(zero_hop_share), errors="coerce").median()
                for index, some in group.groupby(["algorithm", "cores"]) if "hops" in some}
        lines.append({"constant": constant, "factor": factor, "n": len(group), "rate": rate,
                      **{one.statement: _verdict(one, rate, hops) for one in FINDINGS}})
    table = pandas.DataFrame(lines)
    return table.sort_values("constant", key=lambda names: names != UNCHANGED[0], kind="stable", ignore_index=True)


def _rows(frame):
    if "experiment" not in frame:
        return frame.iloc[:0]
    rows = frame[(frame["experiment"] == EXPERIMENT) & frame["doubt"].isin(["", load.ALTERED])]
    if rows.empty:
        return rows
    rows = scaling.with_keys(rows[rows["build"] == rows["build"].iloc[-1]])
    factors = rows.get("asked.cost_factor", pandas.Series(index=rows.index, dtype=object))
    parts = [one.split("=") if isinstance(one, str) else UNCHANGED for one in factors]
    return rows.assign(constant=[name for name, _ in parts], factor=[float(factor) for _, factor in parts])


def _verdict(finding, rate, hops):
    if not set(finding.needs) <= set(rate):
        return NOT_SIMULATED
    return HOLDS if finding.holds(rate, hops) else FAILS


def readable(table):
    """The unchanged constants, then one line per constant: a finding survives, or falls with the factors that are
    listed. A finding that does not hold with unchanged constants may hold with another value of a constant."""
    as_they_are = table[table["constant"] == UNCHANGED[0]]
    lines = []
    for constant, group in table.groupby("constant", sort=False):
        line = {"constant": constant.replace("_", " "), "rows": int(group["n"].sum())}
        for statement in (one.statement for one in FINDINGS):
            usual = as_they_are[statement].iloc[0] if len(as_they_are) else NOT_SIMULATED
            line[statement] = _words(group.set_index("factor")[statement], usual)
        lines.append(line)
    return pandas.DataFrame(lines)


def _words(verdicts, usual):
    """`usual`: the verdict with unchanged constants."""
    simulated = verdicts[verdicts != NOT_SIMULATED]
    if simulated.empty or usual == NOT_SIMULATED:
        return NOT_SIMULATED
    if set(verdicts.index) == {UNCHANGED[1]}:
        return usual
    changed = ", ".join(_factor(factor) for factor in simulated.index[simulated != usual])
    if not changed:
        return "survives" if usual == HOLDS else usual
    return f"{'falls' if usual == HOLDS else HOLDS}: {changed}"


def _factor(factor):
    return {0.0: "off", 2.0: "doubled", 0.5: "halved"}.get(factor, f"times {factor:g}")
