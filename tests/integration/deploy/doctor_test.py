"""coach-doctor finds each trouble and names a command that mends it."""
import importlib.machinery
import importlib.util
import pathlib
import sys
import tempfile
import unittest

loader = importlib.machinery.SourceFileLoader("doctor", sys.argv[1])
doctor = importlib.util.module_from_spec(importlib.util.spec_from_loader("doctor", loader))
loader.exec_module(doctor)

STATION = 'station: T1\ntask: /usr/share/coach/tasks/a.yaml\ncamera:\n  source: "openni2:"  # any\npage:\n  address: 127.0.0.1\n'


class DoctorTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        self.write("proc/sys/net/core/rmem_max", "8388608\n")
        self.write("sys/bus/usb/devices/1-2/idVendor", "1d27\n")
        self.write("usr/share/coach/tasks/a.yaml", "")
        self.write("etc/coach/T1/station.yaml", STATION)
        self.disk, doctor.FREE_GB = doctor.FREE_GB, 0

    def tearDown(self):
        doctor.FREE_GB = self.disk
        self.folder.cleanup()

    def write(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def findings(self, tables=("T1",)):
        found = list(doctor.examine(self.root, list(tables), ""))
        for what, mend in found:
            self.assertTrue(what and mend)
        return [what for what, _ in found]

    def test_a_sound_system_has_no_findings(self):
        self.assertEqual(self.findings(), [])

    def test_each_trouble_is_one_finding(self):
        for path, text, words in (
                ("proc/sys/net/core/rmem_max", "212992", "receive buffers are limited to 212992"),
                ("sys/bus/usb/devices/1-2/idVendor", "8087", "no depth camera"),
                ("etc/coach/T1/station.yaml", STATION.replace("a.yaml", "b.yaml"), "b.yaml is missing"),
                ("etc/coach/T1/station.yaml", STATION.replace("127.0.0.1", "0.0.0.0"), "without a token")):
            self.tearDown()
            self.setUp()
            self.write(path, text)
            found = self.findings()
            self.assertEqual(len(found), 1, found)
            self.assertIn(words, found[0])

    def test_no_table_and_a_table_without_file(self):
        self.assertIn("no table is set up", self.findings([]))
        self.assertTrue(any("T9/station.yaml is missing" in what for what in self.findings(["T9"])))

    def test_a_recording_needs_no_camera(self):
        self.write("etc/coach/T1/station.yaml", STATION.replace("openni2:", "scene:/data"))
        self.write("sys/bus/usb/devices/1-2/idVendor", "8087")
        self.assertEqual(self.findings(), [])

    def test_a_full_disk(self):
        doctor.FREE_GB = 1e9
        self.assertTrue(any("free for recordings" in what for what in self.findings()))

    def test_routes_and_clocks_as_the_system_prints_them(self):
        self.assertIsNone(doctor.route_problem("multicast 239.255.76.67 dev lo src 127.0.0.1 uid 0"))
        self.assertIn("eth0", doctor.route_problem("multicast 239.255.76.67 via 10.0.0.1 dev eth0 src 10.0.0.2")[0])
        self.assertIn("no route", doctor.route_problem("")[0])
        self.assertIsNone(doctor.clock_problem("NTPSynchronized=yes"))
        self.assertIsNotNone(doctor.clock_problem("Timezone=UTC\nNTPSynchronized=no\n"))

    def test_health_of_the_services(self):
        lines = [f'coach_up{{station="T1",service="{name}"}} 1\ncoach_state{{station="T1",service="{name}"}} 1' for name in doctor.SERVICES]
        self.assertEqual(list(doctor.health_problems("\n".join(lines), "T1")), [])
        lines[0] = lines[0].replace("} 1", "} 0")
        lines[1] = lines[1][:-1] + "2"
        found = [what for what, _ in doctor.health_problems("\n".join(lines), "T1")]
        self.assertEqual(found, ["capture does not answer", "detector is in trouble"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
