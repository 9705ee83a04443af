"""Simulated speed-ups, efficiencies and zero-hop shares beside the paper's. The constants of the machine were fitted to
PODM's column; PDR.PODM's column and Table 2 were not fitted."""
import itertools

import pandas

from . import paper, scaling, style
from .claims import DEVIATIONS, deviations
from .table1 import with_bounds

ROLES = {"podm": "fitted", "pdr-podm": "not fitted"}


def deviation(series):
    """One line per algorithm, number of cores beyond one, and simulated size: speed-up and efficiency beside the
    paper's, and the `deviation` of the speed-up, ours over the paper's minus 1."""
    published = paper.corrected_table1()
    lines = []
    for algorithm in paper.ALGORITHMS:
        for one in scaling.simulated_sizes(series):
            for cores, deviates in deviations(one.table, algorithm).items():
                ours, theirs = one.table.loc[algorithm, cores], published.loc[algorithm, cores]
                lines.append({"algorithm": algorithm, "role": ROLES[algorithm], "cores": cores,
                              "basis": one.key["basis"], "kind": one.kind(), "cells_per_core": one.cells_per_core,
                              "published_speedup": theirs["speedup"], "published_efficiency": theirs["efficiency"],
                              **{name: ours[name] for name in ("speedup", "speedup_low", "speedup_high", "efficiency")},
                              "deviation": deviates})
    return pandas.DataFrame(lines)


def readable(table):
    """One row per algorithm and number of cores, the fitted algorithm first; one column per size."""
    lines = []
    for (algorithm, cores), group in table.groupby(["algorithm", "cores"], sort=False):
        first = group.iloc[0]
        line = {"algorithm": algorithm, "speed-up was": first["role"], "cores": cores,
                "published": f"{first['published_speedup']:.1f} ({100 * first['published_efficiency']:.0f} %)"}
        for _, one in group.iterrows():
            bounds = with_bounds(one["speedup"], one["speedup_low"], one["speedup_high"], 1)
            line[one["kind"]] = f"{bounds} ({100 * one['efficiency']:.0f} %): {100 * one['deviation']:+.0f} %"
        lines.append(line)
    return pandas.DataFrame(lines).fillna("")


def means(table):
    """One line per algorithm and size: the mean absolute deviation over its `n` numbers of cores, beside its bound."""
    lines = [{"algorithm": algorithm, "speed-up was": group["role"].iloc[0], "basis": kind,
              "mean absolute deviation %": f"{100 * group['deviation'].abs().mean():.1f}",
              "numbers of cores": len(group), "asked %": f"below {100 * DEVIATIONS[algorithm]:.0f}"}
             for (algorithm, kind), group in table.groupby(["algorithm", "kind"], sort=False)]
    return pandas.DataFrame(lines)


def figure(series):
    """Draws the deviations of speed-ups against cores, one panel per algorithm; None without simulated speed-ups."""
    shown = scaling.simulated_sizes(series)
    if deviation(series).empty:
        return None
    drawn, panels = style.new_figure(columns=2, width=12.0, height=3.8)
    cores = [count for count in scaling.core_counts([one.table for one in shown]) if count > 1]
    for axes, algorithm in zip(panels, paper.ALGORITHMS):
        for place, one in enumerate(shown):
            found = 100 * deviations(one.table, algorithm)
            axes.plot(found.index, found, color=style.COLOURS[algorithm], alpha=(place + 1) / len(shown),
                      label=one.kind(), **{"marker": style.MARKERS[algorithm], **style.LINES[one.key["basis"]]})
        most = 100 * DEVIATIONS[algorithm]
        axes.axhspan(-most, most, color=style.PUBLISHED_GREY, alpha=0.15, label="bound on the mean")
        axes.axhline(0, color=style.INK, linewidth=0.8)
        axes.set(xlabel="cores", title=f"{style.NAMES[algorithm]}, {ROLES[algorithm]}",
                 ylabel="speed-up over the paper's, minus 1, %")
        axes.set_xticks(cores, [str(count) for count in cores], rotation=45)
    style.legend(panels[-1], **style.BESIDE)
    style.finish(drawn, "Residuals of the fit, and deviations of values that were not fitted. "
                        f"{style.caption_of(shown, has_paper=False)}")
    return drawn


def efficiency_and_hops(series, hops):
    """One line per number of cores in the paper's tables: each algorithm's efficiency, and the zero-hop share of all
    algorithms except PODM, as in Table 2; published and simulated, as text."""
    published = paper.corrected_table1()["efficiency"]
    zero = hops[hops["hops"] == 0].set_index(["algorithm", "basis", "cores"])
    lines = []
    for cores in sorted({*published.index.get_level_values("cores"), *paper.table2().columns}):
        line = {"cores": cores}
        for algorithm, name in style.NAMES.items():
            if algorithm in paper.ALGORITHMS:
                line[f"{name}, efficiency, published"] = _percent(published.get((algorithm, cores)))
            one = scaling.first_of(series, "simulated")
            if one and (algorithm, cores) in one.table.index:
                row = one.table.loc[algorithm, cores]
                line[f"{name}, {one.kind()}"] = _percent(*row[["efficiency", "efficiency_low", "efficiency_high"]])
        for algorithm, basis in itertools.product(list(style.NAMES)[1:], ("published", "simulated")):
            if (algorithm, basis, cores) in zero.index:
                row = zero.loc[algorithm, basis, cores]
                line[f"{style.NAMES[algorithm]}, 0 hops, {row['kind']}"] = _percent(row["share"], digits=2)
        lines.append(line)
    return pandas.DataFrame(lines).fillna("")


def _percent(value, low=float("nan"), high=float("nan"), digits=1):
    return "" if value is None else with_bounds(100 * value, 100 * low, 100 * high, digits)
