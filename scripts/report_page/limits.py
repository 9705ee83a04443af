"""The limits of the simulation, as results/README.md states them: told in one place, shown before any number."""
import re
from html import escape
from pathlib import Path

README = Path(__file__).resolve().parents[2] / "results" / "README.md"
HEADING = "### Limits of the model"


def limits():
    """Paragraphs and lists below the heading, as HTML."""
    section = README.read_text(encoding="utf-8").partition(HEADING)[2]
    section = re.split(r"^#+ ", section, maxsplit=1, flags=re.MULTILINE)[0]
    return "<h3>Limits of the model</h3>\n" + "\n".join(map(_html, re.split(r"\n\n+", section.strip())))


def _html(block):
    """A paragraph, or a list where each line begins one of its items or goes on with it."""
    if not block.startswith("- "):
        return f"<p>{_inline(block)}</p>"
    items = "".join(f"<li>{_inline(item)}</li>" for item in re.split(r"^- ", block, flags=re.MULTILINE)[1:])
    return f"<ul>{items}</ul>"


def _inline(text):
    """Links keep their words alone: what they point to lies beside the README, not beside the page."""
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", " ".join(text.split()))
    text = re.sub(r"\*\*([^*]+)\*\*", r"<strong>\1</strong>", escape(text))
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", text)
