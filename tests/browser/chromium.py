"""Drives headless Chromium over a pipe: the DevTools protocol, without any package."""

import base64
import json
import os
import select
import subprocess
import tempfile
import time

OPTIONS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--remote-debugging-pipe",
]
END_OF_MESSAGE = b"\0"
ANSWER_S = 360


def descendants(process):
    """Returns a process and all that it started, by their numbers."""
    found = [process]
    for parent in found:
        for task in os.listdir(f"/proc/{parent}/task") if os.path.exists(f"/proc/{parent}/task") else []:
            try:
                with open(f"/proc/{parent}/task/{task}/children", encoding="ascii") as children:
                    found += map(int, children.read().split())
            except OSError:
                continue
    return found


class Chromium:
    """A browser with one page."""

    def __init__(self, program="chromium"):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        read_by_browser, self.to_browser = os.pipe()
        self.from_browser, written_by_browser = os.pipe()

        # The protocol has these numbers. The copies go first to numbers that neither pipe has.
        def connect():
            high = [os.dup2(fd, 100 + fd) for fd in (read_by_browser, written_by_browser)]
            os.dup2(high[0], 3)
            os.dup2(high[1], 4)

        command = [program, *OPTIONS, f"--user-data-dir={self.profile.name}", "about:blank"]
        self.process = subprocess.Popen(
            command, preexec_fn=connect, close_fds=False, stderr=subprocess.DEVNULL
        )
        os.close(read_by_browser)
        os.close(written_by_browser)
        self.received = b""
        self.number = 0
        self.session = None
        self.requests = []

    def open(self, url):
        """Opens a page, and notes what it asks for."""
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        attached = self.call("Target.attachToTarget", targetId=target, flatten=True)
        self.session = attached["sessionId"]
        for domain in ("Page", "Network", "Runtime", "DOM"):
            self.call(f"{domain}.enable")
        self.call("Page.navigate", url=url)

    def call(self, method, **params):
        """Calls a method of the protocol, and returns its result."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if self.session:
            message["sessionId"] = self.session
        data = json.dumps(message).encode() + END_OF_MESSAGE
        while data:
            data = data[os.write(self.to_browser, data) :]
        return self.answer(self.number, method)

    def answer(self, number, method):
        until = time.monotonic() + ANSWER_S
        while True:
            message = self.message(until)
            if message.get("method") == "Network.requestWillBeSent":
                self.requests.append(message["params"]["request"]["url"])
            if message.get("id") != number:
                continue
            if "error" in message:
                raise RuntimeError(f"{method}: {message['error']['message']}")
            return message["result"]

    def message(self, until):
        while END_OF_MESSAGE not in self.received:
            ready, _, _ = select.select([self.from_browser], [], [], until - time.monotonic())
            part = os.read(self.from_browser, 1 << 20) if ready else b""
            if not part:
                raise RuntimeError("the browser does not answer")
            self.received += part
        message, self.received = self.received.split(END_OF_MESSAGE, 1)
        return json.loads(message)

    def evaluate(self, expression):
        """Returns the value of an expression in the page, after it is settled."""
        result = self.call(
            "Runtime.evaluate",
            expression=expression,
            awaitPromise=True,
            returnByValue=True,
            userGesture=True,
        )
        if "exceptionDetails" in result:
            raise RuntimeError(json.dumps(result["exceptionDetails"]))
        return result["result"].get("value")

    def drop(self, files, x=200, y=200):
        """Drops files on the page."""
        data = {"items": [], "files": [os.path.abspath(file) for file in files], "dragOperationsMask": 1}
        for kind in ("dragEnter", "dragOver", "drop"):
            self.call("Input.dispatchDragEvent", type=kind, x=x, y=y, data=data)

    def choose(self, selector, files):
        """Chooses files for an input, as its dialog does."""
        found = self.call("Runtime.evaluate", expression=f"document.querySelector({json.dumps(selector)})")
        paths = [os.path.abspath(file) for file in files]
        self.call("DOM.setFileInputFiles", objectId=found["result"]["objectId"], files=paths)

    def cpu_s(self):
        """Returns the time that all processes of the browser computed, s."""
        ticks = 0
        for process in descendants(self.process.pid):
            try:
                with open(f"/proc/{process}/stat", encoding="ascii", errors="replace") as stat:
                    fields = stat.read().rpartition(")")[2].split()
            except OSError:
                continue
            ticks += int(fields[11]) + int(fields[12])
        return ticks / os.sysconf("SC_CLK_TCK")

    def resize(self, width, height):
        """Gives the page the size of a screen."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=width < 600,
        )

    def picture(self, path):
        """Writes a picture of the whole page."""
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        clip = {"x": 0, "y": 0, "width": size["width"], "height": min(size["height"], 6000), "scale": 1}
        taken = self.call("Page.captureScreenshot", clip=clip, captureBeyondViewport=True)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(base64.b64decode(taken["data"]))

    def close(self):
        """Ends the browser that this object started."""
        self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.to_browser)
        os.close(self.from_browser)
        self.profile.cleanup()
