"""A task learned from the table: a simulated child builds a toy once, the tracker follows its parts knowing nothing of
connections, and the task made by `coach-task learn` and the one made through the page have the connection that was built,
within 5 mm and 5 degrees. Skipped (exit code 77) where there is no browser. Run inside tools/in-netns."""
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

from browser import Browser, missing
from station import free_port, wait_for_page

PROGRAMS, TASK = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
SCREENSHOTS = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
FPS, SECONDS = 12, 24
CORNER = """slots:
  - {name: a, type: long}
  - {name: b, type: medium}
connections:
  - {name: corner, slots: [a, b], rotation: [0, -1, 0, 1, 0, 0, 0, 0, 1], translation: [75, 45, 0]}
steps: [corner]
"""
HALF_TURN = [-1, 0, 0, 0, 1, 0, 0, 0, -1]  # of either brick, about its y: it looks the same


def product(a, b):
    return [sum(a[3 * i + k] * b[3 * k + j] for k in range(3)) for i in range(3) for j in range(3)]


def transposed(a):
    return [a[3 * j + i] for i in range(3) for j in range(3)]


def turned(a, v):
    return [sum(a[3 * i + k] * v[k] for k in range(3)) for i in range(3)]


def difference(found, true):
    """(mm, degrees) between two relative poses of the bricks (rotation, translation), however either was turned."""
    identity = [1, 0, 0, 0, 1, 0, 0, 0, 1]
    best = (math.inf, math.inf)
    for a in (identity, HALF_TURN):
        for b in (identity, HALF_TURN):
            R, t = product(a, product(true[0], b)), turned(a, true[1])
            trace = sum(product(transposed(R), found[0])[k] for k in (0, 4, 8))
            best = min(best, (math.dist(t, found[1]), math.degrees(math.acos(max(-1, min(1, (trace - 1) / 2))))), key=sum)
    return best


class LearnTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="coach-learn-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.children = []
        self.addCleanup(self.end)

    def end(self):
        for child in self.children:
            child.terminate()
        for child in self.children:
            child.wait(10)

    def start(self, name, *options):
        with open(self.folder / f"{name}.log", "wb") as log:
            self.children.append(subprocess.Popen([PROGRAMS / f"coach-{name}", "--config", self.folder / "station.yaml", *options],
                                                  stdout=log, stderr=log, stdin=subprocess.DEVNULL, env={**os.environ, "OMP_NUM_THREADS": "1"}))
        return self.children[-1]

    def film(self):
        """A child builds the corner once. @return when its hand has gone, s"""
        loose = TASK.read_text()
        loose = loose[:loose.index("slots:")].replace("count: 2", "count: 1").replace("mesh: meshes", f"mesh: {TASK.parent}/meshes")
        (self.folder / "corner.yaml").write_text(loose + CORNER)
        subprocess.run([PROGRAMS / "coach-simulate", self.folder / "film", "--task", self.folder / "corner.yaml", "--mistakes", "0", "--style", "hasty",
                        "--seed", "2", "--fps", str(FPS), "--seconds", str(SECONDS), "--width", "384", "--height", "288"], check=True, stdout=subprocess.DEVNULL)
        coloured = (self.folder / "film/task.yaml").read_text()
        (self.folder / "film/loose.yaml").write_text(coloured[:coloured.index("slots:")])
        return json.loads((self.folder / "film/events.json").read_text())["events"][-1]["time"]

    def truth(self):
        """The medium brick in the long one at the end."""
        last = json.loads((self.folder / "film/scene_gt.json").read_text())
        long, medium = sorted(last[max(last, key=int)], key=lambda part: part["obj_id"])
        back = transposed(long["cam_R_m2c"])
        return product(back, medium["cam_R_m2c"]), turned(back, [m - l for m, l in zip(medium["cam_t_m2c"], long["cam_t_m2c"])])

    def check(self, file):
        connections = re.findall(r"- \{name: \w+, slots: \[(\w+), (\w+)\], rotation: \[(.*?)\], translation: \[(.*?)\]\}", file.read_text())
        self.assertEqual([connection[:2] for connection in connections], [("long_1", "medium_1")], file.read_text())
        numbers = [[float(number) for number in text.split(",")] for text in connections[0][2:]]
        millimetres, degrees = difference(numbers, self.truth())
        print(f"{file.stem}: the learned connection is {millimetres:.2f} mm and {degrees:.2f} degrees from the true one")
        self.assertLess(millimetres, 5)
        self.assertLess(degrees, 5)

    def test_a_toy_built_once_becomes_a_task(self):
        built = self.film()
        self.assertLess(built, SECONDS - 6)
        (self.folder / "station.yaml").write_text("station: T\ntask: film/loose.yaml\nstate_folder: state\n")
        (self.folder / "state").mkdir()
        port = free_port()
        self.start("operator", "--port", str(port))
        wait_for_page(f"http://127.0.0.1:{port}/")
        for name in ("detector", "pose-filter"):
            self.start(name)
        with Browser(1366, 900) as page:
            page.open(f"http://127.0.0.1:{port}/#new")
            page.wait_for("return document.querySelector('[data-focus=way-table]')")
            page.click("[data-focus=way-table]")
            film = self.start("capture", "--source", f"scene:{self.folder / 'film'}", "--fps", str(FPS))
            page.wait_for("return document.querySelector('#camera-note').hidden", 30)
            time.sleep(built + 0.5)
            by_program = subprocess.run([PROGRAMS / "coach-task", "learn", "by_program", "--config", self.folder / "station.yaml", "--folder", self.folder / "made"],
                                        capture_output=True, text=True, timeout=90)
            self.assertEqual(by_program.returncode, 0, by_program.stderr)
            self.check(self.folder / "made/by_program.yaml")
            film.wait(60)
            page.type("#new-name", "by_page")
            page.click("#new-check")
            page.wait_for("return document.querySelector('#new-content .verdict.good')?.innerText.startsWith('Parts: 2. Connections: 1.')", 20)
            page.click("#new-save")
            page.wait_for("return document.querySelector('#new-content a[href^=\"api/task/book\"]')", 20)
            if SCREENSHOTS:
                page.screenshot(SCREENSHOTS / "learned.png")
            self.assertEqual([line for line in page.log() if "503" not in line], [])
            self.check(self.folder / "state/tasks/by_page.yaml")


if __name__ == "__main__":
    if missing():
        print(f"skipped: {missing()} is not installed")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
