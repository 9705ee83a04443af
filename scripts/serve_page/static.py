"""The files of the page, which are read once. No path of a request reaches the file system."""
from pathlib import Path

from report_page import viewer

HERE = Path(__file__).parent
TYPES = {".html": "text/html; charset=utf-8", ".css": "text/css; charset=utf-8",
         ".js": "text/javascript; charset=utf-8"}
# NiiVue makes images and fonts of data that it carries.
POLICY = ("default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
          "connect-src 'self' data:; form-action 'none'; base-uri 'none'; frame-ancestors 'none'")


def _read():
    paths = [*sorted((HERE / "page").iterdir()), HERE / "niivue" / "niivue.min.js",
             viewer.SCRIPT.with_name("page.css"), viewer.SCRIPT]
    return {path.name: (TYPES[path.suffix], path.read_bytes()) for path in paths}


FILES = _read()
START = (FILES.pop("index.html")[1].replace(b"<!-- viewer -->", viewer.FRAME.encode())
         .replace(b"<!-- help -->", viewer.HELP.encode()))
