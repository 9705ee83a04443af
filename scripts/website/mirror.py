"""The Markdown pages of the tree as the site has them: at the same paths, so that links between them stay as they are.

Comments are left out, a link to a folder goes to its README.md or becomes plain words, and files that pages link to
lie beside them.
"""
import re
import shutil

from .links import CODE, LINK, without_code

WHOLE_LINK = re.compile(r"(?<!!)\[([^]]*)\]\(([^)\s]+)\)")
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)


def page_of(root, path):
    """(the text of the page, files that it links to)."""
    text, files = path.read_text(encoding="utf-8"), []
    for found in reversed(list(WHOLE_LINK.finditer(without_code(text)))):
        target = (path.parent / found[2].partition("#")[0]).resolve()
        if target.is_dir() and "#" not in found[2]:
            words = text[found.start(1):found.end(1)]
            new = f"[{words}]({found[2].rstrip('/')}/README.md)" if (target / "README.md").exists() else words
            text = text[:found.start()] + new + text[found.end():]
    for found in LINK.finditer(without_code(text)):
        target = (path.parent / found[1].partition("#")[0]).resolve()
        if target.is_file() and target.is_relative_to(root) and target.suffix != ".md":
            files.append(target)
    return _without_comments(text), files


def _without_comments(text):
    """Comments within code stay."""
    is_code = [False] * len(text)
    for pattern in CODE[:3]:
        for found in pattern.finditer(text):
            is_code[found.start():found.end()] = [True] * (found.end() - found.start())
    return COMMENT.sub(lambda found: found[0] if is_code[found.start()] else "", text)


def mirror(root, pages, folder):
    """Writes the pages and what they link to into the folder."""
    files = set()
    for path in pages:
        text, linked = page_of(root, path)
        target = folder / path.relative_to(root)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
        files.update(linked)
    for path in files:
        target = folder / path.relative_to(root)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
