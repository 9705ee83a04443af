"""Tables that scripts/update_docs generates: `<!-- table NAME ARGUMENTS -->`. Each function takes the sources and the
arguments and returns lines of Markdown. To add a table, add a function and a line in TABLES."""
import pandas

from figures import distributed, distributed_model, experiment_verdicts
from figures import paper_claims as papers
from figures import peers as other_meshers
from figures import scaling, shapes
from figures import solvers as solving
from figures.load import RecordError
from figures.simulated_sizes import speedups
from figures.write import markdown

from .errors import DocsError
from .expression import FACT, Expression
from .provenance import Provenance

PEERS_OF_README = ("podm", "cgal", "cgal6", "tetgen", "gmsh")
PHASES_OF_SLIVERS = ("perturb", "optimize")
# The constants that mesher/runtime/cost_factor.cpp multiplies by a factor.
SHARING = {"none": (1, "none"), "line_transfer": (100, "a line in {:g} ns"), "page_fault": (1, "a page in {:g} us")}
ALGORITHMS_OF_SHARING = {"PODM": "podm", "PDR.PODM": "pdr-podm", "PODM at home": "podm-home"}


def _lines(table):
    return markdown(table).splitlines()


def solvers(sources, folder):
    """Iterations by image and variant, without the angles of the meshes, for the README."""
    shown = solving.readable(solving.solvers(sources.frame((folder,))))
    return _lines(shown.drop(columns=["dihedral angles", *(one for one in shown if "eigenvalue" in one)]))


def solvers_in_full(sources, folder):
    """Iterations by image and variant, with all measures of the meshes."""
    return _lines(solving.readable(solving.solvers(sources.frame((folder,)))))


def slivers(sources, file):
    """Seconds of both stages against slivers by image and trial, on one and two threads: medians over repeats."""
    rows = sources.frame((file,))
    rows = rows[rows["trial"].str.contains("-both,") & (rows["status"] == "ok")]
    lines = []
    for image, group in rows.groupby("image"):
        alone, both = (group[group["threads.used"] == count] for count in (1, 2))
        seconds = [sum(some[f"phases_s.{phase}"] for phase in PHASES_OF_SLIVERS).median() for some in (alone, both)]
        cells = alone["cells"].median()
        lines.append({"image": image, "rows": len(group), "M cells": f"{cells / 1e6:.2f}",
                      **{f"{phase}, one thread, s": f"{alone[f'phases_s.{phase}'].median():.2f}"
                         for phase in PHASES_OF_SLIVERS},
                      "M cells/s, one thread": f"{cells / seconds[0] / 1e6:.2f}",
                      "gain on two threads": f"{seconds[0] / seconds[1]:.2f}",
                      "least angle": f"{group['quality.min_dihedral_deg'].min():.2f}",
                      "largest angle": f"{group['quality.max_dihedral_deg'].max():.2f}"})
    return _lines(pandas.DataFrame(lines))


def lines(sources, file):
    """Lines where labels meet, kept and left out, by image and trial."""
    return _lines(shapes.lines(sources.rows(file)))


def boxes(sources, file):
    """Flat boxes by image and trial."""
    return _lines(shapes.boxes(sources.rows(file)))


def thin_layers(sources, file):
    """Topologies of meshes that keep thin layers, by image and trial."""
    return _lines(shapes.thin(sources.rows(file)))


def line_angles(sources, file):
    """Mean angle errors of facets at lines, without lines as edges of the mesh and with them."""
    return _lines(shapes.angles(sources.rows(file)))


def lines_of_peers(sources, file):
    """Lines of podm and of other meshers, by image."""
    return _lines(shapes.peers(sources.rows(file)))


def costs(sources, folder):
    """Wall time in minutes, and memory, of each experiment over all its rows."""
    lines = []
    for name in sources.files(folder):
        rows = sources.rows(name)
        seconds = sum((row["process"] or {}).get("wall_s") or 0 for row in rows if row.get("process"))
        around = sum(row.get(part) or 0 for row in rows for part in ("preparation_s", "verification_s", "harness_s"))
        peak = max(((row.get("process") or {}).get("peak_rss_bytes") or 0 for row in rows), default=0)
        lines.append({"experiment": rows[0]["experiment"], "rows": len(rows),
                      "minutes": f"{(seconds + around) / 60:.1f}", "of these trials": f"{seconds / 60:.1f}",
                      "largest process, MiB": f"{peak / 2**20:.0f}"})
    return _lines(pandas.DataFrame(lines))


def gate(sources, file):
    """Answers of the performance gate by noise and planted slowdown, from `podm-bench gate-simulation --json`."""
    return _lines(pandas.DataFrame([
        {"noise of a process": f"{row['noise_percent']:g} %", "planted": f"{row['planted_percent']:g} %",
         **{answer.replace("_", " "): f"{row[answer]} of {row['tries']}"
            for answer in ("slower", "not_slower", "not_resolved")},
         "median rounds": f"{row['median_rounds']:.0f}"} for row in sources.rows(file)]))


def gate_tries(sources, file):
    """Answers of the performance gate on recorded rounds, by clock, kind of starts and planted slowdown."""
    return _lines(pandas.DataFrame([
        {"clock": row["clock"], "tries": row["starts"], "planted": f"{row['planted_percent']:g} %",
         "number": row["tries"], **{answer.replace("_", " "): row[answer]
                                    for answer in ("slower", "not_slower", "not_resolved")}}
        for row in sources.rows(file)]))


def machines(sources, folder):
    """Machines of the rows by hash of the topology: the processor by CPUID, or "not known"."""
    by_hash = {}
    for name in sources.files(folder):
        for row in sources.rows(name):
            if topology := (row.get("environment") or {}).get("topology_sha256"):
                by_hash.setdefault(topology, (row, set()))[1].add(str(sources.release_folder(name).name))
    provenance, lines = Provenance(sources), []
    for topology, (row, folders) in sorted(by_hash.items(), key=lambda one: (sorted(one[1][1]), one[0])):
        known = provenance.machine_of(row) or ("not known", "", "", "", "")
        lines.append({"topology": topology[:8], "rows in": ", ".join(sorted(folders)),
                      **dict(zip(("vendor", "family", "model", "stepping", "data caches, bytes"), known))})
    return _lines(pandas.DataFrame(lines))


def peers(sources, folder):
    """Speed of podm and other meshers where size drives, on one core: the README."""
    table = _peers(sources, folder)
    table = table[(table["setting"] == "size-0.3M-one") & table["mesher"].isin(PEERS_OF_README)]
    return _lines(table[["mesher", "version", "n", "facets", "whole, M cells/s", "PODM over it, whole", "coverage"]])


def peers_in_full(sources, folder):
    """The table `peers` with versions, numbers of rounds, bounds met and the coverage of intervals."""
    return _lines(_peers(sources, folder))


def _peers(sources, folder):
    return other_meshers.speed_table(sources.frame((folder,)))


def ranks(sources, folder):
    """Properties of meshes on ranks that do not depend on the machine; no seconds."""
    table = distributed.distributed(sources.frame((folder,)))
    table = table[table["ranks"] > 1].sort_values(["threads", "cells_per_rank", "ranks"])
    return _lines(pandas.DataFrame({
        "threads": table["threads"], "M cells per rank": [f"{value / 1e6:g}" for value in table["cells_per_rank"]],
        "ranks": table["ranks"],
        "M cells": [f"{value / 1e6:.2f}" for value in table["cells"]],
        "rounds": [f"{value:.0f}" for value in table["rounds"]],
        "share of cells deferred in round 0": [f"{100 * value:.1f} %" for value in table["deferred_share"]],
        "most cells of a rank over the mean": [f"{value:.3f}" for value in table["imbalance"]],
        "cells over those of one machine": [f"{value:.4f}" for value in table["cells_over_one_machine"]],
        "cells of all stores per cell": [f"{value:.2f}" for value in table["store_cells_per_cell"]],
        "seeds and vertices learnt per vertex": [f"{value:.2f}" for value in table["learnt_per_vertex"]]}))


def nodes(sources, folder):
    """Weak efficiency at 20 million cells per node, extrapolated from simulated ranks, and the parts of the time."""
    lines = distributed_model.extrapolated(distributed.distributed(sources.frame((folder,))))
    return _lines(distributed_model.readable(lines))


def simulated_speedups(sources, folder):
    """Speed-ups over PODM on one core by algorithm and cells per core, beside the paper's."""
    return _lines(speedups(scaling.weak_series(sources.frame((folder,)))))


def sharing(sources, file):
    """Speed-ups on 256 simulated cores over PODM on one, by the cost of a shared cache line or of a new page."""
    rows = sources.frame((file,))
    rows = rows[rows["status"] == "ok"].assign(rate=rows["cells"] / rows["seconds"],
                                               factor=rows["asked.cost_factor"].fillna("none=0"))
    lines = []
    for factor, group in rows.groupby("factor"):
        constant, times = factor.split("=")
        unit, words = SHARING[constant]
        rate = group.set_index(["algorithm", "cores"])["rate"]
        lines.append({"order": (constant != "none", constant, float(times)),
                      "cost": words.format(unit * float(times)),
                      **{title: f"{rate[algorithm, 256] / rate['podm', 1]:.1f}" if (algorithm, 256) in rate
                         else "not simulated" for title, algorithm in ALGORITHMS_OF_SHARING.items()}})
    return _lines(pandas.DataFrame(sorted(lines, key=lambda line: line["order"])).drop(columns="order"))


def verdicts(sources, file):
    """Claims of experiments, from a file of `podm-bench verdicts --json`."""
    found = experiment_verdicts.read_experiment_verdicts(sources.path(file))
    return _lines(experiment_verdicts.table(found)[["experiment", "claim", "basis", "verdict", "value", "bound", "n"]])


def paper_claims(sources, *names):
    """The paper's claims beside the project's results. `names`: folders of rows, then the file of podm-bench's
    verdicts."""
    *folders, file = names
    found = experiment_verdicts.read_experiment_verdicts(sources.path(file))
    return papers.markdown_lines(papers.rows(found, sources.frame(tuple(folders))))


TABLES = {table.__name__: table
          for table in (boxes, costs, gate, gate_tries, line_angles, lines, lines_of_peers, machines, nodes,
                        paper_claims, peers, peers_in_full, ranks, sharing, simulated_speedups, slivers, solvers,
                        solvers_in_full, thin_layers, verdicts)}
# Tables with seconds of the machine. Their rows must come from a known machine.
TIMED = {"costs": Expression("process"), "lines_of_peers": Expression("phases_s"), "nodes": Expression("phases_s"),
         "peers": Expression("phases_s"), "peers_in_full": Expression("phases_s"), "slivers": Expression("phases_s")}


def generate(name, arguments, sources, provenance):
    """Returns the table's text. Raises DocsError, also if the rows may not give the table."""
    if name not in TABLES:
        raise DocsError(f"no table '{name}': {', '.join(TABLES)}")
    rows = [row for one in arguments for file in sources.files(one) for row in sources.rows(file)]
    if fault := provenance.fault_of(rows, TIMED.get(name, FACT)):
        raise DocsError(fault)
    try:
        return "\n".join(TABLES[name](sources, *arguments)) + "\n"
    except (TypeError, ValueError, KeyError, RecordError, experiment_verdicts.VerdictsError,
            papers.PaperClaimsError) as error:
        raise DocsError(f"table {name}: {error}") from None
