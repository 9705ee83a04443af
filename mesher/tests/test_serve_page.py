"""The page of podm serve in a browser: from a dropped image to a mesh that turns and is downloaded; by keys alone."""

import pathlib
import sys
import time
import unittest
import zipfile

from podm_process import run_podm
from serving import ServeTestCase
from slow import slow

try:
    import vtk  # noqa: F401
    from browser import Browser, find_chromium
except ImportError:
    vtk = None

TIMEOUT_S = 60
TAB, ENTER, SPACE, RIGHT = ("Tab", 9), ("Enter", 13, "\r"), (" ", 32, " "), ("ArrowRight", 39)


def setUpModule():
    if vtk is None or find_chromium() is None:
        print("skipped: python3-vtk9 or chromium is not installed", file=sys.stderr)
        raise unittest.SkipTest("not installed")


class InBrowser(ServeTestCase):
    def setUp(self):
        super().setUp()
        self.image = self.folder / "spheres.nii.gz"
        self.assert_exit(run_podm("phantom", "spheres", "--size", "24", "-o", self.image), 0)
        self.browser = Browser()
        self.addCleanup(self.browser.close)

    def go(self, width=1400, scheme="light"):
        self.browser.go(self.server.address, width, scheme=scheme)
        self.wait_for("document.body.dataset.ready === 'yes'")

    def wait_for(self, expression):
        """Waits until the expression holds in the page."""
        end_s = time.monotonic() + TIMEOUT_S
        while not self.browser.evaluate(expression):
            if time.monotonic() > end_s:
                self.fail(f"{expression}; {self.browser.errors}; {self.browser.evaluate('document.body.innerText')}")
            time.sleep(0.1)

    def text(self, selector):
        return self.browser.evaluate(f"document.querySelector('{selector}').innerText")

    def click(self, selector):
        self.browser.evaluate(f"document.querySelector('{selector}').click()")

    def drop(self, *paths):
        self.browser.drop("#drop", *(paths or [self.image]))
        self.wait_for("!document.querySelector('#settings').hidden && document.querySelector('#slices').dataset.drawn")

    def mesh(self):
        self.click("#run")
        self.wait_for_claims()

    def wait_for_claims(self):
        self.wait_for("document.querySelectorAll('.findings .verdict').length > 0")
        self.wait_for("document.querySelector('#viewer canvas')?.checkVisibility()")

    def test_from_drop_to_turning_mesh_to_download(self):
        self.go()
        self.drop()
        self.assertIn("spheres.nii.gz: 24 × 17 × 17 voxels", self.text("#image-status"))
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('#labels tbody tr').length"), 3)
        before = self.browser.screenshot("#slices canvas")
        self.click("#labels tbody tr:nth-child(2) input[type=checkbox]")
        self.wait_for("document.querySelector('#command').innerText.includes('--labels 1,3 ')")
        self.assertNotEqual(before, self.browser.screenshot("#slices canvas"))
        self.click("#tick-all")
        self.wait_for("document.querySelector('#prediction dl').innerText.includes('about')")
        self.mesh()
        self.assertRegex(self.text("#mesh-status"), r"[\d,]+ cells")
        self.assertRegex(self.text("#claims [role=status]"), r"podm-verify has proved (\d+) of \1 claims")
        self.assertEqual(self.text("[data-fault]"), "")
        whole = self.browser.screenshot("#viewer canvas")
        self.browser.evaluate("document.querySelector('#viewer canvas').focus()")
        self.browser.press(*RIGHT)
        turned = self.browser.screenshot("#viewer canvas")
        self.assertNotEqual(whole, turned)
        self.browser.evaluate("""(() => { const cut = document.querySelector('#cut'); cut.value = 0.2;
            cut.dispatchEvent(new Event('input')); return new Promise(done => setTimeout(done, 500)); })()""")
        self.assertNotEqual(turned, self.browser.screenshot("#viewer canvas"))
        self.browser.save_downloads_in(self.folder)
        self.click("#download-link")
        path = self.folder / "spheres.vtu.zip"
        self.assertTrue(self.exists(path))
        with zipfile.ZipFile(path) as packed:
            self.assertEqual(packed.namelist(), ["spheres.vtu", "spheres_facets.vtu"])
        self.assertEqual(self.browser.errors, [])

    def exists(self, path):
        end_s = time.monotonic() + 10
        while not path.exists() and time.monotonic() < end_s:
            time.sleep(0.1)
        return path.exists()

    @slow
    def test_labels_of_one_name_become_one(self):
        self.go()
        self.drop()
        self.browser.evaluate("""for (const name of document.querySelectorAll('#labels input[type=text]')) {
            name.value = 'both'; name.dispatchEvent(new Event('change')); }""")
        self.wait_for("document.querySelector('#command').innerText.includes('--merge 1,2,3=both')")
        self.mesh()
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('[data-labels] label').length"), 1)
        self.assertIn("both", self.text("[data-labels]"))

    @slow
    def test_another_mesh_and_another_image_replace_the_first(self):
        self.go()
        self.drop()
        self.mesh()
        first = self.text("#mesh-status")
        self.browser.evaluate("""(() => { const one = document.querySelector('.slider input[type=number]');
            one.value *= 0.8; one.dispatchEvent(new Event('change')); })()""")
        self.click("#run")
        self.wait_for(f"document.querySelector('#mesh-status').innerText.includes('vertices') &&"
                      f"document.querySelector('#mesh-status').innerText !== {first!r}")
        self.wait_for("document.querySelectorAll('.findings .verdict').length > 0")
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('#viewer').length"), 1)
        other = self.folder / "torus.nii"
        self.assert_exit(run_podm("phantom", "torus", "--size", "20", "-o", other), 0)
        self.drop(other)
        self.wait_for("document.querySelector('#image-status').innerText.includes('torus.nii')")
        self.assertTrue(self.browser.evaluate("document.querySelector('#turned').hidden"))
        self.assertEqual([path.name for path in self.server.files() if "spheres" in path.name], [])
        self.assertEqual(self.browser.errors, [])

    def test_faults_are_one_sentence(self):
        bad = self.folder / "bad.nii"
        bad.write_bytes(b"no image")
        self.go()
        for path, words in ((bad, "bad.nii: "), (pathlib.Path(__file__), "not an image that podm reads")):
            self.browser.drop("#drop", path)
            self.wait_for(f"document.querySelector('#fault').innerText.includes({words!r})")
            self.assertEqual(self.text("#image-status"), "")
        self.drop()
        self.assertTrue(self.browser.evaluate("document.querySelector('#fault').hidden"))
        self.click("#tick-none")
        self.wait_for("document.querySelector('#fault').innerText.includes('No label is ticked')")

    @slow
    def test_a_tab_that_is_closed_takes_its_data_along(self):
        self.go()
        self.drop()
        self.assertGreater(len(self.server.files()), 0)
        self.browser.go("about:blank", 1400)
        end_s = time.monotonic() + 10
        while self.server.files() and time.monotonic() < end_s:
            time.sleep(0.1)
        self.assertEqual(self.server.files(), [])

    def focus(self):
        return self.browser.evaluate("(document.activeElement.id || document.activeElement.getAttribute('aria-label')"
                                     " || document.activeElement.type || document.activeElement.tagName)")

    def tab_to(self, name):
        """Presses Tab until the element is in focus; returns all names on the way."""
        way = []
        while self.focus() != name:
            self.browser.press(*TAB)
            way.append(self.focus())
            self.assertLess(len(way), 100, way)
        return way

    def test_keys_alone_do_all_of_it(self):
        self.go()
        self.tab_to("files")
        self.browser.choose("#files", self.image)  # the dialogue is the system's
        self.wait_for("!document.querySelector('#settings').hidden && document.querySelector('#slices').dataset.drawn")
        way = self.tab_to("place-k")
        before = self.browser.screenshot("#slices canvas")
        self.browser.press(*RIGHT)
        self.wait_for("document.querySelector('#place-k').value === '9'")
        self.assertNotEqual(before, self.browser.screenshot("#slices canvas"))
        way += self.tab_to("radius, mm")
        self.browser.evaluate("document.activeElement.select()")
        for digit in "30":
            self.browser.press(digit, ord(digit), digit)
        way += self.tab_to("run")
        # The server composes the command after each change.
        self.wait_for("document.querySelector('#command').textContent.includes('--radius 30 ')")
        self.browser.press(*ENTER)
        self.wait_for_claims()
        way += self.tab_to("The mesh in three dimensions, cells coloured by label")
        before = self.browser.screenshot("#viewer canvas")
        self.browser.press(*RIGHT)
        self.assertNotEqual(before, self.browser.screenshot("#viewer canvas"))
        way += self.tab_to("cut")
        self.browser.press(*RIGHT)
        way += self.tab_to("download-link")
        self.browser.save_downloads_in(self.folder)
        self.browser.press(*ENTER)
        self.assertTrue(self.exists(self.folder / "spheres.vtu.zip"))
        for name in ("Name of label 1", "tick-all", "radius, slider", "format"):
            self.assertIn(name, way)
        self.assertNotIn("BODY", way)  # no trap, nothing without a name
        self.assertEqual(self.browser.errors, [])

    @slow
    def test_every_control_has_a_name_and_nothing_overflows(self):
        for width, scheme in ((1400, "light"), (1400, "dark"), (400, "light"), (400, "dark")):
            with self.subTest(width=width, scheme=scheme):
                self.go(width, scheme)
                self.drop()
                self.mesh()
                self.assertEqual(self.browser.evaluate("document.documentElement.scrollWidth"), width)
                self.assertEqual(self.browser.evaluate("""[...document.querySelectorAll(
                    'input, select, button, a, canvas, pre, progress, [tabindex]')].filter(one => one.checkVisibility()
                    && !(one.getAttribute('aria-label') || one.labels?.length || one.innerText?.trim()))
                    .map(one => one.outerHTML)"""), [])
                self.assertEqual(self.browser.evaluate("""[...document.querySelectorAll('main *')].filter(one =>
                    one.checkVisibility() && !one.closest('.wide, .lost, [data-labels]') &&
                    one.getBoundingClientRect().right > innerWidth + 0.5).map(one => one.outerHTML)"""), [])
                self.assertGreater(self.least_contrast(), 4.5)
                self.assertEqual(self.browser.errors, [])

    def least_contrast(self):
        """Returns the least contrast of a visible text and its ground, as WCAG defines it."""
        return self.browser.evaluate("""(() => {
            const rgb = (text) => text.match(/[\\d.]+/g).map(Number);
            const light = ([r, g, b]) => [r, g, b].map((v) => v / 255)
                .map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
                .reduce((sum, v, at) => sum + v * [0.2126, 0.7152, 0.0722][at], 0);
            const ground = (one) => { for (; one; one = one.parentElement) {
                const colour = rgb(getComputedStyle(one).backgroundColor);
                if (colour.length === 3 || colour[3] > 0) return colour; } return [255, 255, 255]; };
            return Math.min(...[...document.querySelectorAll('main *, header *')].filter((one) => one.checkVisibility()
                && !one.disabled && !one.closest('.old') && [...one.childNodes].some((node) => node.nodeType === 3
                && node.textContent.trim())).map((one) => {
                    const [a, b] = [light(rgb(getComputedStyle(one).color)), light(ground(one))];
                    return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05); })); })()""")


if __name__ == "__main__":
    unittest.main()
