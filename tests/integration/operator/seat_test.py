"""The seat of a robot with arms, measured from the set-up page in a browser, against the fake NAO and a drawn tracker: it
is found and kept in the station file, in English and in Greek; STOP holds the arm. Skipped (exit code 77) where there is
no browser. Run inside tools/in-netns."""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import urllib.request

from browser import Browser, missing
from page_test import AUDIT, ESCAPE
from station import free_port, wait_for_page

PROGRAMS, TASK, HELD_PART = sys.argv[1:4]
SCREENSHOTS = pathlib.Path(sys.argv[4]) if len(sys.argv) > 4 else None
TRUTH = (6.0, -48.0, 5.0)  # cm; of held_part.cpp


class SeatTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="coach-seat-")
        self.addCleanup(folder.cleanup)
        self.file = pathlib.Path(folder.name) / "station.yaml"
        robot = subprocess.Popen([HELD_PART], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (robot.communicate(timeout=10), None))
        self.robot = robot
        self.file.write_text(f"task: {TASK}\nrobot:\n  back_end: nao\n  nao: {{url: \"{robot.stdout.readline().strip()}\"}}\n")
        port = free_port()
        self.url = f"http://127.0.0.1:{port}/"
        page = subprocess.Popen([pathlib.Path(PROGRAMS) / "coach-operator", "--config", self.file, "--station", "T", "--port", str(port)],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(lambda: (page.terminate(), page.wait(5)))
        wait_for_page(self.url)

    def open(self, language):
        page = Browser(1366, 900, language)
        self.addCleanup(page.__exit__, None, None, None)
        page.open(self.url + "#setup")
        page.wait_for("return document.querySelector('.wizard-step[data-focus=robot]')")
        page.click(".wizard-step[data-focus=robot]")
        page.wait_for("return document.querySelector('#setup-arm-start:not([disabled])')")
        self.assertEqual(page.run(AUDIT), [])
        return page

    def shoot(self, page, name):
        if SCREENSHOTS:
            page.screenshot(SCREENSHOTS / f"seat_{name}.png")

    def measured(self, language):
        page = self.open(language)
        self.shoot(page, f"before_{language}")
        page.click("#setup-arm-start")
        page.wait_for("return document.querySelectorAll('.poses .made').length >= 3", 60)
        self.assertEqual(page.run(AUDIT), [])
        self.shoot(page, f"moving_{language}")
        page.wait_for("return document.querySelector('#setup-arm-accept')", 90)
        self.assertEqual(page.run(AUDIT), [])
        self.shoot(page, f"measured_{language}")
        return page

    def seat(self, page):
        return [float(page.run("return document.querySelector(arguments[0]).value", f"#seat-{axis}")) for axis in "xyz"]

    def test_is_found_and_kept_if_the_teacher_says_so(self):
        page = self.measured("el")
        before = self.seat(page)
        page.click("#setup-arm-keep")
        page.wait_for("return !document.querySelector('#setup-arm-keep')")
        self.assertEqual(self.seat(page), before)
        self.assertNotIn("position", self.file.read_text())
        self.assertEqual(page.log(), [])
        page = self.open("en")  # the result is still there
        page.wait_for("return document.querySelector('#setup-arm-accept')")
        self.shoot(page, "measured_en")
        page.click("#setup-arm-accept")
        page.wait_for("return !document.querySelector('#setup-arm-accept')")
        for found, true in zip(self.seat(page), TRUTH):
            self.assertAlmostEqual(found, true, delta=0.4)
        page.click("#setup-next")
        page.wait_for("return document.querySelector('.wizard-step[aria-current]').dataset.focus === 'sound'")
        written = re.search(r"position: \[(.*?)\]", self.file.read_text())[1].split(",")
        for metres, true in zip(written, TRUTH):
            self.assertAlmostEqual(100 * float(metres), true, delta=0.4)
        self.assertTrue(self.file.with_suffix(".yaml.1").exists())
        self.assertEqual(page.log(), [])

    def test_stop_holds_the_arm(self):
        page = self.open("en")
        page.click("#setup-arm-start")
        page.wait_for("return document.querySelectorAll('.poses .made').length >= 1", 60)
        request = urllib.request.Request(self.url + "api/setup/calibrate", b'{"part": 0, "arm": "right", "url": "tcp://127.0.0.1:1"}', {"X-Coach": "1"})
        with self.assertRaises(urllib.error.HTTPError) as refused:
            urllib.request.urlopen(request, timeout=5)
        self.assertIn("busy", refused.exception.read().decode())
        refused.exception.close()
        page.press(ESCAPE)
        page.wait_for("return document.querySelector('#setup-content .verdict.bad')?.innerText.startsWith('Stopped')", 5)
        self.shoot(page, "stopped_en")
        self.assertNotIn("position", self.file.read_text())


if __name__ == "__main__":
    if missing():
        print(f"skipped: {missing()} is not installed")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
