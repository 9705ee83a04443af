"""Writes figures, and tables as Markdown."""
import io
import re
import textwrap

import matplotlib
import pandas

from . import style
from .whole_file import write_whole


def write_figure(figure, folder, name):
    """Writes NAME.pdf and NAME.png, the PNG on white, with the caption below."""
    figure.supxlabel(textwrap.fill(figure.get_label(), 150), fontsize=7, color=style.INK)
    figure.get_layout_engine().set(h_pad=0.1)
    for suffix, options in (("pdf", {"metadata": {"CreationDate": None}}), ("png", {"dpi": 160, "facecolor": "white"})):
        made = io.BytesIO()
        figure.savefig(made, format=suffix, **options)
        write_whole(folder / f"{name}.{suffix}", made.getvalue())


def svg_of(figure, name):
    """Returns inline SVG whose ink is the page's text colour. Ids start with `name`, so that figures can share a
    page."""
    made = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": name}):
        figure.savefig(made, format="svg", metadata={"Date": None})
    text = made.getvalue()
    text = text[text.index("<svg") :].replace(style.INK, "currentColor")
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r"url\(#", f"url(#{name}-", text)
    return re.sub(r'href="#', f'href="#{name}-', text)


def markdown(table):
    """Returns a pandas table, without its index, as Markdown."""
    lines = [list(map(str, table.columns)), ["---"] * len(table.columns)]
    lines += [[_plain(value) for value in row] for row in table.itertuples(index=False)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def _plain(value):
    if pandas.isna(value):
        return ""
    return f"{value:.4g}" if isinstance(value, float) else str(value).replace("|", "\\|")
