"""A browser for tests: chromium driven by chromedriver over WebDriver, with Python's standard library only."""
import base64
import json
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request

FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage"]

NARROWEST = 500  # px, of a window


def missing():
    """What a machine lacks for these tests; empty if nothing."""
    return " and ".join(name for name in ("chromedriver", "chromium") if not shutil.which(name))


class Browser:
    """One window. Use as a context manager: both processes end with it."""

    def __init__(self, width=1440, height=900, language="en"):
        self._profile = tempfile.TemporaryDirectory(prefix="coach-browser-")
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        self._driver = subprocess.Popen(["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self._url = f"http://127.0.0.1:{port}"
        options = {"args": FLAGS + [f"--user-data-dir={self._profile.name}", f"--window-size={width},{height}", f"--lang={language}"],
                   "prefs": {"intl.accept_languages": language}}
        deadline = time.monotonic() + 20
        while True:
            try:
                session = self._call("POST", "/session", {"capabilities": {"alwaysMatch": {
                    "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}})
                break
            except (ConnectionError, urllib.error.URLError):
                if time.monotonic() > deadline:
                    raise
                time.sleep(0.1)
        self._session = "/session/" + session["sessionId"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self._call("DELETE", self._session)
        except OSError:
            pass
        self._driver.terminate()
        self._driver.wait(10)
        self._profile.cleanup()

    def _call(self, method, path, body=None):
        request = urllib.request.Request(self._url + path, method=method, data=None if body is None else json.dumps(body).encode(),
                                         headers={"Content-Type": "application/json"})
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"].splitlines()[0]) from None

    def open(self, url):
        self._call("POST", self._session + "/url", {"url": url})

    def run(self, script, *arguments):
        """The value that a script returns; arguments[0], arguments[1] ... in the script."""
        return self._call("POST", self._session + "/execute/sync", {"script": script, "args": list(arguments)})

    def _on_element(self, selector, command, body):
        for attempt in range(5):
            element = self._call("POST", self._session + "/element", {"using": "css selector", "value": selector})
            try:
                return self._call("POST", self._session + f"/element/{next(iter(element.values()))}/{command}", body)
            except RuntimeError as error:  # drawn anew between finding it and using it
                if "stale" not in str(error) or attempt == 4:
                    raise

    def click(self, selector):
        self._on_element(selector, "click", {})

    def type(self, selector, text):
        self._on_element(selector, "value", {"text": text})

    def press(self, key):
        self._call("POST", self._session + "/actions", {"actions": [{"type": "key", "id": "keyboard", "actions": [
            {"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}]}]})

    def text(self, selector):
        return self.run("return document.querySelector(arguments[0])?.innerText ?? null", selector)

    def wait_for(self, script, seconds=15, *arguments):
        """Waits until a script returns something true and returns it. @raises TimeoutError with the script."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            value = self.run(script, *arguments)
            if value:
                return value
            time.sleep(0.1)
        raise TimeoutError(f"after {seconds} s still not true: {script} {arguments}")

    def size(self, width, height):
        """Returns when the page has been laid out for it."""
        self._call("POST", self._session + "/window/rect", {"width": width, "height": height})
        self.wait_for("return outerWidth === arguments[0] && outerHeight === arguments[1]", 10, max(width, NARROWEST), height)
        self._call("POST", self._session + "/execute/async", {"script": "requestAnimationFrame(() => requestAnimationFrame(arguments[0]))", "args": []})

    def screenshot(self, file):
        with open(file, "wb") as out:
            out.write(base64.b64decode(self._call("GET", self._session + "/screenshot")))

    def log(self):
        """Messages of the browser's console so far: errors of scripts, refused requests."""
        return [entry["message"] for entry in self._call("POST", self._session + "/se/log", {"type": "browser"})
                if entry["level"] == "SEVERE"]
