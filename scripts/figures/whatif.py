"""Finds the best algorithm for a machine that a file describes, and its range of cores: runs PODM, PDR.PODM and PODM at
home in virtual time on one to all of its cores, draws their rates and efficiencies, and prints the answer.

The trials are an experiment of podm-bench, written beside the picture: meshes are verified, a second call continues
where the first stopped, rows and radii stay in the output folder. Times are simulated; results/README.md states the
limits. Exit codes: 0 made, 2 bad usage or input, or trials that failed.
"""
import argparse
import re
import subprocess
import sys
import tomllib
from pathlib import Path

from . import scaling, style
from .load import RecordError, load
from .whole_file import write_text
from .write import write_figure

ROOT = Path(__file__).resolve().parents[2]
STEPS = 8


class MachineError(Exception):
    """A description that cannot be read; the text names the file and the fault."""


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="whatif", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("machine", type=Path, metavar="MACHINE.toml", help="such as experiments/machines/template.toml")
    parser.add_argument("--image", default="phantom:abdomen@64", help="label image or phantom (default: %(default)s)")
    parser.add_argument("--cells-per-core", type=int, default=10_000, metavar="N",
                        help="1000 or more; larger numbers are more reliable and slower (default: %(default)s)")
    parser.add_argument("-o", "--output", type=Path, metavar="FOLDER",
                        help="for rows and picture (default: results/runs/whatif/NAME of the machine)")
    parser.add_argument("--bench", type=Path, default=ROOT / "build" / "bin" / "podm-bench",
                        help="the program that runs trials (default: build/bin/podm-bench)")
    arguments = parser.parse_args(arguments)
    try:
        if arguments.cells_per_core < 1000:
            raise MachineError("--cells-per-core must be 1000 or more: a smaller mesh cannot be shared")
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
        raise MachineError(f"no verified runs of two algorithms on equal cores, and of podm on one"
                           f"{': ' if doubts else ''}{'; '.join(doubts)}")
    write_figure(picture(series, name), folder, "whatif")
    print(advice(series, name))
    print(f"whatif: {folder / 'whatif.png'}", file=sys.stderr)
    return 0


def read_size(path):
    """Returns (nodes, cores per node). The mesher reads and checks the rest of the description. Raises MachineError."""
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
    """Returns one, and each eighth of the machine; beyond one node only whole nodes, as all must have the same number
    of cores."""
    eighths = [max(1, num_nodes * cores_per_node * step // STEPS) for step in range(1, STEPS + 1)]
    return sorted({1, *(count if count <= cores_per_node else count - count % cores_per_node for count in eighths)})


def experiment_text(arguments, counts, cores_per_node):
    """Returns an experiment with one trial per number of cores. A partial node does not ask for a number of cores per
    node."""
    image = str(Path(arguments.image).resolve()) if Path(arguments.image).exists() else arguments.image
    lines = [f'title = "What if: {arguments.machine.stem}"', 'claim = "All algorithms run in virtual time."',
             "timeout_s = 7200", "", "[inputs.image]", f"image = {_quoted(image)}"]
    for count in counts:
        algorithms = ", ".join(map(_quoted, algorithms_on(count)))
        lines += ["", "[[trials]]", f'name = "{arguments.cells_per_core}-on-{count}"', 'input = "image"',
                  f"target_elements_per_thread = {arguments.cells_per_core}",
                  f"algorithm = [{algorithms}]", f"threads = {count}",
                  *([f"cores_per_node = {cores_per_node}"] if count >= cores_per_node else []), 'executor = "virtual"',
                  f"topology = {_quoted(arguments.machine.resolve())}", 'pin = "compact"']
    lines += ["", "[[claims]]", 'name = "ended"', 'statement = "Every run ends."', 'basis = "simulated"',
              'kind = "share"', 'value = "ended"', "at_least = 1.0"]
    return "\n".join(lines) + "\n"


def algorithms_on(count):
    """Returns the algorithms to run; on one core PODM at home equals PODM."""
    return [name for name in style.NAMES if count > 1 or name != "podm-home"]


def _quoted(text):
    escaped = str(text).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def run_trials(bench, experiment, folder):
    """Runs podm-bench. Its output goes to standard error; only the answer goes to standard output."""
    try:
        done = subprocess.run([bench, "run", experiment, "--results", folder], stdout=sys.stderr)
    except OSError as error:
        raise MachineError(f"{bench}: {error.strerror}; `make build` builds it") from None
    if done.returncode:
        raise MachineError(f"podm-bench ended with {done.returncode}; its messages are above")


def _of_size(series, cells_per_core):
    """Returns the simulated series of this size; None unless two algorithms can be compared on some number of cores."""
    for one in series:
        is_near = abs(one.cells_per_core / cells_per_core - 1) <= scaling.SIZE_TOLERANCE
        if one.key["basis"] == "simulated" and is_near and fastest(one.table):
            return one
    return None


def fastest(table):
    """Returns (algorithm, fewest cores, most cores) for each range of core counts where it makes the most cells per
    second; among equal ones the first of NAMES. Numbers of cores with fewer than two algorithms are left out."""
    stretches = []
    for cores, rates in table["rate"].unstack("algorithm").reindex(columns=list(style.NAMES)).iterrows():
        rates = rates.dropna()
        if len(rates) < 2:
            continue
        best = rates.idxmax()
        if stretches and stretches[-1][0] == best:
            stretches[-1] = (best, stretches[-1][1], cores)
        else:
            stretches.append((best, cores, cores))
    return stretches


def advice(series, name):
    """Returns the fastest algorithm by range of cores, the rates on the most cores, and missing runs."""
    where = f"{name}, {scaling.short(series.cells_per_core)} cells per core, {series.key['image']}, simulated"
    counts = scaling.core_counts([series.table])
    lines = [f"{where}: {_ranges_in_words(fastest(series.table), counts[-1])}."]
    on_most = series.table.xs(counts[-1], level="cores").sort_values("rate", ascending=False)
    made = [f"{algorithm} {line['rate'] / 1e6:.3g} ({100 * line['efficiency']:.0f} %)"
            for algorithm, line in on_most.iterrows()]
    lines.append(f"Million cells per simulated second (efficiency) on {_cores(counts[-1])}: {', '.join(made)}.")
    for algorithm in style.NAMES:
        lacking = [str(count) for count in counts
                   if algorithm in algorithms_on(count) and (algorithm, count) not in series.table.index]
        if lacking:
            lines.append(f"No verified run of {algorithm} with this number of cells per core on {', '.join(lacking)}: "
                         "it is not compared there.")
    lines.append("The answer may differ for another number of cells per core: a small mesh has few leaves.")
    return "\n".join(lines)


def _ranges_in_words(stretches, most):
    """Returns "podm on one core, pdr-podm from 32 to 64 cores, podm-home from 96 cores on"."""
    if len(stretches) == 1 and stretches[0][2] == most:
        return f"{stretches[0][0]} on all numbers of cores up to {most}"
    parts = []
    for place, (algorithm, first, last) in enumerate(stretches):
        if place == len(stretches) - 1 and last == most:
            parts.append(f"{algorithm} from {first} on")
        elif first == last:
            parts.append(f"{algorithm} on {_cores(first)}")
        else:
            parts.append(f"{algorithm} {'up' if place == 0 else f'from {first}'} to {last} cores")
    return ", ".join(parts)


def _cores(count):
    return "one core" if count == 1 else f"{count} cores"


def picture(series, name):
    """Draws the rate and efficiency of all algorithms, and marks where the fastest one changes."""
    figure, (rate, efficiency) = style.new_figure(columns=2, height=4.2)
    stretches = fastest(series.table)
    for axes, column, scale in ((rate, "rate", 1e-6), (efficiency, "efficiency", 100)):
        style.plot_series(axes, series, column, scale)
        axes.set_xlabel("simulated cores")
        axes.set_xlim(0, None)
        for (_, _, behind), (algorithm, ahead, _) in zip(stretches, stretches[1:]):
            axes.axvspan(behind, ahead, color=style.COLOURS[algorithm], alpha=0.15,
                         label=f"{style.NAMES[algorithm]} overtakes, {behind} to {ahead} cores")
    rate.set(ylabel="million cells per simulated second", title=f"{name}: rate", ylim=(0, None))
    efficiency.set(ylabel="efficiency, % of PODM on one core", title="efficiency", ylim=(0, None))
    style.legend(rate, loc="upper left")
    style.finish(figure, f"{style.caption_of([series], has_paper=False)} Times are simulated, of equation 1.")
    return figure
