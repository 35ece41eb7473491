"""coach-doctor finds each trouble and names a command that mends it."""
import hashlib
import importlib.machinery
import importlib.util
import pathlib
import socket
import struct
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
        found = list(doctor.examine(self.root, list(tables), None))
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

    def test_two_tables_in_each_others_way(self):
        self.write("etc/coach/T2/station.yaml", STATION)
        self.assertEqual(self.findings(["T1", "T2"]), ["T1 and T2 have the same station: T1", "T1 and T2 have the same port: 8080"])
        self.write("etc/coach/T2/station.yaml", STATION.replace("T1", "T2") + "  port: 8081\n")
        self.assertEqual(self.findings(["T1", "T2"]), [])

    def test_health_of_the_services(self):
        sha = hashlib.sha256(STATION.encode()).hexdigest()
        sound = {name: {"host": "elsewhere", "pid": 1, "state": 1, "message": "", "version": "1.0", "sha256": sha} for name in doctor.SERVICES}
        self.assertEqual(list(doctor.health_problems(sound, "T1", STATION)), [])
        for change, words in (({"state": 2, "message": "no input"}, "is in trouble: no input"),
                              ({"version": "0.9"}, "is version 0.9, others are 1.0"),
                              ({"sha256": "0", "host": socket.gethostname()}, "was started with another station file")):
            found = list(doctor.health_problems({**sound, "detector": {**sound["detector"], **change}}, "T1", STATION))
            self.assertEqual(len(found), 1, found)
            self.assertIn("detector " + words, found[0][0])
            self.assertIn("coach-detector@T1", found[0][1])
        silent = {**sound["detector"], "state": 2, "message": "no input yet"}
        found = list(doctor.health_problems({**sound, "capture": {**silent, "message": "no camera"}, "detector": silent}, "T1", STATION))
        self.assertEqual([what for what, _ in found], ["capture is in trouble: no camera"], "what follows from another trouble is none of its own")
        self.assertEqual(len(list(doctor.health_problems({**sound, "detector": silent}, "T1", STATION))), 1)
        del sound["capture"]
        self.assertEqual([what for what, _ in doctor.health_problems(sound, "T1", STATION)], ["capture does not answer"])

    def test_packets_of_the_bus(self):
        def text(value):
            return struct.pack(">i", len(value) + 1) + value.encode() + b"\0"

        head = b"LC02" + bytes(4)
        config = head + b"T1/CONFIG\0" + bytes(8) + text("detector") + text("1.0") + text("ab")
        self.assertEqual(doctor.heard(config), ("T1", "detector", {"version": "1.0", "sha256": "ab"}))
        health = (head + b"T1/SERVICE_HEALTH\0" + bytes(8) + bytes(8) + text("T1") + text("capture") + text("pc") + struct.pack(">i", 7) + b"\2" +
                  text("no camera") + bytes(76))
        self.assertEqual(doctor.heard(health), ("T1", "capture", {"host": "pc", "pid": 7, "state": 2, "message": "no camera"}))
        for packet in (b"", b"LC03" + config[4:], head + b"T1/COLOR_IMAGE\0" + bytes(90), head + b"T1/CONFIG\0" + bytes(8) + b"\x80\0\0\0"):
            self.assertIsNone(doctor.heard(packet))
        for size in range(len(config)):
            self.assertIsNone(doctor.heard(config[:size]))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
