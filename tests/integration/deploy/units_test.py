"""The systemd units, checked without a running systemd: `verify` is silent, `security` is at most 2.0, every unit starts a
program that is built. Skipped (exit code 77) where systemd-analyze is missing."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

UNITS, PROGRAMS = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
EXPOSURE = 2.0
SYSTEM = pathlib.Path("/lib/systemd/system")


def instances():
    """Every service and target, templates as those of the table T1."""
    return sorted(file.name.replace("@.", "@T1.") for file in UNITS.iterdir() if file.suffix in (".service", ".target", ".timer", ".path"))


def programs():
    """Unit file -> the program of ours that it starts."""
    found = {}
    for file in UNITS.glob("*.service"):
        match = re.search(r"^ExecStart=/usr/bin/(coach-\S+)", file.read_text(), re.M)
        if match:
            found[file.name] = match.group(1)
    return found


class UnitsTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stage = tempfile.TemporaryDirectory(prefix="coach-units-")
        cls.root = pathlib.Path(cls.stage.name)
        units = cls.root / "usr/lib/systemd/system"
        shutil.copytree(UNITS, units)
        for target in SYSTEM.glob("*.target"):
            shutil.copy(target, units)
        for program in [*(cls.root / "usr/bin" / name for name in programs().values()), cls.root / "usr/sbin/ip", cls.root / "usr/bin/find", cls.root / "usr/bin/systemctl"]:
            program.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy("/usr/bin/true", program)

    @classmethod
    def tearDownClass(cls):
        cls.stage.cleanup()

    def analyze(self, *arguments):
        done = subprocess.run(["systemd-analyze", f"--root={self.root}", *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        return done.returncode, done.stdout

    def test_verify_is_silent(self):
        self.assertEqual(self.analyze("verify", "--man=no", *instances()), (0, ""))

    def test_a_misspelt_key_would_be_noticed(self):
        broken = self.root / "usr/lib/systemd/system/coach-broken@.service"
        broken.write_text((UNITS / "coach-detector@.service").read_text().replace("WatchdogSec", "WatchdogSecs"))
        self.assertIn("WatchdogSecs", self.analyze("verify", "--man=no", "coach-broken@T1.service")[1])
        broken.unlink()

    def test_exposure(self):
        for unit in instances():
            if unit.endswith(".service"):
                code, report = self.analyze("security", "--offline=true", f"--threshold={EXPOSURE * 10:.0f}", unit)
                level = re.search(r"exposure level for \S+: (\S+)", report)
                self.assertIsNotNone(level, report)
                print(f"{unit}: exposure {level.group(1)}")
                self.assertEqual(code, 0, report[-200:])

    def test_every_unit_starts_a_program_that_is_built(self):
        self.assertGreaterEqual(len(programs()), 7)
        for unit, program in programs().items():
            self.assertTrue((PROGRAMS / program).exists(), f"{unit}: {PROGRAMS / program}")

    def test_the_example_station_names_no_key_that_a_service_does_not_know(self):
        station = UNITS.parent / "station.yaml"
        # Without a network every program ends with 4, "bus unusable"; a mistake in the file would be 2.
        for program in ("coach-capture", "coach-operator", "coach-record"):
            done = subprocess.run([PROGRAMS / program, "--config", station, "--lcm-url", "udpm://0.0.0.0:1"], capture_output=True, text=True, timeout=20)
            self.assertEqual(done.returncode, 4, done.stderr)

    def test_the_camera_keeps_its_devices_though_the_shared_rules_take_them(self):
        code, text = self.analyze("cat-config", "systemd/system/coach-capture@.service.d/60-camera.conf")
        self.assertEqual(code, 0, text)
        self.assertIn("PrivateDevices=no", text)
        self.assertLess("50-hardening.conf", "60-camera.conf", "drop-ins are read in this order")


if __name__ == "__main__":
    if not shutil.which("systemd-analyze") or not SYSTEM.exists():
        print("skipped: systemd is not installed")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
