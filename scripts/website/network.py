"""References of a built site that a browser would fetch from another machine: scripts, styles, fonts and pictures."""
import re
from html.parser import HTMLParser

FETCHED = {"script": ("src",), "link": ("href",), "img": ("src", "srcset"), "iframe": ("src",),
           "source": ("src", "srcset"), "object": ("data",), "video": ("src",), "audio": ("src",)}
KEPT_LINKS = ("canonical", "next", "prev")  # for robots and readers: not fetched
IN_STYLE = re.compile(r"""(?:@import\s+|url\(\s*)["']?((?:https?:)?//[^"')\s]+)""")


class _Reader(HTMLParser):
    def __init__(self):
        super().__init__()
        self.found, self._is_style = [], False

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self._is_style = tag == "style"
        if tag == "link" and values.get("rel") in KEPT_LINKS:
            return
        addresses = [values.get(name) or "" for name in FETCHED.get(tag, ())]
        self.found += [one for one in addresses if re.match("(https?:)?//", one)]
        self.found += IN_STYLE.findall(values.get("style") or "")

    def handle_data(self, data):
        if self._is_style:
            self.found += IN_STYLE.findall(data)


def remote_references(folder):
    """(file, address) of each, below the folder."""
    found = []
    for path in sorted(folder.rglob("*")):
        if path.suffix == ".html":
            reader = _Reader()
            reader.feed(path.read_text(encoding="utf-8", errors="replace"))
            found += [(path.relative_to(folder), one) for one in reader.found]
        elif path.suffix == ".css":
            text = path.read_text(encoding="utf-8", errors="replace")
            found += [(path.relative_to(folder), one) for one in IN_STYLE.findall(text)]
    return found
