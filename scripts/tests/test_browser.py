"""Tests the page of scripts/report in a browser."""
import io
import sys
import tempfile
import unittest
from pathlib import Path

import matplotlib.image
import numpy
from browser import Browser, find_chromium
from test_programs import make_page


class InBrowser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if find_chromium() is None:
            print("skipped: chromium is not installed", file=sys.stderr)
            raise unittest.SkipTest("not installed")
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = make_page(Path(folder.name))
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    def test_loads_without_errors_and_fits(self):
        for width, scheme in ((1400, "light"), (1400, "dark"), (400, "light"), (400, "dark"), (320, "light")):
            with self.subTest(width=width, scheme=scheme):
                self.browser.open(self.path, width, scheme=scheme)
                self.assertEqual(self.browser.errors, [])
                self.assertEqual(self.browser.evaluate("document.documentElement.scrollWidth"), width)
                self.assertEqual(self.browser.evaluate("document.querySelector('[data-fault]').textContent"), "")
                self.check_answers()
                self.assertGreater(self.colours_on_canvas(), 10)

    def check_answers(self):
        """Checks that all four answers are visible, none wider than its card or the page, with bars as long as their
        numbers."""
        overflowing = self.browser.evaluate("""[...document.querySelectorAll('.answer, .answer *')].filter(one =>
            one.checkVisibility() && one.getBoundingClientRect().right > one.closest('.answer')
            .getBoundingClientRect().right + 0.5).map(one => one.outerHTML)""")
        self.assertEqual(overflowing, [])
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('.answer h2').length"), 4)
        longest = self.browser.evaluate("""[...document.querySelectorAll('.bars')].map(one => Math.max(
            ...[...one.querySelectorAll('.track i')].map(bar => bar.clientWidth / bar.parentElement.clientWidth)))""")
        self.assertEqual(len(longest), 3)
        self.assertTrue(all(0.7 < one <= 1.01 for one in longest), longest)

    def test_the_cut_and_the_labels_change_the_picture(self):
        self.browser.open(self.path, 1280)
        whole = self.browser.screenshot("canvas")
        self.set("[name=cut]", "value", 0.2)
        cut = self.browser.screenshot("canvas")
        self.assertNotEqual(whole, cut)
        for box in range(2):
            self.browser.evaluate(f"document.querySelectorAll('[data-labels] input')[{box}].click()")
        self.assertLess(self.colours_on_canvas(), 10)  # no label, no cells

    def set(self, selector, name, value):
        self.browser.evaluate(f"""(() => {{ const one = document.querySelector('{selector}'); one.{name} = {value};
            one.dispatchEvent(new Event('input')); return new Promise(done => setTimeout(done, 500)); }})()""")

    def colours_on_canvas(self):
        """Returns the number of colours inside the canvas's border."""
        self.browser.evaluate("new Promise(done => setTimeout(done, 500))")
        picture = matplotlib.image.imread(io.BytesIO(self.browser.screenshot("canvas")))
        return len(numpy.unique(picture[20:-20, 20:-20].reshape(-1, picture.shape[2]), axis=0))


if __name__ == "__main__":
    unittest.main()
