"""The limits of the simulation, taken from results/README.md. They are shown before any number."""
import re
from html import escape
from pathlib import Path

README = Path(__file__).resolve().parents[2] / "results" / "README.md"
HEADING = "### Limits of the model"


def limits():
    """Returns the paragraphs and lists below the heading, as HTML."""
    section = README.read_text(encoding="utf-8").partition(HEADING)[2]
    section = re.split(r"^#+ ", section, maxsplit=1, flags=re.MULTILINE)[0]
    return "<h3>Limits of the model</h3>\n" + "\n".join(map(_html, re.split(r"\n\n+", section.strip())))


def _html(block):
    """Returns a paragraph, or a list; each line of a list begins an item or continues it."""
    if not block.startswith("- "):
        return f"<p>{_inline(block)}</p>"
    items = "".join(f"<li>{_inline(item)}</li>" for item in re.split(r"^- ", block, flags=re.MULTILINE)[1:])
    return f"<ul>{items}</ul>"


def _inline(text):
    """Keeps only the text of links, because their targets are relative to the README."""
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", " ".join(text.split()))
    text = re.sub(r"\*\*([^*]+)\*\*", r"<strong>\1</strong>", escape(text))
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
