"""Checks links between Markdown pages: files, headings and pictures."""
import re

LINK = re.compile(r"\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
CODE = [re.compile(r"^ {0,3}(```|~~~).*?^ {0,3}\1[^\n]*$", re.MULTILINE | re.DOTALL),
        re.compile(r"(?<=\n\n)(?: {4}[^\n]*\n+)+"),
        re.compile(r"(`+)(?!`).*?(?<!`)\1(?!`)", re.DOTALL), re.compile(r"<!--.*?-->", re.DOTALL)]
HEADING = re.compile(r"^(#{1,6}) +(.+?) *#*$", re.MULTILINE)
ELSEWHERE = ("http:", "https:", "mailto:", "data:")


def without_code(text):
    """The text with blanks in place of code and comments; lines stay where they are."""
    for pattern in CODE:
        text = pattern.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)
    return text


def links_of(text):
    """(place, target) of each link and picture that is not on another machine."""
    return [(found.start(1), found[1]) for found in LINK.finditer(without_code(text))
            if not found[1].startswith(ELSEWHERE)]


def slug(heading):
    """The anchor of a heading, as GitHub and the site make it."""
    heading = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def anchors_of(text):
    seen, anchors = {}, set()
    fenced = CODE[0].sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)
    for found in HEADING.finditer(fenced):
        name = slug(found[2])
        count = seen[name] = seen.get(name, -1) + 1
        anchors.add(name if count == 0 else f"{name}-{count}")
    return anchors


def faults_of_links(root, pages):
    """"file:line: words" for each link of the pages whose file or heading is not there."""
    faults = []
    for path in pages:
        text = path.read_text(encoding="utf-8")
        for place, target in links_of(text):
            if fault := _fault(root, path, target):
                faults.append(f"{path.relative_to(root)}:{text.count(chr(10), 0, place) + 1}: {target}: {fault}")
    return faults


def _fault(root, path, target):
    name, _, anchor = target.partition("#")
    file = (path.parent / name).resolve() if name else path.resolve()
    if not file.is_relative_to(root.resolve()):
        return "it leaves the tree"
    if not file.exists():
        return "no such file"
    if anchor and (file.suffix != ".md" or anchor not in anchors_of(file.read_text(encoding="utf-8"))):
        return "no such heading"
    return None
