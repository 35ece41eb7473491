"""A new task through the page: a finished model is sent, understood, given a colour and saved, with its picture book; then
bad files. Skipped (exit code 77) where there is no browser. Run inside tools/in-netns."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import urllib.request

from browser import Browser, missing
from page_test import AUDIT
from station import Station

PROGRAMS, TASK = sys.argv[1:3]
SCREENSHOTS = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None


def model():
    """Three bricks in a row, two of them equal, as an OBJ in mm."""
    lines, first = [], 1
    for name, x, length in (("long.001", 0, 90), ("short.001", 65, 40), ("long.002", 130, 90)):
        lines.append(f"o {name}")
        for corner in range(8):
            lines.append("v {} {} {}".format(x + length * ((corner & 1) - 0.5), 30 * ((corner >> 1 & 1) - 0.5), 30 * (corner >> 2)))
        for quad in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
            lines.append("f " + " ".join(str(first + k) for k in quad))
        first += 8
    return "\n".join(lines) + "\n"


class NewTaskTest(unittest.TestCase):
    def post(self, url, body, status):
        request = urllib.request.Request(url, body, {"X-Coach": "1", "Content-Type": "application/octet-stream"})
        try:
            with urllib.request.urlopen(request, timeout=30) as answer:
                self.assertEqual(answer.status, status)
                return json.load(answer)
        except urllib.error.HTTPError as error:
            self.assertEqual(error.code, status)
            return json.load(error)

    def test_from_a_model_to_a_picture_book(self):
        with Station(PROGRAMS, TASK, f"task: {TASK}\nstate_folder: state\n", child=["--fps", "2"]) as station, Browser(1366, 900) as page, \
                tempfile.TemporaryDirectory() as folder:
            (station.folder / "state").mkdir(exist_ok=True)
            file = pathlib.Path(folder) / "row of three.obj"
            file.write_text(model())
            page.open(station.url + "#new")
            page.wait_for("return document.querySelector('#new-files')")
            self.assertEqual(page.run(AUDIT), [])
            page.type("#new-files", str(file))
            page.wait_for("return document.querySelector('#new-picture img') && document.querySelector('#new-content .verdict.good')", 20)
            self.assertIn("Parts: 3. Connections: 2.", page.text("#new-content"))
            self.assertEqual(page.run(AUDIT), [])
            if SCREENSHOTS:
                page.screenshot(SCREENSHOTS / "new_task.png")
            page.run("const n = document.querySelector('#new-name'); n.value = '<img src=x onerror=alert(1)> row'; n.dispatchEvent(new Event('change'))")
            page.click("#new-save")
            page.wait_for("return document.querySelector('#new-content a[href^=\"api/task/book\"]')", 20)
            made = page.run("return decodeURIComponent(document.querySelector('#new-content a').search.slice(6))")
            self.assertRegex(made, r"^[\w-]+$", "a name of letters, digits, - and _")
            self.assertEqual(page.log(), [])
            with urllib.request.urlopen(f"{station.url}api/task/book?name={made}", timeout=30) as answer:
                book = answer.read().decode()
            self.assertEqual(len(re.findall("<svg", book)), 4, "cover, two steps, the whole")
            checked = subprocess.run([pathlib.Path(PROGRAMS) / "coach-task", "check", station.folder / "state/tasks" / f"{made}.yaml"], capture_output=True, text=True)
            self.assertEqual((checked.returncode, checked.stderr), (0, ""))
            self.assertIn("2 part types, 3 parts, 2 connections, 2 steps", checked.stdout)
            self.deleted_while_running(station, made)
            self.bad_input(station)

    def deleted_while_running(self, station, name):
        """The page goes on and says what is wrong."""
        self.post(f"{station.url}api/setup/save", json.dumps({"task": name}).encode(), 200)
        (station.folder / "state/tasks" / f"{name}.yaml").unlink()
        with urllib.request.urlopen(f"{station.url}api/setup", timeout=10) as answer:
            self.assertIn(name, json.load(answer)["task"]["problem"])
        with urllib.request.urlopen(f"{station.url}api/task", timeout=10) as answer:
            self.assertEqual(json.load(answer)["name"], "rectangle_long_medium", "the lesson that runs is not disturbed")
        self.post(f"{station.url}api/setup/save", json.dumps({"task": "square"}).encode(), 200)

    def bad_input(self, station):
        mesh = f"{station.url}api/task/mesh?name="
        for name, body in (("a.obj", b"v 0 0 0\nf 1 2 3\n"), ("a.stl", b"solid"), ("a.glb", b"glTF\0\0"), ("a.exe", b"MZ"), ("..%2Fa.obj", b"v")):
            self.assertTrue(self.post(mesh + name, body, 400)["error"], name)
        self.post(f"{station.url}api/task/make", b"{", 400)
        doubts = self.post(f"{station.url}api/task/make", b'{"name": "x", "table": true}', 200)["doubts"]
        self.assertEqual(doubts[0]["kind"], "unseen", "the camera is too slow to learn from")
        self.post(f"{station.url}api/setup/save", b'{"robot": {"volume": 99}}', 400)
        request = urllib.request.Request(f"{station.url}api/setup/save", b"{}")
        with self.assertRaises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(request, timeout=5)
        self.assertEqual(refused.exception.code, 403, "another site's page can't change the settings")
        refused.exception.close()
        with self.assertRaises(urllib.error.HTTPError) as missing_task:
            urllib.request.urlopen(f"{station.url}api/task/book?name=gone", timeout=5)
        self.assertEqual(missing_task.exception.code, 400)
        missing_task.exception.close()


if __name__ == "__main__":
    if missing():
        print(f"skipped: {missing()} is not installed")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
