"""A headless Chromium, controlled by the DevTools protocol on a pipe: no driver, no network, no other package."""
import base64
import json
import os
import shutil
import subprocess
import tempfile

FLAGS = ["--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--disable-gpu-sandbox",
         "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars", "--no-first-run",
         "--disable-dev-shm-usage", "--disable-quic", "--disable-background-networking", "--disable-component-update",
         "--disable-sync"]


def find_chromium():
    """Returns the browser's path, or None."""
    return shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


class Browser:
    """One tab. `errors` holds the console's errors and warnings since the last `open`."""

    def __init__(self):
        self.errors = []
        self._number = 0
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_browser, self._out = os.pipe()
        self._in, from_browser = os.pipe()
        # Chromium reads commands from descriptor 3 and answers on 4.
        command = f'exec "$@" 3<&{to_browser} 4>&{from_browser}'
        self._process = subprocess.Popen(
            ["bash", "-c", command, "-", find_chromium(), *FLAGS, f"--user-data-dir={self._profile.name}",
             "about:blank"], pass_fds=(to_browser, from_browser), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self._answers = os.fdopen(self._in, "rb")
        self._session = None
        target = self._send("Target.createTarget", url="about:blank")["targetId"]
        self._session = self._send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self._send(f"{domain}.enable")

    def close(self):
        os.close(self._out)  # Chromium ends with its pipe
        try:
            self._process.wait(timeout=20)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._answers.close()
        self._profile.cleanup()

    def open(self, path, width, height=900, scheme="light"):
        """Loads a file on a screen of that width, and waits until it is drawn."""
        self.go(path.resolve().as_uri(), width, height, scheme)
        self.evaluate("new Promise(done => setTimeout(done, 1500))")  # the mesh is unpacked and drawn after the load

    def go(self, address, width, height=900, scheme="light"):
        """Loads an address on a screen of that width."""
        self.errors.clear()
        self._send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                   mobile=width < 600)
        self._send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        self._send("Page.navigate", url=address)
        self.evaluate("new Promise(done => "
                      "document.readyState === 'complete' ? done() : addEventListener('load', done))")

    def evaluate(self, expression):
        answer = self._send("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(answer["exceptionDetails"]["exception"].get("description"))
        return answer["result"].get("value")

    def drop(self, selector, *paths):
        """Drags files from outside and drops them on the first element that matches."""
        x, y = self.evaluate(f"""(() => {{
            const box = document.querySelector('{selector}').getBoundingClientRect();
            return [box.x + box.width / 2, box.y + box.height / 2]; }})()""")
        data = {"items": [], "files": list(map(str, paths)), "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            self._send("Input.dispatchDragEvent", type=kind, x=x, y=y, data=data)

    def choose(self, selector, *paths):
        """Chooses files in the input that matches, as its dialogue does."""
        root = self._send("DOM.getDocument")["root"]["nodeId"]
        node = self._send("DOM.querySelector", nodeId=root, selector=selector)["nodeId"]
        self._send("DOM.setFileInputFiles", files=list(map(str, paths)), nodeId=node)

    def press(self, key, code=0, text="", shift=False):
        """Presses a key: "Tab", or a character as `text`."""
        common = {"key": key, "code": key, "windowsVirtualKeyCode": code, "modifiers": 8 if shift else 0}
        self._send("Input.dispatchKeyEvent", type="keyDown" if text else "rawKeyDown", text=text, **common)
        self._send("Input.dispatchKeyEvent", type="keyUp", **common)

    def save_downloads_in(self, folder):
        self._send("Page.setDownloadBehavior", behavior="allow", downloadPath=str(folder))

    def screenshot(self, selector="html"):
        """Returns a PNG of the first element that matches; by default of the whole page."""
        box = self.evaluate(f"""(() => {{
            const box = document.querySelector('{selector}').getBoundingClientRect();
            return [box.x + scrollX, box.y + scrollY, box.width, box.height]; }})()""")
        clip = dict(zip(("x", "y", "width", "height"), box), scale=1)
        return base64.b64decode(self._send("Page.captureScreenshot", clip=clip, captureBeyondViewport=True)["data"])

    def _send(self, method, **parameters):
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._read()
            if answer.get("id") == self._number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self._listen(answer)

    def _read(self):
        data = bytearray()
        while (byte := self._answers.read(1)) != b"\0":
            if not byte:
                raise RuntimeError("Chromium ended")
            data += byte
        return json.loads(data)

    def _listen(self, event):
        parameters = event.get("params", {})
        if event.get("method") == "Runtime.exceptionThrown":
            self.errors.append(parameters["exceptionDetails"].get("exception", {}).get("description", "exception"))
        elif event.get("method") == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
            self.errors.append(parameters["entry"]["text"])
        elif event.get("method") == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning", "assert"):
            self.errors.append(str(parameters["args"]))
