"""Tables that scripts/update_docs generates: `<!-- table NAME ARGUMENTS -->`. Each function takes the sources and the
arguments and returns lines of Markdown; another table is a function and a line in TABLES."""
from figures import experiment_verdicts, scaling
from figures import solvers as solving
from figures.simulated_sizes import speedups
from figures.write import markdown

from .errors import DocsError


def _lines(table):
    return markdown(table).splitlines()


def solvers(sources, folder):
    """Iterations by image and variant, without the angles of the meshes: README."""
    shown = solving.readable(solving.solvers(sources.frame((folder,))))
    return _lines(shown.drop(columns=["dihedral angles", *(one for one in shown if "eigenvalue" in one)]))


def simulated_speedups(sources, folder):
    """Speed-ups over PODM on one core by algorithm and cells a core, beside the paper's."""
    return _lines(speedups(scaling.weak_series(sources.frame((folder,)))))


def verdicts(sources, file):
    """Claims of experiments, of a file of `podm-bench verdicts --json`."""
    found = experiment_verdicts.read_experiment_verdicts(sources.path(file))
    return _lines(experiment_verdicts.table(found)[["experiment", "claim", "basis", "verdict", "value", "bound", "n"]])


TABLES = {"solvers": solvers, "simulated_speedups": simulated_speedups, "verdicts": verdicts}


def generate(name, arguments, sources):
    """Raises DocsError."""
    if name not in TABLES:
        raise DocsError(f"no table '{name}': {', '.join(TABLES)}")
    try:
        return "\n".join(TABLES[name](sources, *arguments)) + "\n"
    except TypeError as error:
        raise DocsError(f"table {name}: {error}") from None
