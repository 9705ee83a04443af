"""The table of what the paper claims, what was measured here, what was simulated, and the verdicts on both.

results/paper/claims.toml has the lines. A verdict is made of those of podm-bench on the claims that the line names,
measured and simulated apart.
"""
import re
import textwrap
import tomllib

import pandas

from . import paper, paper_figures

LINES = paper.FOLDER / "claims.toml"
NAME = "paper_claims"  # of the table
SIDES = ("measured", "simulated")
AGREES, CONTRADICTED, NOT_RESOLVED, NOT_JUDGED = "agrees", "contradicted", "not resolved", "not judged"
IN_PART = " in part"
TITLES = ["the paper says", "measured here (cells per core)", "simulated (cells per core)", "verdict", "more"]
PLACEHOLDER = re.compile(r"\{([^}]*)\}")
WIDTH = 120  # of a line of text


class PaperClaimsError(Exception):
    """Lines that cannot be judged as they are written; the text names file, line and fault."""


def read_lines(path=LINES):
    """(lines of the table, what the paper says besides). Raises PaperClaimsError."""
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise PaperClaimsError(f"{path}: {error}") from None
    for line in found["claims"]:
        for side in SIDES:
            if ("claims" in line[side]) == ("reason" in line[side]):
                raise PaperClaimsError(f"{path}: {line['id']}: {side} needs either claims or a reason")
    return found["claims"], found["unjudged"]


def published(text):
    """The text with the values of the paper's tables in place of {FILE COLUMN KEY}, as printed."""
    return PLACEHOLDER.sub(lambda found: _printed(*found.group(1).split()), text)


def _printed(file, column, key):
    table = pandas.read_csv(paper.FOLDER / f"{file}.csv", dtype=str)
    (value,) = table.loc[table.iloc[:, 0] == key, column]
    return value


def derived(verdicts):
    """One verdict of those on several claims. What is withdrawn judges nothing."""
    holds, fails, open_ones = (verdicts.count(word) for word in ("holds", "does_not_hold", "not_resolved"))
    if fails:
        return CONTRADICTED + (IN_PART if holds else "")
    if open_ones:
        return NOT_RESOLVED
    if holds:
        return AGREES + (IN_PART if "cannot_be_decided" in verdicts else "")
    return NOT_JUDGED


def rows(verdicts, frame, lines=None):
    """A dictionary a line: `says`, `place`, and of each side its `text`, `verdict`, and `claims`, (experiment, verdict)
    by name. `verdicts`: of podm-bench; `frame`: of load(). Raises PaperClaimsError."""
    lines = lines if lines is not None else read_lines()[0]
    claims = _by_name(verdicts)
    values = {name: one[0][1].get("value") for name, one in claims.items() if len(one) == 1}
    ours = {side: paper_figures.Ours(frame, side, values) for side in SIDES}
    return [{"id": line["id"], "says": published(line["says"]), "place": line["place"],
             **{side: _judged(line["id"], line[side], claims, ours[side]) for side in SIDES}} for line in lines]


def _by_name(verdicts):
    """(experiment, claim) by the claim's name: one, but of an experiment that has rows in several folders."""
    found = {}
    for experiment in verdicts["experiments"]:
        for claim in [*experiment["claims"], *experiment.get("withdrawn", [])]:
            found.setdefault(claim["name"], []).append((experiment["experiment"], claim))
    return found


def _judged(line, side, claims, ours):
    if "reason" in side:
        return {"text": side["reason"], "verdict": NOT_JUDGED, "claims": {}}
    found = {name: _claim(line, name, claims, ours.basis) for name in side["claims"]}
    verdict = derived([claim["verdict"] for _, claim in found.values()])
    reasons = dict.fromkeys(claim["reason"] for _, claim in found.values())
    text = _shown(side.get("shows", []), ours) or "; ".join(reasons)
    return {"text": text, "verdict": verdict,
            "claims": {name: (experiment, claim["verdict"]) for name, (experiment, claim) in found.items()}}


def _claim(line, name, claims, basis):
    found = claims.get(name, [])
    if len(found) != 1:
        fault = "no claim of the verdicts is called" if not found else f"{len(found)} claims are called"
        raise PaperClaimsError(f"{LINES.name}: {line}: {fault} {name!r}")
    stands_as = found[0][1].get("basis", basis)  # a withdrawn claim has none
    if stands_as not in (basis, "any"):
        raise PaperClaimsError(f"{LINES.name}: {line}: {name!r} is {stands_as}, and stands as {basis}")
    return found[0]


def _shown(parts, ours):
    """Parts whose figures rows have. One without figures only goes with others."""
    texts = [(_filled(part, ours), "{" in part) for part in parts]
    has_figure = any(text and is_figure for text, is_figure in texts)
    return "; ".join(text for text, _ in texts if text) if has_figure else ""


def _filled(part, ours):
    figures = {query: paper_figures.figure(query, ours) for query in PLACEHOLDER.findall(part)}
    if None in figures.values():
        return None
    return PLACEHOLDER.sub(lambda found: figures[found.group(1)], part)


def verdict_text(row):
    """"measured: agrees; simulated: contradicted in part, 1 of 3 claims hold"."""
    return "; ".join(f"{side}: {row[side]['verdict']}{_counts(row[side])}" for side in SIDES
                     if row[side]["verdict"] != NOT_JUDGED) or NOT_JUDGED


def _counts(side):
    verdicts = [verdict for _, verdict in side["claims"].values()]
    return f", {verdicts.count('holds')} of {len(verdicts)} claims hold" if side["verdict"].endswith(IN_PART) else ""


def experiments(row):
    """Names of those that judge the line, in its order."""
    return list(dict.fromkeys(experiment for side in SIDES for experiment, _ in row[side]["claims"].values()))


def table(found):
    """The rows as a table for people."""
    return pandas.DataFrame([[f"{row['says']} ({row['place']})", *(row[side]["text"] for side in SIDES),
                              verdict_text(row), ", ".join(f"{name}.toml" for name in experiments(row))]
                             for row in found], columns=TITLES)


def besides():
    """What the paper says besides, and why nothing judges it, a sentence."""
    _, unjudged = read_lines()
    return "Not judged: " + "; ".join(f"{published(one['says'])} ({one['place']}): {one['reason']}"
                                      for one in unjudged) + "."


def markdown_lines(found):
    """The table and what stands below it, with links from the repository's root."""
    shown = table(found)
    shown["verdict"] = shown["verdict"].str.replace(CONTRADICTED, f"**{CONTRADICTED}**")
    shown["more"] = [", ".join(f"[{name}](experiments/{name}.toml)" for name in experiments(row)) for row in found]
    cells = [TITLES, ["---"] * len(TITLES), *shown.itertuples(index=False)]
    made = ["| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in cells]
    return [line.replace("\N{NO-BREAK SPACE}", " ") for line in [*made, "", *textwrap.wrap(besides(), WIDTH)]]
