"""A headless Chromium, driven over the DevTools protocol through a pair of pipes; standard library only."""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time


def program():
    """Its path, or None."""
    return next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


def axe_core(paths):
    """The source of axe-core at the first of these paths; None, and a word about it, where there is none."""
    if paths:
        with open(paths[0], encoding="utf-8") as file:
            return file.read()
    print("axe-core is not there (npm install axe-core, cmake -D AXE_JS=.../axe.min.js): accessibility by this test's own checks alone")
    return None


def barriers(page, axe):
    """What breaks a rule of WCAG 2.1 A and AA, or of good practice, that axe-core knows; nothing without it."""
    if not axe:
        return []
    page.ask(axe + "; 0")  # the page's own policy forbids nothing that comes by the debugger
    return page.ask("""axe.run(document, {runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'best-practice']}).then(r => r.violations.map(v =>
        [v.impact, v.id, v.nodes.length, v.nodes[0].html.slice(0, 140), v.nodes[0].failureSummary.slice(0, 200)]))""")


class Chromium:
    """One browser with one page. Keeps what the page logged, threw and asked the network for."""

    # WebGL by software, so that it is there on every machine; the page around it is put together without, which takes a
    # tenth of the time. No sandbox, since containers have none to offer.
    SCHEMES = ("light", "dark")
    FLAGS = ["--disable-gpu-compositing", "--headless", "--no-sandbox", "--no-first-run", "--disable-extensions", "--disable-background-networking",
             "--disable-dev-shm-usage", "--hide-scrollbars", "--use-gl=angle", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader", "--remote-debugging-pipe"]

    def __init__(self, seconds=60):
        self.end = time.monotonic() + seconds
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.log, self.requests, self.loaded, self.number, self.buffer = [], [], False, 0, b""
        to_browser, self.writer = os.pipe()
        self.reader, from_browser = os.pipe()

        def put_pipes():  # the browser reads from 3 and writes to 4
            low = [os.dup(to_browser), os.dup(from_browser)]
            safe = [fd if fd > 4 else os.dup(fd) for fd in low]
            os.dup2(safe[0], 3)
            os.dup2(safe[1], 4)

        self.process = subprocess.Popen([program(), *self.FLAGS, "--user-data-dir=" + self.profile.name, "about:blank"],
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                        close_fds=False, preexec_fn=put_pipes)
        os.close(to_browser)
        os.close(from_browser)
        self.session = None
        page = next(t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(domain + ".enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.session = None
            self.call("Browser.close")
            self.process.wait(5)
        except Exception:
            self.process.kill()
            self.process.wait()
        os.close(self.reader)
        os.close(self.writer)
        self.profile.cleanup()

    def call(self, method, **parameters):
        self.number += 1
        number = self.number
        message = {"id": number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.writer, data):]
        while True:
            answer = self.next_message()
            if answer.get("id") == number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.take(answer)

    def next_message(self):
        while b"\0" not in self.buffer:
            left = self.end - time.monotonic()
            if left <= 0 or not select.select([self.reader], [], [], left)[0]:
                raise TimeoutError("the browser did not answer in time")
            data = os.read(self.reader, 1 << 20)
            if not data:
                raise RuntimeError("the browser ended")
            self.buffer += data
        message, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(message)

    def take(self, event):
        kind, what = event.get("method"), event.get("params", {})
        if kind == "Page.loadEventFired":
            self.loaded = True
        elif kind == "Network.requestWillBeSent":
            self.requests.append(what["request"]["url"])
        elif kind == "Runtime.exceptionThrown":
            details = what["exceptionDetails"]
            self.log.append("exception: " + details.get("exception", {}).get("description", details["text"]))
        elif kind == "Runtime.consoleAPICalled" and what["type"] in ("error", "warning", "assert"):
            self.log.append(what["type"] + ": " + " ".join(str(a.get("value", a.get("description"))) for a in what["args"]))
        elif kind == "Log.entryAdded" and what["entry"]["level"] in ("error", "warning"):
            if "GPU stall due to ReadPixels" in what["entry"]["text"]:
                return  # how a canvas gets into a page that is put together without a GPU: our flag, not the page
            self.log.append(what["entry"]["level"] + ": " + what["entry"]["text"])

    def resize(self, width, height, scheme="light"):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def load(self, method, **parameters):
        self.loaded = False
        self.call(method, **parameters)
        while not self.loaded:
            self.take(self.next_message())

    def open(self, url, width=1200, height=900, scheme="light", script=True):
        self.resize(width, height, scheme)
        self.call("Emulation.setScriptExecutionDisabled", value=not script)
        self.load("Page.navigate", url=url)

    def reload(self):
        self.load("Page.reload")

    def ask(self, expression):
        """The value of an expression in the page; a promise is waited for."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{expression}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def move_mouse(self, x, y):
        self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)

    def mouse(self, kind, x, y):
        """`kind`: pressed, moved or released, with the left button."""
        self.call("Input.dispatchMouseEvent", type="mouse" + kind.capitalize(), x=x, y=y, button="left", buttons=1, clickCount=1)

    def type(self, words):
        self.call("Input.insertText", text=words)

    def press(self, key, code=0, control=False, shift=False):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key.upper() if shift else key, code=key, windowsVirtualKeyCode=code,
                      modifiers=2 * control + 8 * shift)

    def screenshot(self, file, clip=None):
        more = {"clip": dict(zip(("x", "y", "width", "height"), clip), scale=1), "captureBeyondViewport": True} if clip else {}
        data = self.call("Page.captureScreenshot", format="png", **more)["data"]
        with open(file, "wb") as out:
            out.write(base64.b64decode(data))

    def print(self, file):
        with open(file, "wb") as out:
            out.write(base64.b64decode(self.call("Page.printToPDF", printBackground=False, paperWidth=8.27, paperHeight=11.69)["data"]))
