"""Chromium without a screen, driven over its DevTools protocol through two pipes.

Needs nothing but Python and the package chromium."""

import base64
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time

PATIENCE = 90.0  # s, until an answer counts as missing


class BrowserError(Exception):
    pass


class Browser:
    def __init__(self):
        self._profile = tempfile.mkdtemp(prefix="mjdiag-browser-")
        to_browser, self._out = os.pipe()
        self._in, from_browser = os.pipe()

        def connect():  # the protocol speaks on descriptors 3 and 4
            # Away from 3 and 4 first: each may be the other's target.
            command, answer = os.dup(to_browser), os.dup(from_browser)
            while command in (3, 4):
                command = os.dup(command)
            while answer in (3, 4):
                answer = os.dup(answer)
            os.dup2(command, 3)
            os.dup2(answer, 4)

        self._process = subprocess.Popen(
            ["chromium", "--headless=new", "--no-sandbox", "--disable-gpu",
             "--remote-debugging-pipe", "--no-first-run", "--mute-audio",
             "--disable-dev-shm-usage", "--disable-background-networking",
             "--force-color-profile=srgb", "--hide-scrollbars", "--user-data-dir=" + self._profile,
             "about:blank"],
            preexec_fn=connect, close_fds=False, start_new_session=True,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self._buffer = b""
        self._next = 0
        self._events = []

    def close(self):
        os.close(self._out)
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()
        os.close(self._in)
        shutil.rmtree(self._profile, ignore_errors=True)

    def _read(self):
        deadline = time.monotonic() + PATIENCE
        while b"\0" not in self._buffer:
            left = deadline - time.monotonic()
            if left <= 0 or not select.select([self._in], [], [], left)[0]:
                raise BrowserError("chromium does not answer")
            block = os.read(self._in, 1 << 20)
            if not block:
                raise BrowserError("chromium has ended")
            self._buffer += block
        message, self._buffer = self._buffer.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, session=None, **parameters):
        self._next += 1
        number = self._next
        message = {"id": number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._out, data):]
        while True:
            answer = self._read()
            if answer.get("id") != number:
                self._events.append(answer)
            elif "error" in answer:
                raise BrowserError(method + ": " + answer["error"]["message"])
            else:
                return answer["result"]

    def wait_for(self, method, session):
        """The first event of that name, whether it has come already or is to come."""
        while True:
            for event in self._events:
                if event.get("method") == method and event.get("sessionId") == session:
                    self._events.remove(event)
                    return event["params"]
            self._events.append(self._read())

    def events(self, session):
        return [event for event in self._events if event.get("sessionId") == session]


class Tab:
    """A page of its own, as wide as asked for."""

    def __init__(self, browser, width=1100, height=900, scheme="light", mobile=False):
        self.browser = browser
        target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.target = target
        self.session = browser.call("Target.attachToTarget", targetId=target,
                                    flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=mobile)
        self.media(scheme)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.browser.call("Target.closeTarget", targetId=self.target)

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def media(self, scheme, medium=""):
        self.call("Emulation.setEmulatedMedia", media=medium,
                  features=[{"name": "prefers-color-scheme", "value": scheme}])

    def open(self, path):
        self.call("Page.navigate", url="file://" + os.path.abspath(path))
        self.browser.wait_for("Page.loadEventFired", self.session)

    def run(self, script, *arguments):
        """The value of a JavaScript function of these arguments, awaited."""
        call = "(%s)(%s)" % (script, ", ".join(json.dumps(a) for a in arguments))
        answer = self.call("Runtime.evaluate", expression=call, awaitPromise=True,
                           returnByValue=True, userGesture=True)
        if "exceptionDetails" in answer:
            raise BrowserError(json.dumps(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def complaints(self):
        """Errors and warnings of the console, exceptions, and all that was loaded from
        elsewhere than the page itself."""
        found = []
        for event in self.browser.events(self.session):
            method, params = event["method"], event["params"]
            if method == "Runtime.exceptionThrown":
                found.append(str(params["exceptionDetails"]))
            elif method == "Runtime.consoleAPICalled":
                if params["type"] in ("error", "warning", "assert"):
                    found.append(str(params["args"]))
            elif method == "Log.entryAdded":
                if params["entry"]["level"] in ("error", "warning"):
                    found.append(params["entry"]["text"])
            elif method == "Network.requestWillBeSent":
                url = params["request"]["url"]
                if not url.startswith(("file:", "data:", "about:")):
                    found.append("loads " + url)
        return found

    def screenshot(self, box=None):
        """PNG of the window, or of (x, y, width, height) of the whole page."""
        parameters = {}
        if box:
            parameters = {"captureBeyondViewport": True,
                          "clip": dict(zip(("x", "y", "width", "height"), box), scale=1)}
        data = self.call("Page.captureScreenshot", format="png", **parameters)["data"]
        return base64.b64decode(data)

    def mouse(self, kind, x, y, held=True):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left",
                  buttons=1 if held else 0, clickCount=1)

    def drag(self, start, end):
        self.mouse("mouseMoved", *start, held=False)
        self.mouse("mousePressed", *start)
        for part in (0.3, 0.7, 1.0):
            self.mouse("mouseMoved", *(a + part * (b - a) for a, b in zip(start, end)))
        self.mouse("mouseReleased", *end)
