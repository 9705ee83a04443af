"""The top of the page: four questions, each answered by a sentence and a picture."""
from html import escape

from figures import experiment_verdicts, guarantees, peers, scaling, simulated_sizes, style
from figures.fig4a import WHY_ABOVE
from figures.paper_claims import NAME

from .html import Bar, bars, findings, fold, remarks_html
from .paper_table import paper_table, summary

MOST_COUNTS = 4  # greatest number of core counts in the picture of scaling
FAULTS = {"unmet": "missed a guarantee", "failed": "failed", "timed_out": "timed out", "interrupted": "interrupted"}
NAMES = {**style.NAMES, "cgal": "CGAL, parallel", "cgal_sequential": "CGAL", "cgal_unsorted": "CGAL, unsorted queue",
         "cgal6": "CGAL 6, parallel", "cgal6_unsorted": "CGAL 6, unsorted queue", "gmsh": "Gmsh's HXT",
         "tetgen": "TetGen"}
FROM_SURFACE = ("tetgen", "gmsh")


def first_screen(frame, outcome):
    answers = [("works", "Does it work here?", works(frame, outcome)), ("fast", "How fast is it?", fast(outcome)),
               ("scales", "How does it scale here?", scales(outcome)),
               ("holds", "Which claims of the paper hold?", holds(outcome))]
    cards = "\n".join(f'<section class="answer" id="{name}" aria-labelledby="{name}-title">'
                      f'<h2 id="{name}-title">{question}</h2>\n{content}\n</section>'
                      for name, question, content in answers)
    return f'{remarks_html(outcome.remarks)}<div class="answers results">\n{cards}\n</div>'


def _answer(text):
    return f'<p class="answer-text">{escape(text)}</p>'


def _aside(text):
    return f'<p class="faint">{escape(text)}</p>' if text else ""


def works(frame, outcome):
    """Counts only podm's meshes; other meshers have their own table."""
    if "guarantees" not in outcome.tables:
        return _answer("Not known: no mesh of ours was verified.")
    table = outcome.tables["guarantees"][0]
    lines = table.to_dict("records")
    asked = [line["pass"] + line["fail"] + line["not_run"] for line in lines]  # fidelity is asked for few meshes
    meshes = max(asked)
    proved, refuted = int(table["pass"].sum()), int(table["fail"].sum())
    faults = _faults(frame)
    if refuted:
        answer = f"No: {refuted} claims about our {meshes} meshes are refuted, {proved:,} proved."
    elif faults:
        answer = f"Not always: {proved:,} claims about our {meshes} meshes are proved, none refuted; trials: {faults}."
    else:
        answer = f"Yes: {proved:,} claims about our {meshes} meshes are proved, none refuted, and no trial failed."
    picture = [Bar(line["claim"].replace("_", " "), line["pass"] / number,
                   f"{line['pass']} of {number}" + (f", {line['fail']} refuted" if line["fail"] else ""),
                   guarantees.verdict_of(line), f"not run for {line['not_run']}" if line["not_run"] else "")
               for line, number in zip(lines, asked) if number]
    return (_answer(answer) + bars("share of meshes by proved claim", picture, full=1)
            + _aside("Meshes proved, of those for which podm-verify checked the claim, outside the measured time."
                     + (f" Trials: {faults}." if refuted and faults else "")))


def _faults(frame):
    """Returns "3 timed out, 1 failed" for podm's trials; empty without faults."""
    ours = frame[frame["mesher"] == "podm"] if len(frame) else frame
    counts = ours["status"].value_counts() if "status" in ours else {}
    return ", ".join(f"{counts[status]} {words}" for status, words in FAULTS.items() if status in counts)


def fast(outcome):
    """Compares with other meshers on their largest mesh, if an experiment ran them; otherwise shows podm alone."""
    on_all = _rates_of_ours(outcome)
    if "peers" not in outcome.tables:
        if not on_all:
            return _answer("Not known: no verified run on one core.")
        picture = [Bar(name, rate, f"{rate / 1e6:.2f} M/s", kind) for name, rate, kind in on_all]
        return (_answer(_own_rates(on_all)) + bars("cells per second", picture)
                + _aside("No other mesher ran beside it: experiments/peers.toml compares."))
    table = outcome.tables["peers"][0]
    first = table.iloc[0]
    rows = table[(table["experiment"] == first["experiment"]) & (table["setting"] == first["setting"])
                 & (table["image"] == first["image"]) & (table["machine"] == first["machine"])
                 & (table["mesher"] != peers.OWN_VOLUME)]
    own = rows[rows["mesher"] == peers.OWN].iloc[0]
    others = rows[rows["mesher"] != peers.OWN]
    ratios = [f"{line['whole_ratio']:.1f} times the rate of {_name(line)}" for line in others.to_dict("records")]
    cores = "one core" if first["cores"] == 1 else f"{first['cores']} cores"
    answer = f"On {cores} PODM makes {own['whole_rate'] / 1e6:.2f} million cells per second, {', '.join(ratios)}."
    return (_answer(answer) + bars(f"cells per second, {cores}", _bars_of_peers(rows))
            + _aside(f"{first['setting']}: {first['image']}, medians of {_runs(rows)} runs. Whole: from the image in "
                     f"memory to the mesh in memory, including the surface that TetGen and HXT are given. "
                     f"{peers.LEFT_OUT} {_own_rates(on_all)}"))


def _name(line):
    name = NAMES.get(line["mesher"], line["mesher"])
    return f"{name} including its surface" if line["mesher"] in FROM_SURFACE else name


def _bars_of_peers(rows):
    picture = []
    for line in rows.to_dict("records"):
        kind = "own" if line["mesher"] == peers.OWN else "other"
        name = NAMES.get(line["mesher"], line["mesher"])
        facets = f", {line['facets'] / 1e3:.0f} k facets" if line["facets"] == line["facets"] else ""
        size = f"{line['cells'] / 1e6:.2f} M cells{facets}"
        missed = f"; its meshes miss {line['misses'].replace('_', ' ')}" if line["misses"] else ""
        picture.append(Bar(f"{name}, whole", line["whole_rate"], f"{line['whole_rate'] / 1e6:.2f} M/s", kind,
                           size + missed))
        picture.append(Bar(f"{name}, refining", line["refining_rate"], f"{line['refining_rate'] / 1e6:.2f} M/s",
                           kind + " pale"))
    return picture


def _runs(rows):
    low, high = rows["n"].min(), rows["n"].max()
    return f"{low}" if low == high else f"{low} to {high}"


def _rates_of_ours(outcome):
    """Returns (name, cells per second, colour) of PODM on one core and on the most, by refining and by equation 1."""
    one = scaling.first_of(outcome.series, "measured")
    if one is None:
        return []
    cores = sorted({1, one.table.loc["podm"].index.max()})
    return [(f"{count} core{'s' if count > 1 else ''}, {words}", float(one.table.loc[("podm", count), column]), kind)
            for count in cores for column, words, kind in (("refining_rate", "refining", "own"),
                                                           ("rate", "equation 1", "own pale"))]


def _own_rates(rates):
    parts = "; ".join(f"{name} {rate / 1e6:.2f}" for name, rate, _ in rates)
    return f"Weak scaling of PODM, million cells per second: {parts}." if rates else ""


def scales(outcome):
    """Shows measured rows. For simulated rows it only gives the note that a reader needs before their numbers."""
    simulated = _aside(simulated_sizes.depends_on_size(outcome.series))
    shown = scaling.shown_of(outcome.series, ["measured"])
    counts = [count for count in scaling.core_counts([one.table for one in shown]) if count > 1]
    if not counts:
        return _answer("Not known: no verified run of weak scaling on more than one core.") + simulated
    picture = [bar for count in _some(counts) for bar in _bars_of_scaling(shown, count)]
    answer = _scaling_summary(shown[0], counts[-1])
    return (_answer(answer)
            + bars("efficiency of weak scaling", picture, full=max(1.2, *(bar.value for bar in picture)), mark=1)
            + _aside(f"Efficiency: cells per second and core over PODM's on one core; the line is 100 %. {WHY_ABOVE}. "
                     f"{style.caption_of(shown, has_paper=False)}") + simulated)


def _some(counts):
    """Returns at most MOST_COUNTS of them, including the most cores."""
    step = -(-len(counts) // MOST_COUNTS)
    return counts[::-1][::step][::-1]


def _bars_of_scaling(shown, count):
    for algorithm, name in style.NAMES.items():
        for one in shown:
            if (algorithm, count) not in one.table.index:
                continue
            line = one.table.loc[(algorithm, count)]
            kinds = [("efficiency", "equation 1, image grows" if one.grows else "equation 1", "pale")]
            if not one.grows:
                kinds.insert(0, ("refining_efficiency", "refining", ""))
            for column, words, shade in kinds:
                value = line[column]
                if value == value:
                    yield Bar(f"{name}, {count} cores, {words}", float(value), f"{100 * value:.0f} %",
                              f"{algorithm} {shade}")


def _scaling_summary(series, count):
    parts = []
    for algorithm, name in style.NAMES.items():
        if (algorithm, count) in series.table.index:
            line = series.table.loc[(algorithm, count)]
            parts.append(f"{name} {100 * line['refining_efficiency']:.0f} % in refining and "
                         f"{100 * line['efficiency']:.0f} % by equation 1")
    return f"Rate per core on {count} cores, relative to one core: {'; '.join(parts)}."


def holds(outcome):
    """Shows the table of the paper's claims, then the claims of the project's experiments."""
    if outcome.experiments is None:
        return _answer("Not judged.") + _aside(experiment_verdicts.HOW)
    if NAME in outcome.missing:
        return _answer(f"Not judged: {outcome.missing[NAME]}.") + _experiments(outcome)
    return _answer(f"{summary(outcome.paper).capitalize()}.") + paper_table(outcome.paper) + _experiments(outcome)


def _experiments(outcome):
    """Shows podm-bench's verdicts: claims that do not hold are as visible as those that hold."""
    lines = experiment_verdicts.table(outcome.experiments).to_dict("records")
    parts = {word: [(word, f"{line['experiment']}: {line['statement']} ({line['basis']})", line["reason"])
                    for line in lines if line["verdict"] == word] for word in experiment_verdicts.WORDS}
    former = [(line["verdict"], f"{line['experiment']}: {line['statement'] or line['claim']}", line["reason"])
              for line in lines if line["verdict"] == experiment_verdicts.WITHDRAWN]
    return (_answer(f"Claims of our own experiments: {experiment_verdicts.counts(outcome.experiments)}.")
            + findings(parts["does_not_hold"])
            + fold(f"Not resolved: {len(parts['not_resolved'])}", findings(parts["not_resolved"]))
            + fold(f"Holding: {len(parts['holds'])}", findings(parts["holds"]))
            + fold(f"Not decided here: {len(parts['cannot_be_decided'])}",
                   findings(parts["cannot_be_decided"]))
            + fold(f"No longer claimed: {len(former)}", findings(former)))
