"""Makes the page's HTML from an Outcome: four answers, then the details. Everything is inlined."""
from html import escape

from figures import experiment_verdicts, peers, simulated_sizes
from figures.outcome import MEASURED_TABLES, readable_experiments, readable_verdicts
from figures.write import svg_of

from .corpus_section import corpus_html
from .first_screen import first_screen
from .html import box, document, fold, remarks_html, responsive, section, table_html, text_of
from .limits import limits
from .viewer import script, viewer_html

DOI = "https://doi.org/10.1016/j.proeng.2015.10.119"
SECTIONS = {"claims": "Claims", "guarantees": "Guarantees", "tables": "Tables", "figures": "Figures",
            "corpus": "Corpus", "pareto": "Pareto fronts",
            "simulated": "Simulated machine", "mesh": "Mesh", "environment": "Environment"}
FIGURE_TITLES = {"fig1": "Figure 1: quality of the cells",
                 "fig2b": "Figure 2 (b): two active leaves and their rings",
                 "fig4a": "Figure 4 (a): speed-up and efficiency",
                 "fig4b": "Figure 4 (b): time and elements per second",
                 "deviation": "Simulated speed-ups beside the paper's",
                 "lost": "Where the time of simulated cores goes",
                 "distributed": "Weak scaling on ranks that share no memory, and the parts of their time",
                "dihedral": "Dihedral angles before and after the stages against slivers",
                "solvers": "What meshes cost a solver: iterations of conjugate gradients",
                "corpus": "Seconds over voxels, by setting",
                "pareto": "Seconds against cells, and time per cell against the worst dihedral angle"}
TABLE_TITLES = {"table1": "Table 1: weak scaling", "table2": "Table 2: accesses by hops",
                "table3": "Table 3: memory levels", "peers": "Beside other meshers",
                "solvers": "Slivers and solvers: iterations of conjugate gradients",
                "simulated": "Simulated: every trial of virtual workers", "cache": "Cache behaviour",
                "distributed": "Ranks that share no memory",
                "distributed_extrapolated": "Ranks of nodes of 20 million cells, extrapolated",
                "distributed_strong": "Ranks that make the same number of cells in all"}
FOLDED_TABLES = ("simulated", "cache")
NOTES = {
    "table1": "Refining: octree, initial mesh, refinement and closing alone; its efficiency is the median of ratios "
              "within rounds.",
    "table2": "All kinds: with writes of the mesh and reads of the image and its transform, which the other columns "
              "leave out.",
    "simulated": "Seconds, losses and hops are of virtual workers. The wall time is that of the simulation, not "
                 "their own.",
    "solvers": "P1 elements, 0 on the outer boundary, until the residual is 1e-8 of the first. Eigenvalues are the "
               "largest of the matrix over its diagonal. The other meshers' sizes have the nearest number of cells.",
    "peers": "Whole: from the image in memory to the mesh in memory, including the surface that TetGen and "
             f"HXT are given. {peers.LEFT_OUT} From the surface: the volume part of those two, beside that of PODM "
             f"(podm_volume), without the cells that come with the surface. {peers.COVERAGE}",
}
INTERVALS = ("In brackets: an interval of order statistics, which holds the median with 75 % of three rounds, 93.75 % "
             "of five and 95 % or more from six rounds on.")
# The tables by their order in the section: dependence on cells per core, on the fit and on single constants, then
# others.
MACHINE_TABLES = {"simulated_sizes": "Speed-ups by cells per core, fitted and not fitted",
                  "fitted_shares": "What the fitted constants decide: shares of worker time on several blades",
                  "ablation": "Findings with each constant switched off and doubled",
                  "machine": "Machines described, and their constants",
                  "validation": "Simulated beside measured, the same meshes",
                  "deviation_means": "Speed-ups: mean absolute deviation from the paper's",
                  "deviation": "Speed-ups (efficiencies) and their deviation from the paper's",
                  "efficiency_and_hops": "Efficiencies and zero-hop shares, %",
                  "lost": "Worker microseconds per cell, by cause"}
MACHINE_FIGURES = ("deviation", "lost")
OWN_SECTIONS = (*MACHINE_FIGURES, "corpus", "pareto")  # their figures are not among the others


def page(records, outcome, mesh=None, mesh_fault="No mesh was given."):
    """Returns the page. `mesh`: from viewer.pack; without it `mesh_fault` gives the reason."""
    parts = {"claims": _claims(outcome), "guarantees": _guarantees(outcome), "tables": _tables(outcome),
             "figures": _figures(outcome, [name for name in FIGURE_TITLES if name not in OWN_SECTIONS]),
             "corpus": corpus_html(outcome, _figures(outcome, ["corpus"])), "pareto": _pareto(outcome),
             "simulated": _machine(outcome), "mesh": viewer_html(mesh, mesh_fault),
             "environment": _environment(records)}
    body = "\n".join(section(name, title, parts[name]) for name, title in SECTIONS.items())
    links = " ".join(f'<a href="#{name}">{title}</a>' for name, title in SECTIONS.items())
    header = f"""<h1>Parallel Delaunay image-to-mesh: results</h1>
<p class="faint">{_machines(records.frame)} Beside the values of <a href="{DOI}">Feng, Tsolakis, Chernikov and
Chrisochoides, IMR24, 2015</a>. Published, measured and simulated values are never mixed.</p>"""
    main = f"""{first_screen(records.frame, outcome)}
<nav aria-label="Sections">{links}</nav>
{body}"""
    return document("PODMark: results", header, main, script(mesh))


def _machines(frame):
    if frame.empty:
        return "No trials."
    fit = int(frame["headline"].sum())
    machines = " and ".join(escape(name) for name in frame["machine"].unique())
    return f"{len(frame)} trials on {machines}, {fit} of them verified and usable for numbers."


def _claims(outcome):
    claims, cells = readable_verdicts(outcome.verdicts)
    return ("<p>The findings of the paper, judged by ratios and trends of our records: machines differ, so seconds are "
            f"not compared.</p>\n{_split(claims, 'Claims of the paper', 'cannot_fill')}\n"
            f"<h3>Claims of our experiments</h3>\n{_experiments(outcome)}\n"
            f"<h3>Cells of Tables 1 and 2</h3>\n{_split(cells, 'Cells of Tables 1 and 2', 'cannot_fill', False)}")


def _experiments(outcome):
    if outcome.experiments is None:
        return f'<p class="faint">{escape(experiment_verdicts.HOW)}</p>'
    return _split(readable_experiments(outcome.experiments), "Claims of our experiments", "cannot_be_decided")


def _split(table, title, undecided, is_open=True):
    """Shows decided claims, then a fold with undecided and withdrawn claims."""
    is_decided = ~table["verdict"].isin([undecided, experiment_verdicts.WITHDRAWN])
    made = []
    for part, words, shown in ((table[is_decided], "decided", is_open),
                               (table[~is_decided], "not decided here", False)):
        if len(part):
            made.append(fold(f"{len(part)} {words}", table_html(part, f"{title}, {words}"), shown))
    return "\n".join(made)


def _guarantees(outcome):
    """Shows the number of meshes for which podm-verify decided each claim."""
    made = ["<p>Claims about meshes, decided exactly by <code>podm-verify</code> outside the measured time: numbers of "
            "meshes.</p>"]
    for name, title in (("guarantees", "Our meshes"), ("guarantees_of_others", "Meshes of other meshers")):
        if name in outcome.tables:
            made.append(f"<h3>{title}</h3>\n{table_html(outcome.tables[name][1], title)}")
    if "guarantees_of_others" in outcome.tables:
        made.append('<p class="faint">Other meshers answer for the claims that they promise; ours for all.</p>')
    return "\n".join(made) if len(made) > 1 else "<p>No mesh was verified.</p>"


def _tables(outcome):
    made = []
    for name, title in TABLE_TITLES.items():
        if name not in outcome.tables:
            continue
        data, shown = outcome.tables[name]
        classes = [basis.split()[0].strip(",") for basis in shown["basis"]] if "basis" in shown else None
        series = "; ".join(data["series"].dropna().unique()) + "." if "series" in data else ""
        brackets = INTERVALS if name in ("table1", "peers") else ""
        note = " ".join(part for part in (series, brackets, NOTES.get(name, "")) if part)
        remarks = remarks_html(outcome.remarks) if name in MEASURED_TABLES else ""
        faint = f'\n<p class="faint">{escape(note)}</p>' if note else ""
        content = remarks + table_html(shown, title, classes) + faint
        made.append(fold(title, content, name not in FOLDED_TABLES))
    return "\n".join(made)


def _figures(outcome, names):
    made = []
    for name in names:
        title = FIGURE_TITLES[name]
        if name in outcome.missing:
            made.append(f'<p class="faint">{title}: not drawn, {escape(outcome.missing[name])}.</p>')
            continue
        figure = outcome.figures[name]
        picture = box(title, responsive(svg_of(figure, name), title))
        made.append(f"<figure><h3>{title}</h3>{picture}<figcaption>{escape(figure.get_label())}</figcaption></figure>")
    return "\n".join(made)


def _machine(outcome):
    """Shows the limits of the model before any number."""
    notes = {"simulated_sizes": f'\n<p class="faint">{escape(simulated_sizes.NOTE)}</p>'}
    tables = [fold(title, table_html(outcome.tables[name][1], title) + notes.get(name, ""), name != "lost")
              for name, title in MACHINE_TABLES.items() if name in outcome.tables]
    return "\n".join([limits(), *tables, _figures(outcome, MACHINE_FIGURES)])


def _pareto(outcome):
    figure = _figures(outcome, ["pareto"])
    if "pareto" not in outcome.tables:
        return figure
    title = "Meshes on a front"
    return f"{figure}\n{fold(title, table_html(outcome.tables['pareto'][1], title), False)}"


def _environment(records):
    frame = records.frame
    names = [name for name in frame.columns if name.startswith("environment.")]
    facts = {name.removeprefix("environment."): _distinct(frame[name]) for name in names}
    lines = "".join(f"<dt>{escape(name)}</dt><dd>{escape(value)}</dd>" for name, value in facts.items() if value)
    skipped = "".join(f"<li>{escape(problem)}</li>" for problem in records.problems)
    doubts = frame.loc[~frame["headline"], "doubt"].value_counts() if len(frame) else {}
    unverified = "".join(f"<li>{count} × {escape(doubt)}</li>" for doubt, count in doubts.items())
    return ((f"<h3>Rows that give no number</h3><ul>{unverified}</ul>" if unverified else "")
            + (f"<h3>Skipped</h3><ul>{skipped}</ul>" if skipped else "")
            + fold("The machine and what ran on it", f"<dl>{lines}</dl>"))


def _distinct(column):
    """Returns the distinct values of the rows; if there are many, their number and the first value."""
    values = list(dict.fromkeys(str(value) for value in column if text_of(value)))
    return ", ".join(values) if len(values) <= 2 else f"{values[0]} ({len(values)} values)"
