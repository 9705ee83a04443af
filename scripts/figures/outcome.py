"""All tables, figures and verdicts of one set of records, for the command line and for the page."""
from dataclasses import dataclass, field

import pandas

from . import cache, fig1, fig2b, fig4a, fig4b, scaling, table1, table2, table3, verdicts


@dataclass(frozen=True)
class Outcome:
    """`tables`: by name, as data and readable. `figures`: by name. `missing`: reason by name of what cannot be made."""

    tables: dict
    figures: dict
    verdicts: dict
    missing: dict = field(default_factory=dict)


def make(frame, report=None, schedule=None, mesh=None):
    """`report`: of podm-verify, or None; `schedule` and `mesh`: for figure 2 (b), or None."""
    series = scaling.weak_series(frame)
    weak, hops, levels = table1.table1(series), table2.table2(frame), table3.table3(frame)
    tables = {"table1": (weak, table1.readable(weak)), "table2": (hops, table2.readable(hops)),
              "table3": (levels, table3.readable(levels))}
    if len(caches := cache.cache(frame)):
        tables["cache"] = (caches, cache.readable(caches))
    drawn, missing = _figures(frame, series, report, schedule, mesh)
    return Outcome(tables, drawn, verdicts.verdicts(frame, series, hops), missing)


def _figures(frame, series, report, schedule, mesh):
    drawn = {
        "fig1": fig1.fig1(report) if report else fig1.fig1_extremes(frame),
        "fig2b": fig2b.fig2b(schedule, mesh) if schedule and mesh else None,
        "fig4a": fig4a.fig4a(series),
        "fig4b": fig4b.fig4b(series),
    }
    why = {"fig1": "no report of podm-verify and no verified row with its quality",
           "fig2b": "no two leaves of different nodes were active at one time" if schedule and mesh
           else "needs --schedule and --mesh of a run of pdr or pdr-podm"}
    missing = {name: why[name] for name, figure in drawn.items() if figure is None}
    return {name: figure for name, figure in drawn.items() if figure is not None}, missing


def readable_verdicts(found):
    """Claims, then cells, each as one table for people."""
    claim_columns = ["claim", "basis", "verdict", "value", "paper", "reason", "statement"]
    cell_columns = ["table", "cores", "algorithm", "column", "basis", "verdict", "value", "paper", "deviation", "reason"]
    return (pandas.DataFrame(found["claims"], columns=claim_columns, dtype=object),
            pandas.DataFrame(found["cells"], columns=cell_columns, dtype=object))
