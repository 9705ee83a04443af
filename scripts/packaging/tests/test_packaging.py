"""The version and the metadata of the packages have one place, and make_wheel refuses what would not run elsewhere."""
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import unittest
from pathlib import Path

PACKAGING = Path(__file__).resolve().parents[1]
ROOT = PACKAGING.parents[1]
BUILD = Path(os.environ.get("PODM_BUILD", ROOT / "build"))
sys.path[:0] = [str(PACKAGING)]

from podm_wheel import binary, linker, wheel  # noqa: E402
from podm_wheel.__main__ import PROGRAMS  # noqa: E402
from podm_wheel.build_tree import BuildTree  # noqa: E402

VERSION = re.search(r"^project\(podm VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)[1]


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


class Version(InFolder):
    def test_all_places_have_that_of_cmake(self):
        self.assertIn(f"\nversion: {VERSION}\n", (ROOT / "CITATION.cff").read_text())
        newest = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[1]
        self.assertEqual(newest.rstrip(","), VERSION)
        self.assertEqual(BuildTree(BUILD).version(), VERSION)

    def test_the_metadata_have_it_and_name_the_licence(self):
        info = wheel.metadata(ROOT, self.folder)
        self.assertEqual(info.name, f"podmark-{VERSION}.dist-info")
        self.assertEqual(list(self.folder.iterdir()), [info])
        text = (info / "METADATA").read_text()
        self.assertIn(f"\nName: podmark\nVersion: {VERSION}\n", text)
        self.assertIn("\nLicense: BSD-3-Clause\n", text)
        self.assertIn("\nRequires-Dist: numpy\n", text)


class Sources(InFolder):
    def test_the_archive_has_what_pip_needs(self):
        done = subprocess.run([PACKAGING / "make_sdist", "--output", self.folder], capture_output=True, text=True)
        if "not a git repository" in done.stderr:
            self.skipTest("skipped: not a git checkout")
        self.assertEqual(done.returncode, 0, done.stderr)
        with tarfile.open(self.folder / f"podmark-{VERSION}.tar.gz") as archive:
            names = {name.removeprefix(f"podmark-{VERSION}/") for name in archive.getnames()}
        self.assertLessEqual({"PKG-INFO", "setup.py", "pyproject.toml", "CMakeLists.txt", "LICENSE", "mesher/main.cpp",
                              "verifiers/main.cpp", "scripts/view", "mesher/python/podm/__init__.py"}, names)
        self.assertFalse([name for name in names if name.startswith(("results/", "build"))])


class Binaries(unittest.TestCase):
    def test_a_program_that_needs_packages_is_refused(self):
        program = BUILD / "bin/podm"
        self.assertTrue(any("ITK" in name for name in binary.needed(program)))
        with self.assertRaisesRegex(binary.Unportable, "libITK"):
            binary.check(program)

    def test_each_library_of_the_programs_is_linked_into_the_wheel(self):
        made = (PACKAGING / "libraries").read_text()
        needed = set().union(*(binary.needed(BUILD / "bin" / program) for program in PROGRAMS))
        for name in needed - binary.OF_THE_SYSTEM - {"libstdc++.so.6", "libgcc_s.so.1"}:
            stem = "insighttoolkit" if "itk" in name.lower() else re.match("lib([a-z]+)", name)[1]
            is_made = re.search(f"^(enter|archive|download|for library in|unpack) .*{stem}", made, re.MULTILINE)
            self.assertTrue(is_made or any(one.startswith(f"lib{stem}") for one in linker.OF_DEBIAN), name)

    def test_a_path_outside_the_wheel_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            source, program = Path(folder, "a.c"), Path(folder, "a")
            source.write_text("int main(void) { return 0; }\n")
            for path, is_refused in (("$ORIGIN/../libs", False), ("/opt/lib", True)):
                subprocess.run(["gcc", source, "-o", program, f"-Wl,-rpath,{path}"], check=True)
                if is_refused:
                    self.assertRaisesRegex(binary.Unportable, path, binary.check, program)
                else:
                    binary.check(program)

    def test_a_symbol_that_no_library_defines_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            source, beside, module = (Path(folder, name) for name in ("a.c", "libbeside.so", "module.so"))

            def link(text, output, *libraries):
                source.write_text(text)
                subprocess.run(["gcc", "-shared", "-fPIC", source, "-o", output, *libraries, "-Wl,-rpath,$ORIGIN",
                                f"-Wl,-soname,{output.name}"], check=True)

            link("int beside(void) { return 0; }\n", beside)
            calls = "int beside(void), PyErr_Occurred(void), puts(const char*), nowhere(void);\nint f(void) { return "
            link(calls + 'puts("") + beside() + PyErr_Occurred(); }\n', module, beside)
            binary.check(module)
            link(calls + "beside() + nowhere(); }\n", module, beside)
            self.assertRaisesRegex(binary.Unportable, "no library defines nowhere$", binary.check, module)

    def test_the_parts_of_a_program_are_those_of_the_project(self):
        parts = BuildTree(BUILD).parts_of("bin/podm-verify")
        self.assertTrue(parts)
        for part in parts:
            self.assertTrue(part.is_file(), part)
            self.assertIn(BUILD, part.parents)
        self.assertIn("libpodm_verify_claims.a", {part.name for part in parts})

    def test_the_commands_of_the_module_compile_its_sources(self):
        commands = BuildTree(BUILD).compile_commands("podm_python.dir")
        self.assertTrue(commands)
        for command in commands:
            self.assertIn("-c", command)
            self.assertNotIn("-o", command)
            self.assertTrue(Path(command[command.index("-c") + 1]).is_file(), command)

    @unittest.skipUnless(shutil.which("patchelf"), "patchelf is not installed")
    def test_bundled_libraries_have_names_of_their_own_and_find_each_other(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch)
            (folder / "bundled").mkdir()
            for source, options in (("gmp", []), ("mpfr", ["bundled/libgmp.so"])):
                subprocess.run(["cc", "-shared", "-fPIC", "-x", "c", "-", "-x", "none", "-Wl,--no-as-needed", *options,
                                f"-Wl,-soname,lib{source}.so.9", "-o", f"bundled/lib{source}.so"], check=True,
                               input=f"int {source}(void) {{ return 1; }}", text=True, cwd=folder)
            bundled = linker.Linker(folder, folder / "libs").bundled
            self.assertEqual([path.name for path in bundled], ["libgmp-podmark.so", "libmpfr-podmark.so"])
            for path in bundled:
                self.assertEqual(binary.soname(path), path.name)
                self.assertEqual(binary.search_path(path), ["$ORIGIN"])
            self.assertIn("libgmp-podmark.so", binary.needed(bundled[1]))


if __name__ == "__main__":
    unittest.main()
