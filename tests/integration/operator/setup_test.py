"""From an empty station file to a running lesson, through the page in a browser, at a simulated table: every click is
counted, the time taken. Skipped (exit code 77) where there is no browser. Run inside tools/in-netns."""
import pathlib
import sys
import time
import unittest

from browser import Browser, missing
from page_test import AUDIT
from station import Station

PROGRAMS, TASK = sys.argv[1:3]
SCREENSHOTS = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None


class Teacher:
    """Does what a teacher does, and counts it."""

    def __init__(self, page, station, language):
        self.page, self.station, self.language, self.clicks = page, station, language, 0

    def click(self, selector):
        self.page.run("document.querySelector(arguments[0]).scrollIntoView({block: 'center'})", selector)
        self.page.click(selector)
        self.clicks += 1

    def wait_for(self, script, seconds=20, *arguments):
        deadline = time.monotonic() + seconds
        while True:
            self.station.tick()
            try:
                return self.page.wait_for(script, 0.5, *arguments)
            except TimeoutError:
                if time.monotonic() > deadline:
                    self.screenshot("failed")
                    for name in self.station.children:
                        print(f"--- {name}\n" + "\n".join(self.station.log(name).splitlines()[-5:]))
                    print(self.station.file.read_text())
                    raise

    def step_is(self, name):
        self.wait_for("return document.querySelector('.wizard-step[aria-current]')?.dataset.focus === arguments[0]", 10, name)

    def done(self, name, seconds=20):
        self.wait_for("return document.querySelector(`.wizard-step[data-focus='${arguments[0]}']`).classList.contains('done')", seconds, name)

    def screenshot(self, name):
        if SCREENSHOTS:
            self.page.screenshot(SCREENSHOTS / f"setup_{name}_{self.language}.png")

    def click_picture(self, x, y):
        """A pixel of the camera's picture."""
        self.page.run("""const c = document.querySelector('#camera-canvas'), b = c.getBoundingClientRect();
            c.dispatchEvent(new MouseEvent('click', {clientX: b.left + (arguments[0] + 0.5) / c.width * b.width,
                clientY: b.top + (arguments[1] + 0.5) / c.height * b.height, bubbles: true}))""", x, y)
        self.clicks += 1


WORDS = {"en": {"new": "new", "seat": "The seat is known", "ready": "Ready to start"},
         "el": {"new": "νέο", "seat": "Η θέση είναι γνωστή", "ready": "Έτοιμο για έναρξη"}}

# Somewhere inside the largest patch of one colour on the table: [x, y]. A person sees it.
PATCH = """
const c = document.querySelector('#camera-canvas'), bitmap = document.createElement('canvas').getContext('2d');
bitmap.canvas.width = c.width; bitmap.canvas.height = c.height; bitmap.drawImage(c, 0, 0);
const {data} = bitmap.getImageData(0, 0, c.width, c.height), like = {blue: (r, g, b) => b > 1.6 * r && b > 1.25 * g, green: (r, g, b) => g > 1.25 * r && g > 1.25 * b}[arguments[0]];
const at = (x, y) => { const k = 4 * (y * c.width + x); return like(data[k], data[k + 1], data[k + 2]) && Math.max(data[k], data[k + 1], data[k + 2]) > 40; };
let best = null, most = 0;
for (let y = Math.round(0.42 * c.height); y < c.height - 20; y += 4) for (let x = 20; x < c.width - 20; x += 4) {
  let count = 0;
  for (let v = -8; v <= 8; v += 2) for (let u = -8; u <= 8; u += 2) count += at(x + u, y + v);
  if (count > most) [most, best] = [count, [x, y]];
}
return most > 20 ? best : null;
"""


class SetUpTest(unittest.TestCase):
    def test_from_an_empty_station_file_to_a_running_lesson_in_english(self):
        self.from_an_empty_station_file_to_a_running_lesson("en")

    def test_from_an_empty_station_file_to_a_running_lesson_in_greek(self):
        self.from_an_empty_station_file_to_a_running_lesson("el")

    def from_an_empty_station_file_to_a_running_lesson(self, language):
        started = time.monotonic()
        with Station(PROGRAMS, TASK, child=["--fps", "6", "--seed", "5"]) as station, Browser(1366, 900, language) as page:
            teacher = Teacher(page, station, language)
            page.open(station.url)
            page.wait_for("return document.querySelector('#camera-note').hidden", 20)
            teacher.click("[data-page='setup']")
            self.set_up(teacher, page, station)
            teacher.click("#setup-next")
            teacher.wait_for("return location.hash === '#lesson' && document.querySelector('#phase').innerText === arguments[0]", 30, WORDS[language]["ready"])
            teacher.wait_for("return !document.querySelector('#health-dot.failed')", 30)
            teacher.click("#start")
            teacher.wait_for("return document.querySelectorAll('#acts li').length >= 2", 30)
            teacher.screenshot("lesson")
            print(f"set-up: {teacher.clicks} clicks, {time.monotonic() - started:.0f} s by a machine that does not read")
            teacher.wait_for("return document.querySelectorAll('#connections .badge.made').length >= 1", 90)
            self.assertLess(teacher.clicks, 30)
            self.assertEqual([line for line in page.log() if "ERR_" not in line and "503" not in line], [])

    def set_up(self, teacher, page, station):
        teacher.step_is("camera")
        teacher.done("camera")
        self.assertEqual(page.run(AUDIT), [])
        teacher.screenshot("camera")
        teacher.click("#setup-next")

        places = {colour: page.wait_for(PATCH, 10, colour) for colour in ("blue", "green")}  # before the rest is grey
        teacher.click(f"input[name='setup-task'][value='{pathlib.Path(TASK).stem}']")
        teacher.done("task")
        self.assertEqual(page.run(AUDIT), [])
        teacher.screenshot("task")
        teacher.click("#setup-next")

        teacher.step_is("colours")
        for colour, place in places.items():
            teacher.click(f"input[name='setup-colour'][value='{colour}']")
            teacher.click_picture(*place)
            page.wait_for("return document.querySelector('#setup-content .verdict.good')", 10)
        teacher.wait_for("return [...document.querySelectorAll('#setup-content .tag')].every((tag) => tag.innerText === arguments[0])", 10, WORDS[teacher.language]["new"])
        self.assertEqual(page.run(AUDIT), [])
        teacher.screenshot("colours")
        teacher.click("#setup-next")

        teacher.step_is("parts")
        teacher.done("parts", 40)
        self.assertEqual(page.run(AUDIT), [])
        teacher.screenshot("parts")
        teacher.click("#setup-next")

        teacher.step_is("robot")
        self.assertEqual(page.run(AUDIT), [])
        teacher.wait_for("return !document.querySelector('#setup-measure').disabled")
        teacher.click("#setup-measure")
        page.wait_for("return document.querySelector('#setup-content').innerText.includes(arguments[0])", 10, WORDS[teacher.language]["seat"])
        teacher.screenshot("robot")
        teacher.click("#setup-next")
        teacher.done("robot")

        teacher.click("[data-focus='say']")
        teacher.click("#setup-heard")
        teacher.done("sound")
        self.assertEqual(page.run(AUDIT), [])
        teacher.screenshot("sound")
        text = station.file.read_text()
        for word in ("task:", "colours:", "blue", "green", "position:", "volume:", "state_folder:"):
            self.assertIn(word, text)
        self.assertTrue(station.file.with_suffix(".yaml.1").exists(), "the version before is kept")


if __name__ == "__main__":
    if missing():
        print(f"skipped: {missing()} is not installed")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
