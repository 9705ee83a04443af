"""The page's HTML from an Outcome. Everything is inlined; every text is escaped."""
import json
from html import escape
from pathlib import Path

import pandas

from figures.outcome import readable_verdicts
from figures.write import svg_of

HERE = Path(__file__).parent
DOI = "https://doi.org/10.1016/j.proeng.2015.10.119"
SECTIONS = {"claims": "Claims", "guarantees": "Guarantees", "tables": "Tables", "figures": "Figures", "mesh": "Mesh",
            "environment": "Environment"}
FIGURE_TITLES = {"fig1": "Figure 1: quality of the cells",
                 "fig2b": "Figure 2 (b): two active leaves and their rings",
                 "fig4a": "Figure 4 (a): speed-up and efficiency", "fig4b": "Figure 4 (b): time and elements per second"}
TABLE_TITLES = {"table1": "Table 1: weak scaling", "table2": "Table 2: visits by hops",
                "table3": "Table 3: memory levels", "cache": "Cache behaviour"}


def page(records, outcome, mesh=None, mesh_fault=""):
    """`mesh`: of viewer.pack; without one, `mesh_fault` says why."""
    parts = {"claims": _claims(outcome), "guarantees": _guarantees(records.frame), "tables": _tables(outcome),
             "figures": _figures(outcome), "mesh": _viewer(mesh, mesh_fault), "environment": _environment(records)}
    body = "\n".join(_section(name, title, parts[name]) for name, title in SECTIONS.items())
    links = " ".join(f'<a href="#{name}">{title}</a>' for name, title in SECTIONS.items())
    script = f"<script>{(HERE / 'viewer.js').read_text()}</script>" if mesh else ""
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>PODMark: results</title>
<link rel="icon" href="data:,">
<style>{(HERE / "page.css").read_text()}</style>
</head>
<body>
<header>
<h1>Parallel Delaunay image-to-mesh: results</h1>
<p>Beside the values of <a href="{DOI}">Feng, Tsolakis, Chernikov and Chrisochoides, IMR24, 2015</a>. Published,
measured and simulated values are never mixed; no mesh gives a number unless it verified. Machines differ, so shapes
are compared, not seconds.</p>
{_counts(records, outcome)}
<nav aria-label="Sections">{links}</nav>
</header>
<main>
{body}
</main>
{script}
</body>
</html>
"""


def _section(name, title, content):
    heading = f'<h2 id="{name}-title">{title}</h2>'
    return f'<section id="{name}" aria-labelledby="{name}-title">{heading}\n{content}\n</section>'


def _box(title, content):
    """A box that scrolls sideways where the page is narrower than its content."""
    return f'<div class="wide" tabindex="0" role="region" aria-label="{escape(title, quote=True)}">{content}</div>'


def table_html(table, title, row_classes=None):
    """A table in a box; a column `verdict` is marked, the first column heads its row."""
    head = "".join(f'<th scope="col">{escape(str(name))}</th>' for name in table.columns)
    lines = []
    for position, row in enumerate(table.itertuples(index=False)):
        cells = [_cell(name, value, is_first=at == 0) for at, (name, value) in enumerate(zip(table.columns, row))]
        kind = f' class="{row_classes[position]}"' if row_classes is not None else ""
        lines.append(f"<tr{kind}>{''.join(cells)}</tr>")
    rows = "\n".join(lines)
    return _box(title, f"<table><thead><tr>{head}</tr></thead>\n<tbody>{rows}</tbody></table>")


def _cell(name, value, is_first):
    if is_first:
        return f'<th scope="row">{escape(_text(value))}</th>'
    if name == "verdict":
        return f'<td><span class="verdict {escape(value)}">{escape(value.replace("_", " "))}</span></td>'
    text = _text(value)
    kind = ' class="words"' if len(text) > 30 else ' class="number"' if text[:1].isdigit() else ""
    return f"<td{kind}>{escape(text)}</td>"


def _text(value):
    if value is None or value is pandas.NA or value != value:
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _counts(records, outcome):
    verdicts = [one["verdict"] for one in outcome.verdicts["cells"] + outcome.verdicts["claims"]]
    frame = records.frame
    counts = [
        (len(frame), "trials recorded"),
        (int(frame["headline"].sum()) if len(frame) else 0, "of them verified and fit for numbers"),
        (verdicts.count("agrees") + verdicts.count("better"), "values and claims agree or are better"),
        (verdicts.count("differs"), "differ"),
        (verdicts.count("cannot_fill"), "cannot be filled, with the reason"),
    ]
    return '<ul class="counts">' + "".join(f"<li><b>{number}</b>{words}</li>" for number, words in counts) + "</ul>"


def _claims(outcome):
    claims, cells = readable_verdicts(outcome.verdicts)
    return (f"<p>What the paper finds, judged on our records by shape.</p>\n{table_html(claims, 'Claims')}\n"
            f"<details><summary>Every cell of Tables 1 and 2: {len(cells)} verdicts</summary>\n"
            f"{table_html(cells, 'Cells of Tables 1 and 2')}</details>")


def _guarantees(frame):
    """How many meshes each claim of podm-verify was decided for."""
    names = [name for name in frame.columns if name.startswith("verdicts.")]
    if not names:
        return "<p>No mesh was verified.</p>"
    lines = [{"claim": name.removeprefix("verdicts.").replace("_", " "),
              "verdict": "fail" if (frame[name] == "fail").any() else "pass" if (frame[name] == "pass").any() else "not_run",
              **{word.replace("_", " "): int((frame[name] == word).sum()) for word in ("pass", "fail", "not_run")}}
             for name in sorted(names)]
    return ("<p>Claims about meshes, decided exactly by <code>podm-verify</code> after the clock stopped: numbers of "
            "meshes.</p>\n" + table_html(pandas.DataFrame(lines), "Guarantees"))


def _tables(outcome):
    made = []
    for name, (data, shown) in outcome.tables.items():
        note = ""
        if "series" in data:
            series = escape("; ".join(data["series"].unique()))
            note = f'<p class="faint">{series}. In brackets: bootstrap 95 % interval.</p>'
        box = table_html(shown, TABLE_TITLES[name], list(shown["basis"]))
        made.append(f"<h3>{TABLE_TITLES[name]}</h3>\n{box}\n{note}")
    return "\n".join(made)


def _figures(outcome):
    made = []
    for name, figure in outcome.figures.items():
        title = FIGURE_TITLES[name]
        box = _box(title, _responsive(svg_of(figure, name), title))
        made.append(f"<figure><h3>{title}</h3>{box}<figcaption>{escape(figure.get_label())}</figcaption></figure>")
    for name, reason in outcome.missing.items():
        made.append(f'<p class="faint">{FIGURE_TITLES[name]}: not drawn, {escape(reason)}.</p>')
    return "\n".join(made)


def _responsive(svg, title):
    """The size comes from the page, the shape from the view box."""
    head, rest = svg.split(">", 1)
    kept = [part for part in head.replace("\n", " ").split(' ') if not part.startswith(("width=", "height="))]
    return f'{" ".join(kept)} role="img" aria-label="{title}">{rest}'


def _viewer(mesh, fault):
    if mesh is None:
        return f'<p class="faint">{escape(fault or "No mesh was given.")}</p>'
    data = json.dumps(mesh).replace("<", "\\u003c")
    return f"""<p>{mesh["cells"]:,} cells, cut open: those whose centres lie beyond the plane are left out. Drag to
turn; wheel, two fingers, + and - zoom; arrow keys turn too.</p>
<div id="viewer">
<canvas tabindex="0" role="img" aria-label="The mesh in three dimensions, cells coloured by label"></canvas>
<form>
<div class="line"><label for="axis">across</label><select id="axis" name="axis"><option value="0">x</option>
<option value="1" selected>y</option><option value="2">z</option></select></div>
<div class="line"><label for="cut">cut</label>
<input id="cut" name="cut" type="range" min="0" max="1" step="0.005" value="0.5"></div>
<fieldset><legend>labels</legend><div data-labels></div></fieldset>
</form>
<p data-fault role="status"></p>
</div>
<script type="application/json" id="mesh-data">{data}</script>"""


def _environment(records):
    frame = records.frame
    names = [name for name in frame.columns if name.startswith("environment.")]
    facts = {name.removeprefix("environment."): _distinct(frame[name]) for name in names}
    lines = "".join(f"<dt>{escape(name)}</dt><dd>{escape(value)}</dd>" for name, value in facts.items() if value)
    skipped = "".join(f"<li>{escape(problem)}</li>" for problem in records.problems)
    doubts = frame.loc[~frame["headline"], "doubt"].value_counts() if len(frame) else {}
    unverified = "".join(f"<li>{count} × {escape(doubt)}</li>" for doubt, count in doubts.items())
    return (f"<dl>{lines}</dl>" + (f"<h3>Rows that give no number</h3><ul>{unverified}</ul>" if unverified else "")
            + (f"<h3>Skipped</h3><ul>{skipped}</ul>" if skipped else ""))


def _distinct(column):
    """Values that rows give; of many, how many and the first."""
    values = list(dict.fromkeys(str(value) for value in column if _text(value)))
    return ", ".join(values) if len(values) <= 2 else f"{values[0]} ({len(values)} values)"
