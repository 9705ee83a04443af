"""podm serve: who is answered, what is taken, and that nothing stays behind."""

import hashlib
import io
import json
import os
import pathlib
import shlex
import signal
import socket
import subprocess
import sys
import threading
import time
import types
import unittest
import unittest.mock
import zipfile

from podm_process import PROGRAM, PodmTestCase, run_podm
from serving import Page, Server, ServeTestCase, settings
from slow import slow
from small_images import ball_voxels, write_metaimage, write_nifti

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))

from serve_page.child import Child, Limits as LimitsOfChild  # noqa: E402
from serve_page.faults import Fault  # noqa: E402
from serve_page.picture import MOST_CELLS, mesh_parts  # noqa: E402
from serve_page.scratch import Scratch  # noqa: E402
from serve_page.workspace import Workspace  # noqa: E402

VTK = pathlib.Path("/usr/lib/python3/dist-packages/vtkmodules")
SECONDS_UNSEEN = 8  # of serve_page/server.py, and some more
BALL, COARSE, LONG = settings(radius=4), settings(radius=30), settings(radius=0.8)  # a LONG run takes many seconds


def setUpModule():
    if not VTK.exists():
        print("skipped: python3-vtk9 is not installed", file=sys.stderr)
        raise unittest.SkipTest("not installed")


def wait_until(holds, timeout_s=60):
    end_s = time.monotonic() + timeout_s
    while not holds():
        if time.monotonic() > end_s:
            return False
        time.sleep(0.05)
    return True


class Secret(ServeTestCase):
    def test_nothing_is_answered_without_the_token(self):
        token = self.server.token
        page = Page(self.server)
        answers = set()
        for path in ("/", "", "/page.css", "/main.js", "/pages/new", f"/pages/{page.name}/events", "/../", "//",
                     f"/{token[:-1]}/", f"/{token}x/", f"/{token.lower()}/", f"/x/{token}/", f"/./{token}/",
                     f"/?{token}", "/%2e%2e/" + token, "*", f"http://{self.server.host}/"):
            for method in ("GET", "POST", "PUT", "HEAD", "DELETE", "OPTIONS", "BREW"):
                with self.subTest(path=path, method=method):
                    response = self.server.ask(method, path or "/", b"" if method == "PUT" else None)
                    self.assertEqual(response.status, 403)
                    answers.add((method == "HEAD", response.content))
        self.assertEqual(len(answers), 2)
        self.assertEqual(self.server.ask("GET", f"/{token}/").status, 200)

    def test_other_hosts_and_origins_are_refused(self):
        path = f"/{self.server.token}/"
        for host in ("evil.example", f"evil.example:{self.server.port}", "127.0.0.1", f"127.0.0.2:{self.server.port}",
                     f"127.0.0.1.evil.example:{self.server.port}", "", None):
            with self.subTest(host=host):
                self.assertEqual(self.server.ask("GET", path, Host=host).status, 403)
        for origin in ("http://evil.example", "null", f"https://{self.server.host}",
                       f"http://localhost:{self.server.port}", f"http://{self.server.host}.evil.example"):
            with self.subTest(origin=origin):
                self.assertEqual(self.server.ask("POST", f"{path}pages/new", b"", Origin=origin).status, 403)
        own = self.server.ask("POST", f"{path}pages/new", b"", Origin=f"http://{self.server.host}")
        self.assertEqual(own.status, 200)
        self.assertEqual(self.server.ask("GET", path, Host=f"localhost:{self.server.port}").status, 200)
        two_hosts = f"GET {path} HTTP/1.1\r\nHost: {self.server.host}\r\nHost: evil.example\r\n\r\n"
        self.assertIn(b" 403 ", self.server.raw(two_hosts.encode()).split(b"\r\n")[0])

    def test_only_this_machine_is_listened_to(self):
        for address in ("127.0.0.2", *own_addresses()):
            with self.assertRaises(OSError), socket.create_connection((address, self.server.port), timeout=5):
                pass

    def test_each_server_has_its_own_long_token_and_no_answer_may_be_kept_or_framed(self):
        self.assertGreaterEqual(len(self.server.token), 43)  # 256 bits
        self.assertNotEqual(self.server.token, self.start().token)
        headers = self.server.ask("GET", f"/{self.server.token}/").headers
        self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
        self.assertNotRegex(headers["Content-Security-Policy"], r"https?:|\*|unsafe")
        self.assertIn("frame-ancestors 'none'", headers["Content-Security-Policy"])
        self.assertEqual(headers["Referrer-Policy"], "no-referrer")
        self.assertEqual(headers["Cache-Control"], "no-store")

    def test_the_address_on_the_command_line_of_a_browser_works_once(self):
        opened = self.folder / "opened"
        browser = self.folder / "browser"
        browser.write_text(f'#!/bin/sh\necho "$1" > {opened}.new && mv {opened}.new {opened}\n')
        browser.chmod(0o700)
        environment = {**os.environ, "BROWSER": f"{browser} %s", "DISPLAY": ":99", "TMPDIR": str(self.temporary)}
        with subprocess.Popen([PROGRAM, "serve"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                              env=environment) as process:
            try:
                printed = process.stdout.readline().strip()
                self.assertTrue(wait_until(opened.exists))
                address = opened.read_text().strip()
                path = "/" + address.split("/", 3)[3]
                self.assertNotEqual(address, printed)
                self.server.host = address.split("/")[2]
                self.server.port = int(self.server.host.split(":")[1])
                first, second = (self.server.ask("GET", path) for _ in range(2))
                self.assertEqual((first.status, second.status), (303, 403))
                self.assertTrue(printed.endswith(first.headers["Location"]))
            finally:
                process.terminate()


class Uploads(ServeTestCase):
    OPTIONS = ["--max-upload-mib", "1"]

    def setUp(self):
        super().setUp()
        self.sent = self.page()
        self.before = self.server.files()

    def test_paths_lead_nowhere_else(self):
        (self.folder / "secret.css").write_text("secret")
        token = self.server.token
        for path in ("../secret.css", "../../secret.css", "%2e%2e/secret.css", "page/../../secret.css", "static.py",
                     "/etc/passwd", "index.html", "page.css/", "pages/../page.css",
                     f"pages/{self.sent.name}/image/../.."):
            with self.subTest(path=path):
                response = self.server.ask("GET", f"/{token}/{path}")
                self.assertIn(response.status, (404, 409, 410))
                self.assertNotIn(b"secret", response.content)

    def test_bad_names_are_refused_in_one_sentence(self):
        for name in ("../a.nii", "..%2fa.nii", "%2e%2e%2fa.nii", "/a.nii", "%2Fetc%2Fa.nii", "a%00.nii", "a%0a.nii",
                     "a%5c.nii", ".a.nii", "-a.nii", "phantom:abdomen.nii", "", "a.exe", "nii",
                     "x" * 200 + ".nii", ".."):
            with self.subTest(name=name):
                status, sentence = self.sent.fault("PUT", f"file/{name}", b"x")
                self.assertIn(status, (400, 404))
                self.assertEqual(sentence.count("\n"), 0)
        self.assertEqual(self.server.files(), self.before)
        self.assertEqual([path for path in self.folder.rglob("*.nii")], [])

    def test_too_large_uploads_are_refused_in_one_sentence(self):
        status, sentence = self.sent.fault("PUT", "file/a.nii", bytes(2 << 20))
        self.assertEqual(status, 413)
        self.assertIn("2.0 MiB are more than the 1.0 MiB", sentence)
        head = f"PUT /{self.server.token}/pages/{self.sent.name}/file/a.nii HTTP/1.1\r\nHost: {self.server.host}\r\n"
        for length, status in ((1 << 60, 413), ("9" * 5000, 411), ("-1", 411), ("x", 411)):
            answer = self.server.raw(f"{head}Content-Length: {length}\r\n\r\n".encode())
            self.assertIn(f" {status} ".encode(), answer.split(b"\r\n")[0])
        chunked = self.server.raw(f"{head}Transfer-Encoding: chunked\r\n\r\n1\r\nx\r\n".encode())
        self.assertIn(b" 411 ", chunked.split(b"\r\n")[0])
        self.assertEqual(self.server.files(), self.before)

    def test_an_upload_that_is_cut_off_leaves_nothing(self):
        head = (f"PUT /{self.server.token}/pages/{self.sent.name}/file/a.nii HTTP/1.1\r\nHost: {self.server.host}\r\n"
                "Content-Length: 1000\r\n\r\n").encode()
        answer = self.server.raw(head + bytes(300))
        self.assertIn("the upload ended after 300 of 1,000 bytes", answer.decode())
        with socket.create_connection(("127.0.0.1", self.server.port)) as connection:
            connection.sendall(head + bytes(300))
            self.assertTrue(wait_until(lambda: self.server.files() != self.before))
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")  # as a crash: reset
        self.assertTrue(wait_until(lambda: self.server.files() == self.before))

    def test_a_header_that_names_a_file_elsewhere_is_refused(self):
        voxels = self.folder / "secret.raw"
        voxels.write_bytes(ball_voxels(12))
        meta = write_metaimage(self.folder / "b.mha", b"").read_text()
        nrrd = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 12 12 12\nencoding: raw\n"
        for name, header in (
                ("a.mhd", meta.replace("= LOCAL", f"= {voxels}")), ("a.mha", meta.replace("= LOCAL", f"= {voxels}")),
                ("a.mhd", meta.replace("= LOCAL", "= ../../secret.raw")),
                ("a.mhd", meta.replace("= LOCAL", "= other.raw")),
                ("a.mha", meta.replace("ElementDataFile = LOCAL", f"\nElementDataFile = {voxels}")),
                ("a.mhd", meta.replace("Element", f"elementdatafile = LOCAL\nElementDataFile = {voxels}\nElement")),
                ("a.nhdr", f"{nrrd}data file: {voxels}\n"), ("a.nrrd", f"{nrrd}datafile: {voxels}\n\n")):
            with self.subTest(header=header):
                self.sent.json("POST", "begin")
                self.sent.json_of(self.sent.ask("PUT", f"file/{name}", header.encode()))
                status, sentence = self.sent.fault("POST", "open")
                self.assertEqual(status, 400)
                self.assertIn("drop both files together", sentence)

    def test_what_is_no_image_is_refused_with_podms_sentence(self):
        for content, words in ((b"", "empty"), (b"no image at all", ""), (bytes(400), "NIfTI")):
            self.sent.json("POST", "begin")
            self.sent.json_of(self.sent.ask("PUT", "file/a.nii", content))
            status, sentence = self.sent.fault("POST", "open")
            self.assertEqual(status, 400)
            self.assertRegex(sentence, rf"^a\.nii: .*{words}")
            self.assertNotIn(str(self.temporary), sentence)
        self.assertEqual(self.sent.fault("POST", "run", json.dumps(BALL).encode())[0], 409)

    def test_settings_that_are_none_are_refused(self):
        image = write_nifti(self.folder / "a.nii", ball_voxels(12))
        self.sent.open(image)
        for sent in ("", "[]", "{}", '"x"', json.dumps(settings(keep=[])), json.dumps(settings(keep=["1; id"])),
                     json.dumps(settings(keep=[-1])), json.dumps(settings(merges=[("", [1])])),
                     json.dumps(settings(merges=[("a\nb", [1])])), json.dumps(settings(radius="--log=x")),
                     json.dumps(settings(radius=-1)), json.dumps(settings(radius=float("nan"))),
                     json.dumps(settings(min_dihedral=90)), json.dumps(settings(radius=10**400)),
                     "[" * 100_000, "x" * (2 << 20)):
            with self.subTest(sent=sent[:80]):
                self.assertIn(self.sent.fault("POST", "run", sent.encode())[0], (400, 413))


class Jobs(ServeTestCase):
    def setUp(self):
        super().setUp()
        self.image = self.folder / "spheres.nii.gz"
        self.assert_exit(run_podm("phantom", "spheres", "--size", "32", "-o", self.image), 0)

    def test_the_mesh_is_that_of_the_command_line_and_of_python(self):
        page = self.page()
        info = page.open(self.image)
        self.assertEqual([label["value"] for label in info["labels"]], [1, 2, 3])
        sent = settings(keep=[1, 2, 3], merges=[("it's both", [2, 3])], radius=17.5, delta=8, smooth=8, min_dihedral=8)
        plan = page.json("POST", "plan", sent)
        lines = page.json("POST", "lines", sent)
        state = page.mesh(sent)
        self.assertEqual(state["stage"], "done")
        self.assertGreater(len(state["claims"]), 5)
        self.assertEqual({claim["verdict"] for claim in state["claims"]}, {"pass"})
        self.assertEqual(state["mesh"]["unmet"], [])
        self.assertLess(abs(plan["cells"] / state["mesh"]["cells"] - 1), 0.3)

        words = shlex.split(lines["command"])
        self.assertEqual(words[:3], ["podm", "mesh", "spheres.nii.gz"])
        process = run_podm(*words[1:], "--record", "r.jsonl", cwd=self.folder)
        self.assert_exit(process, 0)
        self.assertEqual(self.read_record(self.folder / "r.jsonl")["mesh_sha256"], state["mesh"]["sha256"])

        package = pathlib.Path(PROGRAM).resolve().parents[1] / "python"
        if not any(package.glob("podm/_podm*.so")):
            print("skipped: the Python package is not built", file=sys.stderr)
            return
        (self.folder / "spheres.vtu").unlink()
        subprocess.run(["/usr/bin/python3", "-c", lines["python"]], cwd=self.folder, check=True, capture_output=True,
                       env={**os.environ, "PYTHONPATH": str(package)})
        downloaded = self.unzipped(page, ".vtu")
        for name in ("spheres.vtu", "spheres_facets.vtu"):
            self.assertEqual((self.folder / name).read_bytes(), downloaded[name])

    def unzipped(self, page, extension):
        """Returns the files of a download by name."""
        response = page.ask("GET", f"download/{extension}")
        self.assertEqual(response.status, 200, response.content)
        name = response.headers["Content-Disposition"].split("''")[1]
        if not name.endswith(".zip"):
            return {name: response.content}
        with zipfile.ZipFile(io.BytesIO(response.content)) as packed:
            return {name: packed.read(name) for name in packed.namelist()}

    def test_every_format_is_downloaded_and_holds_the_mesh(self):
        page = self.page()
        page.open(self.image)
        self.assertEqual(page.fault("GET", "download/.vtu")[0], 409)
        state = page.mesh(COARSE)
        before = self.server.files()
        for extension in page.json("GET", "options")["formats"]:
            with self.subTest(extension=extension):
                files = self.unzipped(page, extension)
                folder = self.folder / extension[1:]
                folder.mkdir()
                for name, content in files.items():
                    (folder / name).write_bytes(content)
                self.assertTrue(any(name.endswith(extension) for name in files), files.keys())
                if extension in (".stl", ".ply"):
                    self.assertEqual(len(files), 3)
                elif extension != ".xdmf":  # podm-verify does not read it
                    process = run_podm("convert", folder / f"spheres{extension}", folder / "again.vtk")
                    self.assertIn(f"{state['mesh']['cells']} cells of 3 labels", process.stderr)
        for extension in ("", ".exe", "%2e%2e%2f.vtu", "vtu"):
            self.assertEqual(page.fault("GET", f"download/{extension}")[0], 404)
        self.assertEqual(self.server.files(), before)

    def test_every_image_format_is_taken_and_shown(self):
        labels = {}
        voxels = ball_voxels(12)
        inr = ("#INRIMAGE-4#{\nXDIM=12\nYDIM=12\nZDIM=12\nVDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\nCPU=decm\n"
               "VX=1\nVY=1\nVZ=1\n")
        nrrd = "NRRD0004\ntype: uchar\ndimension: 3\nspace: right-anterior-superior\nsizes: 12 12 12\n" \
               "space directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: raw\n"
        meta = write_metaimage(self.folder / "a.mha", voxels)
        write_nifti(self.folder / "a.nii", voxels)
        (self.folder / "a.inr").write_bytes(inr.encode().ljust(252, b"\n") + b"##}\n" + voxels)
        (self.folder / "a.nrrd").write_bytes(nrrd.encode() + b"\n" + voxels)
        (self.folder / "a.nhdr").write_text(nrrd + "data file: b.raw\n")
        (self.folder / "a.mhd").write_bytes(meta.read_bytes()[:-len(voxels)].replace(b"LOCAL", b"b.raw"))
        (self.folder / "b.raw").write_bytes(voxels)
        page = self.page()
        for name, *beside in (("a.nii",), ("a.mha",), ("a.inr",), ("a.nrrd",), ("a.nhdr", "b.raw"), ("a.mhd", "b.raw")):
            info = page.open(*(self.folder / one for one in (name, *beside)))
            labels[name] = [label["voxels"] for label in info["labels"]]
            shown = page.ask("GET", "image").content
            self.assertEqual(len(shown), 352 + len(voxels))
            self.assertEqual(shown[344:347], b"n+1")
            self.assertEqual(info["shown"], [1])
        self.assertEqual({tuple(counts) for counts in labels.values()}, {(voxels.count(1),)}, labels)

    def test_names_and_large_label_values(self):
        image = write_nifti(self.folder / "a.nii", b"".join(
            (4000000 if v else 0).to_bytes(4, "little") for v in ball_voxels(12)), datatype=8)
        (self.folder / "names.txt").write_text("4000000 ball\n")
        page = self.page()
        info = page.open(image, self.folder / "names.txt")
        self.assertEqual((info["labels"][0]["name"], info["shown"]), ("ball", [1]))
        shown = page.ask("GET", "image").content
        self.assertEqual(len(shown), 352 + 2 * 12**3)
        self.assertEqual(sum(shown[352:]), ball_voxels(12).count(1))
        self.assertIn("--label-names names.txt", page.json("POST", "lines", BALL)["command"])
        self.assertEqual(page.mesh(BALL)["stage"], "done")

    def test_colours_of_the_table_are_those_of_slices_and_mesh(self):
        (self.folder / "lut.ctbl").write_text("# Color table file\n2 middle 1 2 3 255\n")
        page = self.page()
        colours = [label["colour"] for label in page.open(self.image, self.folder / "lut.ctbl")["labels"]]
        self.assertEqual(colours[1], "#010203")
        self.assertEqual(len({"#010203", *colours}), 3)
        page.mesh(COARSE)
        self.assertEqual([label["colour"] for label in page.json("GET", "mesh")["labels"]], colours)

    def test_one_job_at_a_time_and_a_stopped_one_leaves_a_valid_mesh_or_none(self):
        page, other = self.page(), self.page()
        page.open(self.image)
        other.open(self.image)
        page.json("POST", "run", LONG)
        status, sentence = other.fault("POST", "run", json.dumps(COARSE).encode())
        self.assertEqual((status, sentence), (409, "Another job runs; this server runs one at a time."))
        self.assertEqual(page.fault("POST", "begin")[0], 409)
        while page.wait_for("meshing")["phase"] != "refine":
            pass
        page.json("POST", "stop")
        state = page.wait_for("done", "stopped", "failed")
        self.assertEqual(state["stage"], "done")
        self.assertIn("the run ended early", state["mesh"]["unmet"][0])
        verdicts = {claim["name"]: claim["verdict"] for claim in state["claims"]}
        self.assertEqual((verdicts["structure"], verdicts["delaunay"]), ("pass", "pass"))
        self.assertEqual(other.mesh(COARSE)["stage"], "done")

    def test_a_page_that_is_closed_takes_its_data_and_its_job_along(self):
        page, other = Page(self.server), Page(self.server)
        for one in (page, other):
            one.open(self.image)
        page.json("POST", "run", LONG)
        page.wait_for("meshing")
        self.assertTrue(wait_until(lambda: children_of(self.server.process.pid)))
        self.assertGreater(len(self.server.files()), 0)
        page.close()  # as a browser that crashes
        other.json("POST", "leave")  # as a tab that is closed
        self.assertTrue(wait_until(lambda: not self.server.files(), SECONDS_UNSEEN + 60))
        self.assertEqual(children_of(self.server.process.pid), [])
        self.assertEqual(page.fault("POST", "stop")[0], 410)
        self.assertEqual(self.page().open(self.image)["path"], "spheres.nii.gz")


def own_addresses():
    """Returns the address under which other machines reach this one; none without a network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # an address for documentation; nothing is sent
        except OSError:
            return []
        return [probe.getsockname()[0]]


def children_of(process):
    """Returns the processes that any thread of the process has started."""
    lists = pathlib.Path(f"/proc/{process}/task").glob("*/children")
    return [child for one in lists for child in one.read_text().split()]


class SleepingPrograms(PodmTestCase):
    def setUp(self):
        super().setUp()
        self.program = self.folder / "sleeps"
        self.program.write_text("#!/bin/sh\ntouch started\nexec sleep 60\n")
        self.program.chmod(0o700)
        tools = types.SimpleNamespace(podm=self.program, declared=types.SimpleNamespace(extensions=[".msh"]),
                                      limits=LimitsOfChild(1 << 40, 60), converting=threading.Lock(),
                                      slot=threading.Lock())
        (self.folder / "page").mkdir()
        self.workspace = Workspace(tools, self.folder / "page")
        self.workspace.image = "a.nii"
        self.mesh = self.folder / "page" / "made" / "a.vtu"
        self.mesh.touch()

    def begin(self, action):
        """Returns a thread in which the action has started the program, and the list that gets its answer."""
        answers = []

        def act():
            try:
                answers.append(action())
            except Fault as fault:
                answers.append(fault.status)

        thread = threading.Thread(target=act)
        thread.start()
        self.assertTrue(wait_until(lambda: list(self.folder.rglob("started"))))
        return thread, answers

    def test_a_conversion_stands_in_the_way_of_no_run_and_ends_with_its_page(self):
        thread, answers = self.begin(lambda: self.workspace.download(".msh"))
        self.assertEqual(list(self.mesh.parent.iterdir()), [self.mesh])  # a run removes what is here
        self.workspace.close()
        thread.join(10)
        self.assertEqual((thread.is_alive(), answers), (False, [500]))
        self.assertFalse((self.folder / "page").exists())

    def test_a_new_image_ends_a_prediction_without_a_fault(self):
        settings_of_none = types.SimpleNamespace(of_labels=list, of_cells=list)
        thread, answers = self.begin(lambda: self.workspace.predict(settings_of_none))
        self.workspace.begin()
        thread.join(10)
        self.assertEqual((thread.is_alive(), answers), (False, [None]))

    def test_the_page_says_why_no_claim_is_decided(self):
        self.program.write_text("#!/bin/sh\necho 'podm-verify: a.vtu: no such file' >&2\nexit 2\n")
        self.workspace.tools.verifier = self.program
        self.workspace._verify(types.SimpleNamespace(of_labels=list), {"verify": {"claims": ["labels"], "options": []}})
        state, _ = self.workspace.wait_for_change(None, 0)
        self.assertEqual(state["undecided"], "podm-verify: a.vtu: no such file")


class Limits(ServeTestCase):
    OPTIONS = ["--max-seconds", "2", "--max-memory-gib", "2"]

    @slow
    def test_a_mesh_that_reaches_a_limit_is_valid_and_the_page_says_so(self):
        image = self.folder / "spheres.nii"
        self.assert_exit(run_podm("phantom", "spheres", "--size", "32", "-o", image), 0)
        page = self.page()
        page.open(image)
        state = page.mesh(LONG)
        self.assertEqual(state["stage"], "done", state)
        self.assertRegex(state["mesh"]["unmet"][0], "the run ended early: time limit")
        page.json("POST", "begin")
        page.open(image)
        page.json("POST", "run", settings(radius=0.3))
        state = page.wait_for("stopped")
        self.assertRegex(state["fault"], "need about .* GiB of memory; the limit is")

    def test_a_mesh_that_the_page_does_not_turn_is_not_read(self):
        self.assertIsNone(mesh_parts(self.folder / "missing.vtu", MOST_CELLS + 1, {}))

    def test_a_program_that_takes_too_much_is_ended(self):
        for code, limits, words in (
                ("bytearray(400 << 20)", LimitsOfChild(200 << 20, 60), "needs more than the 0.195 GiB"),
                ("0", LimitsOfChild(1 << 40, 0.5), "takes more than the 0.5 s")):
            program = [sys.executable, "-c", f"import time; x = {code}; time.sleep(60)"]
            ended = Child(program, self.folder, limits).wait()
            self.assertEqual(ended.exit_code, -signal.SIGKILL)
            self.assertIn(words, ended.broken)


class Ending(ServeTestCase):
    def test_signals_remove_the_folder_and_end_the_job(self):
        image = self.folder / "spheres.nii"
        self.assert_exit(run_podm("phantom", "spheres", "--size", "32", "-o", image), 0)
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            server = self.start()
            page = Page(server)
            page.open(image)
            page.json("POST", "run", LONG)
            page.wait_for("meshing")
            self.assertTrue(wait_until(lambda: children_of(server.process.pid)))
            job = children_of(server.process.pid)
            self.assertGreater(len(list(self.temporary.iterdir())), 1)
            code, stderr = server.end(number)
            self.assertEqual(code, 0, stderr)
            self.assertNotIn("Traceback", stderr)
            self.assertEqual(list(self.temporary.glob("*/spheres*")), [])
            self.assertFalse(any(pathlib.Path(f"/proc/{one}/exe").exists() for one in job))
        self.assertEqual(self.server.end()[0], 0)
        self.assertEqual(list(self.temporary.iterdir()), [])

    def test_the_folder_of_a_server_that_was_killed_is_removed_by_the_next(self):
        self.server.end(signal.SIGKILL)
        left = list(self.temporary.iterdir())
        self.assertEqual(len(left), 1)
        (self.temporary / "podm-serve-other").mkdir()
        running = self.start()
        self.start()
        self.assertFalse(left[0].exists())
        self.assertTrue((self.temporary / "podm-serve-other").exists())
        self.assertEqual(running.ask("GET", f"/{running.token}/").status, 200)
        self.assertEqual(len(list(self.temporary.glob("podm-serve-*/lock"))), 2)

    def test_a_folder_that_another_server_removes_before_it_is_locked_is_replaced(self):
        (self.folder / "new").mkdir()
        folders = [str(self.folder / name) for name in ("removed", "new")]
        with unittest.mock.patch("serve_page.scratch.tempfile.mkdtemp", side_effect=folders), \
                unittest.mock.patch("serve_page.scratch.tempfile.gettempdir", return_value=str(self.folder)):
            scratch = Scratch()
        self.assertEqual(scratch.path, self.folder / "new")
        scratch.close()

    def test_only_this_user_may_enter_the_folder(self):
        for path in self.temporary.rglob("*"):
            if path.is_dir():
                self.assertEqual(path.stat().st_mode & 0o077, 0)


class Carried(unittest.TestCase):
    def test_niivue_is_the_file_that_its_page_names(self):
        folder = SCRIPTS / "serve_page" / "niivue"
        digest = hashlib.sha256((folder / "niivue.min.js").read_bytes()).hexdigest()
        self.assertIn(f"`{digest}`", (folder / "README.md").read_text())
        self.assertIn("BSD 2-Clause", (folder / "LICENSE").read_text())


class Usage(PodmTestCase):
    def test_a_port_in_use_is_refused_in_one_sentence(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            process = self.assert_refused(["serve", "--no-browser", "--port", port], f"port {port}", "in use",
                                          env={**os.environ, "TMPDIR": str(self.folder)})
            self.assertEqual(process.stderr.count("\n"), 1)
        self.assertEqual(list(self.folder.iterdir()), [])
        server = Server(self.folder, "--port", port)
        self.assertEqual(server.port, port)
        self.assertEqual(server.end()[0], 0)

    def test_bad_limits_are_refused(self):
        for option, value in (("--port", "65536"), ("--port", "x"), ("--max-upload-mib", "0"), ("--max-seconds", "nan"),
                              ("--max-memory-gib", "-1")):
            self.assert_refused(["serve", f"{option}={value}"], option)


if __name__ == "__main__":
    unittest.main()
