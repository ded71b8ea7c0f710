"""A headless Chromium, driven by its DevTools protocol."""

import asyncio
import base64
import json
import os
import shutil
import signal
import subprocess
import time
from contextlib import contextmanager
from urllib.request import urlopen

from tornado.websocket import websocket_connect

CHROMIUM = shutil.which("chromium")
_SECONDS = 60.0
_KEYS = {
    "Enter": 13,
    "Escape": 27,
    "ArrowLeft": 37,
    "ArrowUp": 38,
    "ArrowRight": 39,
    "ArrowDown": 40,
}


class Tab:
    """One page of a browser; `events` are those that it sent so far, (method, parameters)."""

    def __init__(self, loop, socket):
        self._loop, self._socket, self._number = loop, socket, 0
        self.events = []
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.do(f"{domain}.enable")

    def do(self, method, **parameters):
        """Send a command and return its result."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        return self._loop.run_until_complete(self._sent(message))

    async def _sent(self, message):
        await self._socket.write_message(json.dumps(message))
        while True:
            answer = await self._next()
            if answer.get("id") == message["id"]:
                assert "error" not in answer, answer
                return answer["result"]

    async def _next(self):
        answer = json.loads(await asyncio.wait_for(self._socket.read_message(), _SECONDS))
        if "method" in answer:
            self.events.append((answer["method"], answer["params"]))
        return answer

    def open(self, path, width=1400, height=1000, dark=False, script=True):
        """Show a page of this computer, and wait until it is there."""
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        still = {"name": "prefers-reduced-motion", "value": "reduce"}  # else places move as read
        self.do("Emulation.setEmulatedMedia", features=[scheme, still])
        self.do("Emulation.setScriptExecutionDisabled", value=not script)
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
        self.do("Emulation.setDeviceMetricsOverride", **size)
        self.events.clear()
        self.do("Page.navigate", url=path.resolve().as_uri())
        while not any(name == "Page.loadEventFired" for name, _ in self.events):
            self._loop.run_until_complete(self._next())

    def value(self, expression):
        """Return what a JavaScript expression is, as plain data."""
        reply = self.do("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in reply, reply
        return reply["result"].get("value")

    def click(self, x, y):
        """Click at a place of the page shown."""
        self.mouse("Moved", x, y)
        for kind in ("Pressed", "Released"):
            self.mouse(kind, x, y)

    def drag(self, start, end):
        """Move the mouse between two places with its button pressed."""
        self.mouse("Moved", *start)
        self.mouse("Pressed", *start)
        self.mouse("Moved", *end, buttons=1)
        self.mouse("Released", *end)

    def mouse(self, kind, x, y, **more):
        """Send one event of the mouse."""
        button = {} if kind == "Moved" else {"button": "left", "clickCount": 1}
        self.do("Input.dispatchMouseEvent", type=f"mouse{kind}", x=x, y=y, **button, **more)

    def press(self, *keys):
        """Press keys, one after the other."""
        for key in keys:
            name = {"key": key, "code": key, "windowsVirtualKeyCode": _KEYS[key]}
            typed = {"text": "\r"} if key == "Enter" else {}  # else it submits no form
            self.do("Input.dispatchKeyEvent", type="keyDown", **name, **typed)
            self.do("Input.dispatchKeyEvent", type="keyUp", **name)

    def painted(self):
        """Wait until the page has drawn what changed."""
        twice = "new Promise(f => requestAnimationFrame(() => requestAnimationFrame(f)))"
        self.do("Runtime.evaluate", expression=twice, awaitPromise=True)

    def picture(self):
        """Return the whole page as a PNG."""
        shot = self.do("Page.captureScreenshot", captureBeyondViewport=True)
        return base64.b64decode(shot["data"])

    def pdf(self):
        """Return the page as it is printed."""
        return base64.b64decode(self.do("Page.printToPDF", preferCSSPageSize=True)["data"])

    def complaints(self):
        """Return every error of the console, of a script or of the network so far."""
        reported = {"Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded"}
        return [event for event in self.events if event[0] in reported | {"Network.loadingFailed"}]

    def requests(self):
        """Return the addresses that the page asked for."""
        return [
            parameters["request"]["url"]
            for name, parameters in self.events
            if name == "Network.requestWillBeSent"
        ]


@contextmanager
def tab(folder):
    """Yield a `Tab` of a Chromium that keeps its files in a folder."""
    command = [CHROMIUM, "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run"]
    command += ["--remote-debugging-port=0", f"--user-data-dir={folder}", "about:blank"]
    loop = asyncio.new_event_loop()
    with open(folder / "output", "wb") as output:
        browser = subprocess.Popen(command, stdout=output, stderr=output, start_new_session=True)
    try:
        port = _port(folder)
        with urlopen(f"http://127.0.0.1:{port}/json/list", timeout=_SECONDS) as answer:
            address = next(target for target in json.load(answer) if target["type"] == "page")
        socket = loop.run_until_complete(_connected(address["webSocketDebuggerUrl"]))
        yield Tab(loop, socket)
        loop.run_until_complete(_closed(socket))
    finally:
        os.killpg(browser.pid, signal.SIGTERM)
        browser.wait(_SECONDS)
        loop.close()


async def _connected(address):
    return await websocket_connect(address, max_message_size=2**28)


async def _closed(socket):
    socket.close()


def _port(folder):
    until = time.monotonic() + _SECONDS
    while time.monotonic() < until:
        port = folder / "DevToolsActivePort"
        if port.exists() and (lines := port.read_text().split()):
            return lines[0]
        time.sleep(0.05)
    raise AssertionError((folder / "output").read_text())
