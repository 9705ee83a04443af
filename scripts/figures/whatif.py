"""Which algorithm to use on a machine that a file describes, and from how many cores on: runs both in virtual time on
one to all of its cores, draws their rates and efficiencies, and prints the answer.

The trials are an experiment of podm-bench, written beside the picture: meshes are verified, a second call goes on where
the first ended, rows and radii stay in the output folder. Times are simulated; results/README.md tells the limits.
Exit codes: 0 made, 2 bad usage or input, or trials that failed.
"""
import argparse
import re
import subprocess
import sys
import tomllib
from pathlib import Path

from . import claims, scaling, style
from .load import RecordError, load
from .write import write_figure, write_text

ROOT = Path(__file__).resolve().parents[2]
STEPS = 8


class MachineError(Exception):
    """A description that cannot be read; the text names file and fault."""


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="whatif", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("machine", type=Path, metavar="MACHINE.toml", help="such as experiments/machines/template.toml")
    parser.add_argument("--image", default="phantom:abdomen@64", help="label image or phantom (default: %(default)s)")
    parser.add_argument("--cells-per-core", type=int, default=10_000, metavar="N",
                        help="from 1000; the more, the surer and the slower (default: %(default)s)")
    parser.add_argument("-o", "--output", type=Path, metavar="FOLDER",
                        help="for rows and picture (default: results/runs/whatif/NAME of the machine)")
    parser.add_argument("--bench", type=Path, default=ROOT / "build" / "bin" / "podm-bench",
                        help="the program that runs trials (default: build/bin/podm-bench)")
    arguments = parser.parse_args(arguments)
    try:
        if arguments.cells_per_core < 1000:
            raise MachineError("--cells-per-core must be 1000 or more: fewer are no mesh to share")
        return answer(arguments)
    except (MachineError, RecordError) as error:
        print(f"whatif: {error}", file=sys.stderr)
        return 2


def answer(arguments):
    num_nodes, cores_per_node = read_size(arguments.machine)
    name = arguments.machine.stem
    folder = arguments.output or ROOT / "results" / "runs" / "whatif" / name
    folder.mkdir(parents=True, exist_ok=True)
    experiment = folder / f"whatif_{re.sub(r'[^A-Za-z0-9_-]', '_', name)}.toml"
    write_text(experiment, experiment_text(arguments, core_counts(num_nodes, cores_per_node), cores_per_node))
    run_trials(arguments.bench, experiment, folder)
    frame = load([folder / f"{experiment.stem}.jsonl"]).frame
    series = _of_size(scaling.weak_series(frame), arguments.cells_per_core)
    if series is None:
        doubts = sorted(set(frame["doubt"]) - {""}) if len(frame) else []
        raise MachineError(f"no verified run of both algorithms on one core and on more{': ' if doubts else ''}"
                           f"{'; '.join(doubts)}")
    write_figure(picture(series, name), folder, "whatif")
    print(advice(series, name))
    print(f"whatif: {folder / 'whatif.png'}", file=sys.stderr)
    return 0


def read_size(path):
    """(nodes, cores of a node). What else the description holds the mesher reads, and refuses. Raises MachineError."""
    try:
        with open(path, "rb") as file:
            described = tomllib.load(file)
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise MachineError(f"{path}: {getattr(error, 'strerror', None) or error}") from None
    sizes = []
    for section, key, default in (("network", "nodes", 1), ("processor", "sockets_per_node", None),
                                  ("processor", "cores_per_socket", None)):
        value = described.get(section, {}).get(key, default)
        if not isinstance(value, int) or value < 1:
            raise MachineError(f"{path}: {section}.{key} must be a whole number from 1 on")
        sizes.append(value)
    return sizes[0], sizes[1] * sizes[2]


def core_counts(num_nodes, cores_per_node):
    """One, and each eighth of the machine; beyond a node whole nodes, as all have to have the same number of cores."""
    eighths = [max(1, num_nodes * cores_per_node * step // STEPS) for step in range(1, STEPS + 1)]
    return sorted({1, *(count if count <= cores_per_node else count - count % cores_per_node for count in eighths)})


def experiment_text(arguments, counts, cores_per_node):
    """A trial each number of cores: a node in part has no number of cores of its own to ask for."""
    image = str(Path(arguments.image).resolve()) if Path(arguments.image).exists() else arguments.image
    lines = [f'title = "What if: {arguments.machine.stem}"', 'claim = "Both algorithms run in virtual time."',
             "timeout_s = 7200", "", "[inputs.image]", f"image = {_quoted(image)}"]
    for count in counts:
        lines += ["", "[[trials]]", f'name = "{arguments.cells_per_core}-on-{count}"', 'input = "image"',
                  f"target_elements_per_thread = {arguments.cells_per_core}",
                  'algorithm = ["podm", "pdr-podm"]', f"threads = {count}",
                  *([f"cores_per_node = {cores_per_node}"] if count >= cores_per_node else []), 'executor = "virtual"',
                  f"topology = {_quoted(arguments.machine.resolve())}", 'pin = "compact"']
    lines += ["", "[[claims]]", 'name = "ended"', 'statement = "Every run ends."', 'basis = "simulated"',
              'kind = "share"', 'value = "ended"', "at_least = 1.0"]
    return "\n".join(lines) + "\n"


def _quoted(text):
    escaped = str(text).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def run_trials(bench, experiment, folder):
    """Its table and progress go to standard error: the answer alone is on standard output."""
    try:
        done = subprocess.run([bench, "run", experiment, "--results", folder], stdout=sys.stderr)
    except OSError as error:
        raise MachineError(f"{bench}: {error.strerror}; `make build` builds it") from None
    if done.returncode:
        raise MachineError(f"podm-bench ended with {done.returncode}; what it said stands above")


def _of_size(series, cells_per_core):
    """The simulated series of those cells a core; None unless both algorithms ran on more than one core."""
    for one in series:
        is_near = abs(one.cells_per_core / cells_per_core - 1) <= scaling.SIZE_TOLERANCE
        if one.key["basis"] == "simulated" and is_near and claims.crossover(one.table) != (0, None):
            return one
    return None


def advice(series, name):
    """Which algorithm, from which number of cores on, and how much the faster of the two keeps on all."""
    behind, ahead = claims.crossover(series.table)
    where = f"{name}, {scaling.short(series.cells_per_core)} cells a core, {series.key['image']}, simulated"
    most = max(scaling.core_counts([series.table]))
    if ahead is None:
        text = f"podm on all numbers of cores up to {most}"
    elif behind == 0:
        text = f"pdr-podm on all numbers of cores up to {most}"
    else:
        text = f"podm {'on one core' if behind == 1 else f'up to {behind} cores'}, pdr-podm from {ahead} on"
    best = "podm" if ahead is None else "pdr-podm"
    line = series.table.loc[best, most]
    return (f"{where}: {text}.\nOn {most} cores {best} makes {line['rate'] / 1e6:.3g} million cells a simulated "
            f"second, {100 * line['efficiency']:.0f} % efficiency. Another number of cells a core may have another "
            "answer: of few, leaves are few.")


def picture(series, name):
    """Rate and efficiency of both algorithms, and where one overtakes the other."""
    figure, (rate, efficiency) = style.new_figure(columns=2, height=4.2)
    behind, ahead = claims.crossover(series.table)
    for axes, column, scale in ((rate, "rate", 1e-6), (efficiency, "efficiency", 100)):
        style.plot_series(axes, series, column, scale)
        axes.set_xlabel("simulated cores")
        axes.set_xlim(0, None)
        if behind and ahead:
            axes.axvspan(behind, ahead, color=style.GHOST, alpha=0.2, label=f"crossover, {behind} to {ahead} cores")
    rate.set(ylabel="million cells a simulated second", title=f"{name}: rate", ylim=(0, None))
    efficiency.set(ylabel="efficiency, % of PODM on one core", title="efficiency", ylim=(0, None))
    style.legend(rate, loc="upper left")
    style.finish(figure, f"{style.caption_of([series], has_paper=False)} Times are simulated, of equation 1.")
    return figure
