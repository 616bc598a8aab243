"""Drives Chromium by chromedriver (Debian's chromium and chromium-driver), with Python's own library only."""
import json
import shutil
import socket
import subprocess
import sys
import time
import urllib.request


def require():
    """Ends the test as skipped where there is no browser."""
    for program, package in (("chromedriver", "chromium-driver"), ("chromium", "chromium")):
        if not shutil.which(program):
            print("SKIP: no %s (package %s)" % (program, package))
            sys.exit(77)


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


class Browser:
    """A headless Chromium without WebGL. with Browser(width, height, *flags) as b: ..."""

    def __init__(self, width, height, *flags):
        port = free_port()
        self.driver = subprocess.Popen(["chromedriver", "--port=%d" % port], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.address = "http://127.0.0.1:%d" % port
        for _ in range(100):
            try:
                self.call("/status")
                break
            except OSError:
                time.sleep(.1)
        arguments = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-3d-apis", "--window-size=%d,%d" % (width, height), *flags]
        capabilities = {"goog:chromeOptions": {"args": arguments}, "goog:loggingPrefs": {"performance": "ALL", "browser": "ALL"}}
        self.session = "/session/" + self.call("/session", {"capabilities": {"alwaysMatch": capabilities}})["sessionId"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call(self.session, method="DELETE")
        finally:
            self.driver.terminate()
            self.driver.wait()

    def call(self, path, body=None, method=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.address + path, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.load(answer)["value"]

    def open(self, path):
        self.call(self.session + "/url", {"url": "file://" + path})

    def run(self, script):
        return self.call(self.session + "/execute/sync", {"script": script, "args": []})

    def wait(self, condition, seconds=30):
        """Until a condition of the page is true; False: it never was."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self.run("return !!(%s)" % condition):
                return True
            time.sleep(.05)
        return False

    def act(self, *sources):
        self.call(self.session + "/actions", {"actions": list(sources)})

    def drag(self, points, button=0):
        """Presses at the first of the points, moves along the others, and lets go."""
        moves = [{"type": "pointerMove", "duration": 30, "x": x, "y": y} for x, y in points]
        self.act({"type": "pointer", "id": "mouse", "actions": [moves[0], {"type": "pointerDown", "button": button}, *moves[1:],
                                                               {"type": "pointerUp", "button": button}]})

    def wheel(self, x, y, pixels):
        self.act({"type": "wheel", "id": "wheel", "actions": [{"type": "scroll", "x": x, "y": y, "deltaX": 0, "deltaY": pixels}]})

    def pinch(self, x, y, begin, end):
        """Two fingers beside (x, y), `begin` and then `end` pixels from it."""
        def finger(name, sign):
            return {"type": "pointer", "id": name, "parameters": {"pointerType": "touch"}, "actions": [
                {"type": "pointerMove", "duration": 0, "x": x + sign * begin, "y": y}, {"type": "pointerDown", "button": 0},
                {"type": "pointerMove", "duration": 100, "x": x + sign * end, "y": y}, {"type": "pointerUp", "button": 0}]}
        self.act(finger("left", -1), finger("right", 1))

    def keys(self, text):
        self.act({"type": "key", "id": "keys", "actions": [{"type": kind, "value": key} for key in text for kind in ("keyDown", "keyUp")]})

    def before_scripts(self, script):
        """Runs a script in every page that is opened from now on, before its own."""
        self.call(self.session + "/goog/cdp/execute", {"cmd": "Page.addScriptToEvaluateOnNewDocument", "params": {"source": script}})

    def without_scripts(self):
        self.call(self.session + "/goog/cdp/execute", {"cmd": "Emulation.setScriptExecutionDisabled", "params": {"value": True}})

    def log(self, kind):
        return self.call(self.session + "/se/log", {"type": kind})

    def requests(self):
        """The addresses of everything that was asked for since the last call."""
        messages = (json.loads(entry["message"])["message"] for entry in self.log("performance"))
        return [m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"]
