"""A table for tests: every service of one station file, started again when the file changes, as coach-settings@ does."""
import os
import pathlib
import socket
import subprocess
import tempfile
import time
import urllib.request

SERVICES = ["detector", "pose-filter", "assembly-reasoner", "robot-bridge", "operator"]


def free_port():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return free.getsockname()[1]


def wait_for_page(url, seconds=30):
    """@raises OSError if it does not answer."""
    deadline = time.monotonic() + seconds
    while True:
        try:
            return urllib.request.urlopen(url, timeout=2).close()
        except OSError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.1)


class Station:
    """Runs inside tools/in-netns. The camera is a simulated child with a task of its own. Use as a context manager."""

    def __init__(self, programs, task, text="", child=()):
        self.programs = pathlib.Path(programs)
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="coach-station-"))
        self.file = self.folder / "station.yaml"
        self.file.write_text(text)
        self.port = free_port()
        self.child = ["--task", str(task), *child]
        self.children = {}

    @property
    def url(self):
        return f"http://127.0.0.1:{self.port}/"

    def __enter__(self):
        for name in ["simulated-child", *SERVICES]:
            self.start(name)
        try:
            wait_for_page(self.url)
        except OSError:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for child in self.children.values():
            child.terminate()
        for child in self.children.values():
            try:
                child.wait(5)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
        subprocess.run(["rm", "-rf", self.folder], check=False)

    def start(self, name):
        options = {"simulated-child": self.child, "operator": ["--port", str(self.port)],
                   "robot-bridge": ["--back-end", "log"]}.get(name, [])
        with open(self.folder / f"{name}.log", "ab") as log:
            self.children[name] = subprocess.Popen(
                [self.programs / f"coach-{name}", "--config", self.file, "--station", "T", *options],
                stdout=log, stderr=log, stdin=subprocess.DEVNULL, env={**os.environ, "OMP_NUM_THREADS": "1"})
        self.read = self.file.read_text()

    def tick(self):
        """Starts what runs with older settings again."""
        if self.file.read_text() == self.read:
            return
        for name in SERVICES[:-1]:
            child = self.children[name]
            child.terminate()
            child.wait(5)
            self.start(name)

    def log(self, name):
        return (self.folder / f"{name}.log").read_text(errors="replace")
