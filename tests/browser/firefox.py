"""A headless Firefox with the methods of chromium.Chromium, driven over WebDriver BiDi; standard library only."""

import base64
import json
import os
import re
import select
import shutil
import socket
import struct
import subprocess
import tempfile
import time


def program():
    """Its path, or None."""
    return next(filter(None, map(shutil.which, ("firefox-esr", "firefox"))), None)


class Socket:
    """A client's end of a WebSocket (RFC 6455), of texts alone."""

    def __init__(self, port, path, end):
        self.end, self.buffer = end, b""
        self.connection = socket.create_connection(("127.0.0.1", port), timeout=10)
        key = base64.b64encode(os.urandom(16)).decode()
        self.connection.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                                f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
        while b"\r\n\r\n" not in self.buffer:
            self.fill()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        if b" 101 " not in head.splitlines()[0]:
            raise RuntimeError(f"Firefox refuses the connection: {head!r}")

    def fill(self):
        left = self.end - time.monotonic()
        if left <= 0 or not select.select([self.connection], [], [], left)[0]:
            raise TimeoutError("the browser did not answer in time")
        data = self.connection.recv(1 << 20)
        if not data:
            raise RuntimeError("the browser ended")
        self.buffer += data

    def take(self, count):
        while len(self.buffer) < count:
            self.fill()
        data, self.buffer = self.buffer[:count], self.buffer[count:]
        return data

    def send(self, data, code=1):
        mask = os.urandom(4)
        size = len(data)
        head = bytes([0x80 | code]) + (bytes([0x80 | size]) if size < 126 else struct.pack("!BH", 0xFE, size) if size < 65536 else struct.pack("!BQ", 0xFF, size))
        masked = bytes(a ^ b for a, b in zip(data, mask * (size // 4 + 1)))
        self.connection.sendall(head + mask + masked)

    def receive(self):
        """The next text."""
        text = b""
        while True:
            first, second = self.take(2)
            size = second & 0x7F
            if size == 126:
                size, = struct.unpack("!H", self.take(2))
            elif size == 127:
                size, = struct.unpack("!Q", self.take(8))
            data, code = self.take(size), first & 0x0F
            if code == 8:
                raise RuntimeError("the browser ended")
            if code == 9:
                self.send(data, 10)
            elif code in (0, 1):
                text += data
                if first & 0x80:
                    return text


def plain(remote):
    """A value of the page as Python's."""
    kind, value = remote["type"], remote.get("value")
    if kind in ("array", "nodelist", "htmlcollection", "set"):
        return [plain(one) for one in value]
    if kind == "object":
        return {name: plain(one) for name, one in value}
    if kind == "number":
        return {"NaN": float("nan"), "-0": -0.0, "Infinity": float("inf"), "-Infinity": float("-inf")}[value] if isinstance(value, str) else value
    return value if kind in ("string", "boolean") else None


class Firefox:
    """One browser with one page. Keeps what the page logged, threw and asked the network for."""

    SCHEMES = ("light",)  # no command of this protocol sets one
    KEYS = {"Tab": "\ue004", "Delete": "\ue017", "Enter": "\ue007", "ArrowLeft": "\ue012", "ArrowRight": "\ue014", "Control": "\ue009", "Shift": "\ue008"}

    def __init__(self, seconds=60):
        self.end = time.monotonic() + seconds
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.log, self.requests, self.number = [], [], 0
        # A home of its own: it would leave caches in the user's.
        self.process = subprocess.Popen([program(), "--headless", "--no-remote", "--profile", self.profile.name, "--remote-debugging-port", "0", "about:blank"],
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                        env={**os.environ, "HOME": self.profile.name})
        port = None
        while port is None:
            if not select.select([self.process.stderr], [], [], max(0.0, self.end - time.monotonic()))[0]:
                raise TimeoutError("the browser did not start in time")
            line = self.process.stderr.readline()
            if not line:
                raise RuntimeError("the browser ended")
            found = re.search(r"BiDi listening on ws://[\w.]+:(\d+)", line)
            port = int(found[1]) if found else None
        self.socket = Socket(port, "/session", self.end)
        self.call("session.new", capabilities={})
        self.call("session.subscribe", events=["log.entryAdded", "network.beforeRequestSent"])
        self.context = self.call("browsingContext.create", type="window")["context"]  # a new window has the focus, the first one not

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("browser.close")
            self.process.wait(5)
        except Exception:
            self.process.kill()
            self.process.wait()
        self.process.stderr.close()
        self.profile.cleanup()

    def call(self, method, **parameters):
        self.number += 1
        number = self.number
        self.socket.send(json.dumps({"id": number, "method": method, "params": parameters}).encode())
        while True:
            answer = json.loads(self.socket.receive())
            if answer.get("id") == number:
                if answer["type"] == "error":
                    raise RuntimeError(f"{method}: {answer['error']}: {answer['message']}")
                return answer["result"]
            self.take(answer)

    def take(self, event):
        kind, what = event.get("method"), event.get("params", {})
        if kind == "network.beforeRequestSent":
            self.requests.append(what["request"]["url"])
        elif kind == "log.entryAdded" and what["level"] in ("error", "warn"):
            self.log.append(f"{what['level']}: {what.get('text')}")

    def resize(self, width, height, scheme="light"):
        self.call("browsingContext.setViewport", context=self.context, viewport={"width": width, "height": height}, devicePixelRatio=1)

    def open(self, url, width=1200, height=900, scheme="light"):
        self.resize(width, height, scheme)
        self.call("browsingContext.navigate", context=self.context, url=url, wait="complete")

    def reload(self):
        self.call("browsingContext.reload", context=self.context, wait="complete")

    def ask(self, expression):
        """The value of an expression in the page; a promise is waited for."""
        answer = self.call("script.evaluate", expression=expression, target={"context": self.context}, awaitPromise=True, resultOwnership="none")
        if answer["type"] == "exception":
            raise RuntimeError(f"{expression}: {answer['exceptionDetails']['text']}")
        return plain(answer["result"])

    def act(self, kind, actions, **more):
        self.call("input.performActions", context=self.context, actions=[{"type": kind, "id": kind, "actions": actions, **more}])

    def mouse(self, kind, x, y):
        """`kind`: pressed, moved or released, with the left button."""
        actions = [{"type": "pointerMove", "x": round(x), "y": round(y)}]
        if kind != "moved":
            actions.append({"type": "pointerDown" if kind == "pressed" else "pointerUp", "button": 0})
        self.act("pointer", actions, parameters={"pointerType": "mouse"})

    def type(self, words):
        self.act("key", [{"type": kind, "value": letter} for letter in words for kind in ("keyDown", "keyUp")])

    def press(self, key, code=0, control=False, shift=False):
        held = [self.KEYS[name] for name, wanted in (("Control", control), ("Shift", shift)) if wanted]
        value = self.KEYS.get(key, key)
        self.act("key", [{"type": "keyDown", "value": one} for one in held] + [{"type": "keyDown", "value": value}, {"type": "keyUp", "value": value}] +
                 [{"type": "keyUp", "value": one} for one in reversed(held)])

    def screenshot(self, file):
        with open(file, "wb") as out:
            out.write(base64.b64decode(self.call("browsingContext.captureScreenshot", context=self.context)["data"]))
