"""Makes the table of the paper's claims in HTML: one line per claim, on narrow pages one block."""
from html import escape

from figures import paper_claims
from figures.paper_claims import AGREES, CONTRADICTED, IN_PART, NOT_JUDGED, NOT_RESOLVED, SIDES

from .html import verdict_span

ORDER = [AGREES, AGREES + IN_PART, CONTRADICTED + IN_PART, CONTRADICTED, NOT_RESOLVED, NOT_JUDGED]


def summary(rows):
    """Returns the number of lines by verdict: measured, then simulated."""
    return "; ".join(f"{side}: {_counts(rows, side)}" for side in SIDES)


def _counts(rows, side):
    verdicts = [row[side]["verdict"] for row in rows]
    return ", ".join(f"{verdicts.count(one)} {one}" for one in ORDER if one in verdicts)


def paper_table(rows):
    head = "".join(f'<th scope="col">{escape(title)}</th>' for title in paper_claims.TITLES[:-1])
    body = "\n".join(map(_line, rows))
    return (f'<table class="paper"><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table>'
            f'<p class="faint">{escape(paper_claims.besides())}</p>')


def _line(row):
    _, *titles = paper_claims.TITLES[:-2]
    cells = "".join(f'<td data-title="{escape(title, quote=True)}">{escape(row[side]["text"])}</td>'
                    for title, side in zip(titles, SIDES))
    return (f'<tr><th scope="row">{escape(row["says"])} <small>{escape(row["place"])}</small></th>{cells}'
            f'<td>{_verdicts(row)}</td></tr>')


def _verdicts(row):
    """Returns the verdict of each judged side, and the experiments with the details."""
    judged = [side for side in SIDES if row[side]["verdict"] != NOT_JUDGED]
    if not judged:
        return verdict_span(NOT_JUDGED)
    spans = "".join(f'<div>{side} {verdict_span(row[side]["verdict"])}</div>' for side in judged)
    return f'{spans}<small>{escape(", ".join(paper_claims.experiments(row)))}</small>'
