"""All tables, figures and verdicts of one set of records, for the command line and for the page."""
from dataclasses import dataclass, field

import pandas

from . import (ablation, cache, corpus, deviation, dihedral, distributed, distributed_figure, distributed_model,
               distributed_strong, experiment_verdicts, fig1, fig2b, fig4a, fig4b, guarantees, lost, machine,
               machine_state, paper_claims, pareto, peers, scaling, simulated, simulated_sizes, solvers, table1, table2,
               table3, validation, verdicts)


# Tables with times that this machine measured. They also state the machine's condition.
MEASURED_TABLES = ("table1", "table3", "peers", "validation", "distributed")


@dataclass(frozen=True)
class Outcome:
    """`tables`: by name, as data and readable. `figures`: by name. `missing`: the reason by name for what cannot be
    made. `series`: of weak scaling. `experiments`: verdicts of podm-bench, or None. `paper`: the paper's claims with
    these verdicts, from paper_claims.rows. `remarks`: on the state of the machine while rows were measured."""

    tables: dict
    figures: dict
    verdicts: dict
    missing: dict = field(default_factory=dict)
    series: list = field(default_factory=list)
    experiments: dict = None
    paper: list = field(default_factory=list)
    remarks: list = field(default_factory=list)


def make(frame, report=None, schedule=None, mesh=None, experiments=None):
    """`report`: a report of podm-verify, or None. `schedule` and `mesh`: for figure 2 (b), or None."""
    series = scaling.weak_series(frame)
    hops = table2.table2(frame)
    ranks = distributed.distributed(frame)
    nodes = distributed_model.extrapolated(ranks)
    drawn, missing = _figures(frame, series, (ranks, nodes), report, schedule, mesh)
    tables, judged = _tables(frame, series, hops, ranks, nodes), []
    try:
        judged = paper_claims.rows(experiments, frame) if experiments else []
    except paper_claims.PaperClaimsError as error:
        missing[paper_claims.NAME] = str(error)
    if judged:
        tables[paper_claims.NAME] = (paper_claims.table(judged),) * 2
    return Outcome(tables, drawn, verdicts.verdicts(frame, series, hops), missing, series, experiments, judged,
                   machine_state.remarks(frame))


def _tables(frame, series, hops, ranks, nodes):
    """Returns the paper's tables always, and the other tables if rows fill them."""
    always = {"table1": (table1.table1(series), table1), "table2": (hops, table2),
              "table3": (table3.table3(frame), table3)}
    others = {"simulated_sizes": (simulated_sizes.speedups(series), simulated_sizes),
              "ablation": (ablation.ablation(frame), ablation),
              "simulated": (simulated.simulated(frame), simulated), "machine": (machine.machine(frame), machine),
              "deviation": (deviation.deviation(series), deviation), "lost": (lost.lost(frame, series), lost),
              "validation": (validation.validation(frame), validation),
              "peers": (peers.peers(frame), peers), "solvers": (solvers.solvers(frame), solvers),
              "cache": (cache.cache(frame), cache), "corpus": (corpus.corpus(frame), corpus),
              "pareto": (pareto.fronts(pareto.pareto(frame)), pareto),
              "distributed": (ranks, distributed), "distributed_extrapolated": (nodes, distributed_model),
              "distributed_strong": (distributed_strong.strong(frame), distributed_strong),
              "guarantees": (guarantees.ours(frame), guarantees),
              "guarantees_of_others": (guarantees.of_others(frame), guarantees)}
    made = {**always, **{name: entry for name, entry in others.items() if len(entry[0])}}
    tables = {name: (data, module.readable(data)) for name, (data, module) in made.items()}
    if "deviation" in tables:
        for name, table in (("deviation_means", deviation.means(tables["deviation"][0])),
                            ("efficiency_and_hops", deviation.efficiency_and_hops(series, hops))):
            tables[name] = (table, table)
    shares = simulated_sizes.fitted_shares(frame, series)
    if len(shares):
        tables["fitted_shares"] = (shares, simulated_sizes.readable_shares(shares))
    return tables


def _figures(frame, series, distributed_tables, report, schedule, mesh):
    drawn = {
        "fig1": fig1.fig1(report) if report else fig1.fig1_extremes(frame),
        "fig2b": fig2b.fig2b(schedule, mesh) if schedule and mesh else None,
        "fig4a": fig4a.fig4a(series),
        "fig4b": fig4b.fig4b(series),
        "deviation": deviation.figure(series),
        "lost": lost.figure(frame, series),
        "distributed": distributed_figure.figure(*distributed_tables),
        "dihedral": dihedral.figure(frame),
        "solvers": solvers.figure(frame),
        "corpus": corpus.figure(frame),
        "pareto": pareto.figure(frame),
    }
    why = {"fig1": "no report of podm-verify and no verified row with its quality",
           "fig2b": "no two leaves of different nodes were active at one time" if schedule and mesh
           else "needs --schedule and --mesh of a run of pdr or pdr-podm",
           "deviation": "no verified simulated rows of weak scaling on more than one core",
           "lost": "no simulated rows of weak scaling record the losses of their workers (virtual.worker_s)",
           "distributed": "no verified rows on more than one rank (distributed_weak.toml)",
           "dihedral": "no verified rows without and with a stage against slivers (solvers.toml)",
           "solvers": "no rows of meshes that were given to a solver (solvers.toml)",
           "corpus": "no rows of a corpus of images (make corpus)",
           "pareto": "no two meshers or settings meshed one image on one machine"}
    missing = {name: why[name] for name, figure in drawn.items() if figure is None}
    return {name: figure for name, figure in drawn.items() if figure is not None}, missing


def readable_verdicts(found):
    """Returns the claims and the cells, each as one readable table."""
    claim_columns = ["claim", "basis", "verdict", "value", "paper", "reason", "statement"]
    cell_columns = ["table", "cores", "algorithm", "column", "basis", "verdict", "value", "paper", "deviation",
                    "reason"]
    claims = [{**one, "value": _numbers(one["value"]), "paper": _numbers(one["paper"])} for one in found["claims"]]
    return (pandas.DataFrame(claims, columns=claim_columns, dtype=object),
            pandas.DataFrame(found["cells"], columns=cell_columns, dtype=object))


def readable_experiments(found):
    return experiment_verdicts.table(found)


def _numbers(value):
    """Formats a list as readable text."""
    if not isinstance(value, list):
        return value
    return ", ".join("none" if one is None else f"{one:.3g}" for one in value)
