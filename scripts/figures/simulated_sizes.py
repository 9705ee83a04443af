"""Simulated speed-ups of every size, beside the paper's."""
import pandas

from . import paper, scaling, style


def speedups(series):
    """One line a number of cores beyond one: by algorithm the speed-up over PODM on one core that the paper has, and
    those simulated, by cells a core; as text, empty where there is none."""
    published, sizes = paper.corrected_table1()["speedup"], scaling.simulated_sizes(series)
    lines = []
    for cores in (count for count in scaling.core_counts([one.table for one in sizes]) if count > 1):
        line = {"cores": cores}
        for algorithm, name in style.NAMES.items():
            if algorithm in paper.ALGORITHMS:
                line[f"{name}: paper"] = _text(published.get((algorithm, cores)))
            for one in sizes:
                if algorithm in one.table.index.get_level_values("algorithm"):
                    found = one.table["speedup"].get((algorithm, cores))
                    line[f"{name}: {scaling.short(one.cells_per_core)}"] = _text(found)
        lines.append(line)
    return pandas.DataFrame(lines)


def _text(value):
    return "" if value is None else f"{value:.1f}"
