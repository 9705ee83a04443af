"""The site that `make docs` builds: it is whole, needs no network, and its search answers."""
import http.server
import os
import shutil
import sys
import tempfile
import threading
import unittest
from functools import partial
from pathlib import Path

import paths
from browser import Browser, find_chromium
from website.__main__ import main as make_docs
from website.network import remote_references

BUILD = Path(os.environ.get("PODM_BUILD", paths.SCRIPTS.parent / "build"))
PAGES = ("index.html", "docs/guides/slivers.html", "docs/concepts/parallel.html", "docs/reference/options_podm.html")


class QuietHandler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *arguments):
        pass


class Address:
    """A page of the local server, for Browser.open()."""

    def __init__(self, text):
        self.text = text

    def resolve(self):
        return self

    def as_uri(self):
        return self.text


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        missing = [tool for tool in ("mkdocs", "doxygen") if shutil.which(tool) is None]
        if missing:
            print(f"skipped: {', '.join(missing)} not installed", file=sys.stderr)
            raise unittest.SkipTest("not installed")
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.site = Path(folder.name) / "site"
        code = make_docs(["--programs", str(BUILD / "bin"), "--output", folder.name])
        assert code == 0, code

    def test_pages_of_all_kinds_are_there(self):
        for name in (*PAGES, "CONTRIBUTING.html", "docs/reference/python_api.html", "cpp/index.html",
                     "docs/reference/schema_podm-verify.html", "results/index.html", "search/search_index.json"):
            self.assertTrue((self.site / name).exists(), name)

    def test_nothing_comes_from_a_network(self):
        self.assertEqual(remote_references(self.site), [])

    def test_no_hidden_comment_is_left(self):
        self.assertNotIn("not measured", (self.site / "docs/guides/slivers.html").read_text())

    def test_a_browser_shows_the_pages_and_searches_them(self):
        if find_chromium() is None:
            self.skipTest("chromium is not installed")
        handler = partial(QuietHandler, directory=self.site)
        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            browser = Browser()
            self.addCleanup(browser.close)
            base = f"http://127.0.0.1:{server.server_port}/"
            for name in PAGES:
                for width, scheme in ((1400, "light"), (400, "dark")):
                    with self.subTest(name=name, width=width):
                        browser.open(Address(base + name), width, scheme=scheme)
                        self.assertEqual(browser.errors, [])
                        self.assertLessEqual(browser.evaluate("document.documentElement.scrollWidth"), width)
            self.assertIn("sliver", self._search(browser, base, "sliver").lower())
            server.shutdown()

    def _search(self, browser, base, word):
        """The words that the search shows."""
        browser.open(Address(f"{base}index.html?q={word}"), 1400)
        return browser.evaluate("""new Promise(done => { let tries = 0; const look = () => {
            const items = document.querySelectorAll('.md-search-result__item');
            if (items.length || ++tries > 50) done([...items].map(one => one.textContent).join(' '));
            else setTimeout(look, 200); }; look(); })""")


class RemoteReferences(unittest.TestCase):
    def test_what_would_be_fetched_is_found_and_links_are_not(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "a.html").write_text(
                '<a href="https://example.org">x</a><link rel="canonical" href="https://example.org">'
                '<script src="https://cdn.org/a.js"></script><link rel="stylesheet" href="//cdn.org/b.css">'
                '<style>@import "https://cdn.org/c.css";</style><p style="background: url(https://cdn.org/d.png)">')
            (folder / "e.css").write_text("@font-face { src: url('https://cdn.org/e.woff2'); } a { b: url(a.png); }")
            found = [address.rpartition("/")[2] for _, address in remote_references(folder)]
            self.assertEqual(found, ["a.js", "b.css", "c.css", "d.png", "e.woff2"])


if __name__ == "__main__":
    unittest.main()
