"""The virtual robot's page in a browser: it says, points, looks, stops, sleeps, in English and in Greek; and an
accessibility check by axe. Skipped (exit code 77) where there is no browser.

usage: page_test.py SERVER TASK WORK_FOLDER [SCREENSHOTS]"""
import json
import pathlib
import queue
import shutil
import subprocess
import sys
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "operator"))
from browser import Browser, missing  # noqa: E402

SERVER, TASK, WORK = sys.argv[1:4]
SCREENSHOTS = pathlib.Path(sys.argv[4]) if len(sys.argv) > 4 else None
PARTS = [[-0.2, 0.05, 0.3], [0.22, 0.1, 1.2], [0.05, -0.12, 0.0], [-0.1, 0.22, 2.0]]
ENGLISH = "Great! Now take the green brick and put it next to the long blue one."
CORRECTION = "Wait, that one goes to the other end."
GREEK = "Μπράβο! Τώρα πάρε το μπλε τουβλάκι και βάλε το εδώ."


def axe_source():
    """The text of axe-core, fetched from npm once; None where that can't be."""
    file = pathlib.Path(WORK) / "node_modules/axe-core/axe.min.js"
    if not file.exists() and shutil.which("npm"):
        subprocess.run(["npm", "install", "--silent", "--no-save", "--no-package-lock", "--prefix", WORK, "axe-core@4"],
                       timeout=90, check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return file.read_text() if file.exists() else None


class Robot:
    """The bridge's side."""

    def __init__(self):
        self.process = subprocess.Popen([SERVER, TASK], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()
        self.lines = queue.Queue()
        threading.Thread(target=lambda: [self.lines.put(line.strip()) for line in self.process.stdout], daemon=True).start()

    def order(self, **order):
        self.process.stdin.write(json.dumps(order) + "\n")
        self.process.stdin.flush()

    def wait_for(self, start, seconds=20):
        """The next line that starts so."""
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            try:
                line = self.lines.get(timeout=0.1)
            except queue.Empty:
                continue
            if line.startswith(start):
                return line
        raise TimeoutError(f"no '{start}' within {seconds} s")

    def end(self):
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()


class PageTest(unittest.TestCase):
    def setUp(self):
        self.robot = Robot()
        self.addCleanup(self.robot.end)
        self.browser = Browser(1280, 820)
        self.addCleanup(self.browser.__exit__, None, None, None)
        self.browser.open(self.robot.url)
        self.robot.order(scene={"parts": PARTS})
        self.browser.wait_for("return document.querySelector('#table').getAttribute('aria-label').includes('4')")

    def shoot(self, name):
        if SCREENSHOTS:
            SCREENSHOTS.mkdir(parents=True, exist_ok=True)
            self.browser.screenshot(SCREENSHOTS / f"{name}.png")

    def caption(self):
        return self.browser.run("return document.querySelector('#caption').textContent")

    def pixel(self, x, y):
        """Colour of the table's picture at a place of the table, m. The child sits at +y, so there is the picture's bottom."""
        return self.browser.run("""
            const c = document.querySelector('#table'), r = c.width / c.clientWidth;
            const scale = Math.min(c.clientWidth / 0.92, c.clientHeight / 0.96);
            const px = c.clientWidth / 2 - scale * arguments[0], py = c.clientHeight / 2 + scale * (0.14 + arguments[1]);
            return [...c.getContext('2d').getImageData(Math.round(px * r), Math.round(py * r), 1, 1).data]""", x, y)

    def wait_for_pixel(self, holds, what, place=(-0.2, 0.05), seconds=10):
        """The table is drawn with the browser's next picture, a moment after its description."""
        until = time.monotonic() + seconds
        while not holds(*self.pixel(*place)[:3]):
            self.assertLess(time.monotonic(), until, f"expected {what}, found the colour {self.pixel(*place)}")
            time.sleep(0.05)

    def test_says_points_and_looks_in_both_languages(self):
        self.robot.order(act={"id": 1, "language": "en", "text": ENGLISH, "point": [0.22, 0.1, 0.02],
                              "look": [0.22, 0.1, 0.02], "eyes": "green"})
        self.browser.wait_for("return document.querySelector('#caption').textContent === arguments[0]", 10, ENGLISH)
        self.browser.wait_for("const said = document.querySelectorAll('#caption .said').length; return said >= 5 && said < arguments[0]", 10, len(ENGLISH.split()))
        self.browser.wait_for("return document.querySelector('#robot').innerHTML.includes('#32af50')")  # the eyes
        self.browser.wait_for("return document.querySelector('#robot .finger')")
        self.shoot("point_english")
        self.assertEqual(self.robot.wait_for("1 done"), "1 done")
        self.robot.order(act={"id": 2, "language": "el", "text": GREEK, "point": [-0.2, 0.05, 0.02],
                              "look": [-0.2, 0.05, 0.02], "eyes": "blue"})
        self.browser.wait_for("return document.documentElement.lang === 'el'")
        self.assertEqual(self.browser.text("#help span"), "Θέλω βοήθεια")
        self.browser.wait_for("return document.querySelectorAll('#caption .said').length >= 4")
        self.shoot("point_greek")
        self.robot.wait_for("2 done")
        self.robot.order(act={"id": 3, "rest": True})
        self.robot.wait_for("3 done")
        self.browser.wait_for("return document.querySelector('#robot').innerHTML.includes('>z</text>')")
        self.browser.size(800, 1200)
        self.shoot("resting_portrait")
        self.assertEqual(self.browser.log(), [])

    def test_table_is_live(self):
        self.wait_for_pixel(lambda red, green, blue: blue > red + 60, "the blue part")
        self.robot.order(scene={"parts": [[0.3, -0.2, 0]] + PARTS[1:]})
        self.wait_for_pixel(lambda red, green, blue: red > blue, "wood, the part has gone")

    def test_robot_sits_opposite_the_child(self):
        """At its seat of the station file, which is on the camera's side: above, as the child sees it."""
        white = lambda red, green, blue: min(red, green, blue) > 200
        self.wait_for_pixel(white, "the robot", place=(0, -0.5))
        self.assertFalse(white(*self.pixel(0, 0.3)[:3]), "the child's side")

    def test_sound_needs_a_touch_and_the_page_tells(self):
        self.robot.order(act={"id": 1, "language": "en", "text": ENGLISH})
        self.browser.wait_for("return !document.querySelector('#sound').hidden || document.querySelector('#caption .said')")
        if self.browser.run("return !document.querySelector('#sound').hidden"):
            self.browser.click("#sound")
            self.browser.wait_for("return document.querySelector('#sound').hidden")
        self.robot.wait_for("1 done")

    def test_stop_silences_at_once(self):
        self.robot.order(act={"id": 1, "language": "en", "text": ENGLISH * 3})
        self.browser.wait_for("return document.querySelectorAll('#caption .said').length >= 3")
        self.robot.order(stop=True)
        self.assertIn("stopped", self.robot.wait_for("1 interrupted", 2))
        self.browser.wait_for("return document.querySelector('#caption').textContent === '…'")
        time.sleep(1)
        self.assertEqual(self.caption(), "…")

    def test_bubble_forgets_an_interrupted_sentence_before_the_correction_comes(self):
        self.robot.order(act={"id": 1, "language": "en", "text": ENGLISH * 3})
        self.browser.wait_for("return document.querySelectorAll('#caption .said').length >= 3")
        self.browser.run("""window.bubble = []; new MutationObserver(() => bubble.push(document.querySelector('#caption').textContent))
            .observe(document.querySelector('#caption'), {childList: true})""")
        self.robot.order(act={"id": 2, "language": "en", "text": CORRECTION, "look": [-0.3, 0.2, 0.02], "replaces": 1, "look_first": True})
        self.robot.wait_for("1 interrupted", 5)
        self.browser.wait_for("return document.querySelector('#caption').textContent === arguments[0]", 10, CORRECTION)
        self.assertEqual(self.browser.run("return bubble"), ["…", CORRECTION])
        self.robot.wait_for("2 done")
        self.assertEqual(self.caption(), CORRECTION)

    def test_help_button_and_fifty_clicks(self):
        self.browser.click("#help")
        self.robot.wait_for("help")
        self.browser.run("for (let i = 0; i < 50; ++i) document.querySelector('#help').click()")
        self.robot.order(act={"id": 1, "language": "en", "text": "Fine."})
        self.robot.wait_for("1 done")

    def test_script_in_a_text_is_text(self):
        self.robot.order(act={"id": 1, "language": "en", "text": "Hi <img src=x onerror=alert(1)> <b>you</b>"})
        self.browser.wait_for("return document.querySelector('#caption').textContent.startsWith('Hi')")
        self.assertEqual(self.browser.run("return document.querySelectorAll('#caption img, #caption b').length"), 0)

    def test_two_pages_and_a_reload_in_mid_sentence(self):
        with Browser(900, 600) as second:
            second.open(self.robot.url)
            self.robot.order(act={"id": 1, "language": "en", "text": ENGLISH, "eyes": "red"})
            second.wait_for("return document.querySelector('#caption').textContent === arguments[0]", 10, ENGLISH)
            second.open(self.robot.url)
            second.wait_for("return document.querySelector('#caption').textContent === arguments[0]", 10, ENGLISH)
            second.wait_for("return document.querySelector('#robot').innerHTML.includes('#e6322d')")
            self.robot.wait_for("1 done", 40)

    def test_bridge_gone_is_said_kindly(self):
        self.robot.end()
        self.browser.wait_for("return !document.querySelector('#offline').hidden")

    def test_accessibility(self):
        axe = axe_source()
        if axe is None:
            self.skipTest("axe-core can't be had from npm")
        for width, height, language in ((1280, 820, "en"), (800, 1200, "el"), (480, 800, "en")):
            self.browser.size(width, height)
            self.browser.open(self.robot.url + "?lang=" + language)
            self.browser.wait_for("return document.querySelector('#table').getAttribute('aria-label').includes('4')")
            self.browser.run(axe + "; window.axe = axe;")
            found = self.browser.run("return axe.run(document).then((r) => [r.passes.length, r.violations.map((v) => v.id + ': ' "
                                     "+ v.nodes.map((n) => n.html).join(' | '))])")
            print(f"axe, {width}x{height}, {language}: {found[0]} rules pass, {len(found[1])} are broken")
            self.assertEqual(found[1], [])
            self.assertEqual(self.browser.run("return document.documentElement.scrollWidth > innerWidth"), False)


if __name__ == "__main__":
    if missing():
        print(f"skipped: {missing()} is not installed")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
