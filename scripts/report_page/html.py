"""HTML of a page and its parts: tables, bars, folds. All texts are escaped here."""
from dataclasses import dataclass
from html import escape
from pathlib import Path

import pandas

from figures.table1 import MARKS


STYLE = Path(__file__).with_name("page.css")


def document(title, header, main, script):
    """Returns the whole page. Everything is inlined: the page needs only a browser."""
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title>
<link rel="icon" href="data:,">
<style>{STYLE.read_text(encoding='utf-8')}</style>
</head>
<body>
<header>
{header}
</header>
<main>
{main}
</main>
{script}
</body>
</html>
"""


def remarks_html(remarks):
    """Returns sentences that must be shown before the numbers."""
    return "".join(f'<p class="remark">{escape(remark)}</p>\n' for remark in remarks)


def section(name, title, content):
    heading = f'<h2 id="{name}-title">{title}</h2>'
    return f'<section id="{name}" aria-labelledby="{name}-title">{heading}\n{content}\n</section>'


@dataclass(frozen=True)
class Bar:
    """`value`: compared with the longest bar. `text`: the value in words. `kind`: the class that colours the bar."""

    name: str
    value: float
    text: str
    kind: str = ""
    note: str = ""


def bars(title, lines, full=None, mark=None):
    """Draws numbers as bars; screen readers read them as a list. `full`: the value that fills the width. `mark`: a
    value at which a line is drawn."""
    full = full or max((line.value for line in lines), default=1) or 1
    line_at = f'<b style="left:{_share(mark, full)}"></b>' if mark else ""
    items = "".join(
        f'<li class="{line.kind}"><span class="name">{escape(line.name)}</span>'
        f'<span class="track" aria-hidden="true"><i style="width:{_share(line.value, full)}"></i>{line_at}</span>'
        f'<span class="value">{escape(line.text)}</span>'
        + (f'<small>{escape(line.note)}</small>' if line.note else "") + "</li>" for line in lines)
    return f'<ul class="bars" aria-label="{escape(title, quote=True)}">{items}</ul>'


def _share(value, full):
    return f"{100 * min(1, max(0, value / full)):.1f}%"


def box(title, content):
    """Returns a box that scrolls sideways if the page is narrower than its content."""
    return f'<div class="wide" tabindex="0" role="region" aria-label="{escape(title, quote=True)}">{content}</div>'


def fold(summary, content, is_open=False):
    return f"<details{' open' if is_open else ''}><summary>{escape(summary)}</summary>\n{content}</details>"


def responsive(svg, title):
    """Removes the size, which the page sets; the view box keeps the shape."""
    head, rest = svg.split(">", 1)
    kept = [part for part in head.replace("\n", " ").split(" ") if not part.startswith(("width=", "height="))]
    return f'{" ".join(kept)} role="img" aria-label="{escape(title, quote=True)}">{rest}'


def verdict_span(verdict):
    return f'<span class="verdict {escape(verdict.replace(" ", "_"))}">{escape(verdict.replace("_", " "))}</span>'


def findings(lines):
    """Returns an HTML list of `lines`: (verdict, statement, reason)."""
    items = "".join(f'<li>{verdict_span(verdict)}: {escape(statement)}<small>{escape(reason)}</small></li>'
                    for verdict, statement, reason in lines)
    return f'<ul class="findings">{items}</ul>' if lines else ""


def table_html(table, title, row_classes=None):
    """Returns a table in a box. A column `verdict` is marked, the first column heads its row."""
    head = "".join(f'<th scope="col">{escape(str(name))}</th>' for name in table.columns)
    lines = []
    for position, row in enumerate(table.itertuples(index=False)):
        cells = [_cell(name, value, is_first=at == 0) for at, (name, value) in enumerate(zip(table.columns, row))]
        kind = f' class="{row_classes[position]}"' if row_classes is not None else ""
        lines.append(f"<tr{kind}>{''.join(cells)}</tr>")
    rows = "\n".join(lines)
    return box(title, f"<table><thead><tr>{head}</tr></thead>\n<tbody>{rows}</tbody></table>")


def text_of(value):
    if value is None or value is pandas.NA or value != value:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _cell(name, value, is_first):
    if is_first:
        kind = ' class="short"' if len(text_of(value)) < 20 else ""
        return f'<th scope="row"{kind}>{escape(text_of(value))}</th>'
    if name == "verdict":
        return f"<td>{verdict_span(value)}</td>"
    text = text_of(value)
    is_number = text.lstrip("".join(MARKS.values()))[:1].isdigit()
    kind = ' class="words"' if len(text) > 30 else ' class="number"' if is_number else ""
    return f"<td{kind}>{escape(text)}</td>"
