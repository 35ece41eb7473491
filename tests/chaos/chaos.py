#!/usr/bin/env python3
"""A lesson under faults: services are killed, the camera is unplugged, the bus flooded, a reader stalls, the disk fills up, the clock
jumps, the robot's network is cut, packets are lost. Afterwards the assembly must be what it is without faults, nothing may have been
said twice, every service must have recovered in time and its memory must not have grown.

usage: tools/in-netns tools/openni2_driver/with-driver DRIVER tests/chaos/chaos.py PROGRAMS SCENE [--lessons N] [--seed S] [--faults LIST]
  PROGRAMS   folder of the built programs
  SCENE      scene folder whose task.yaml is complete at its end; the camera of the lesson
  --lessons  how many lessons, each with its own order of faults (default 1); an hour: --lessons 55
  --faults   comma-separated, or `none` (default: all)

The services run under tests/system/systemctl with the shipped unit files. Exit code 77 where something needed is missing.
"""
import argparse
import glob
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from bus import Hostile, Listener

PROJECT = pathlib.Path(__file__).resolve().parents[2]
STATION, PAGE = "CHAOS", 8080
SERVICES = ["capture", "detector", "pose-filter", "assembly-reasoner", "robot-bridge", "operator", "record"]
ANSWERS = {"capture": "DEPTH_IMAGE", "detector": "DETECTIONS", "pose-filter": "PART_POSES", "assembly-reasoner": "CONNECTION_BELIEF"}
RECOVERY = 2.0  # s, at most
WARM_UP = 8.0  # s from the start of the services to the scene's
REST = 6.0  # s after the scene's end
GROWTH = 30e6  # bytes a service may grow by in a lesson
LIBFAKETIME = next(iter(glob.glob("/usr/lib/*/faketime/libfaketime.so.1")), None)


def load(path):
    loader = importlib.machinery.SourceFileLoader(path.name.replace("-", "_"), str(path))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


class Classroom:
    """One table with everything it has, in a folder of its own."""

    def __init__(self, programs, scene, listener, watcher_type):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="coach-chaos-"))
        self.disk = self.folder / "disk"
        self.disk.mkdir()
        run("mount", "-t", "tmpfs", "-o", "size=16m", "tmpfs", self.disk)
        self.listener, self.scene = listener, scene
        self.plug, self.clock = self.folder / "camera", self.folder / "clock"
        self.plug.touch()
        self.step_clock(0)
        self.begin = time.monotonic() + WARM_UP
        camera = json.loads((scene / "scene_camera.json").read_text())
        self.seconds = len(camera) / 15
        (self.folder / "station.yaml").write_text(
            f"station: {STATION}\ntask: {scene}/task.yaml\nstate_folder: {self.disk}/state\npage: {{port: {PAGE}}}\n"
            f"log: {{folder: {self.disk}/log, split_mb: 2, quota_gb: 0.006}}\nrobot: {{back_end: log}}\ncamera: {{source: 'openni2:', fps: 15}}\n")
        (self.disk / "state").mkdir()
        units = self.folder / "units"
        shutil.copytree(PROJECT / "deploy/systemd", units)
        for unit in units.glob("*.service"):
            unit.write_text(unit.read_text().replace("/etc/coach/%i", str(self.folder)))
        settings = [f"COACH_OPENNI2_SCENE={scene}", "COACH_OPENNI2_FPS=15", f"COACH_OPENNI2_BEGIN={self.begin}", f"COACH_OPENNI2_PLUG={self.plug}"]
        if LIBFAKETIME:
            settings += [f"LD_PRELOAD={LIBFAKETIME}", f"FAKETIME_TIMESTAMP_FILE={self.clock}", "FAKETIME_CACHE_DURATION=1",
                         "FAKETIME_DONT_FAKE_MONOTONIC=1", "FAKETIME_DONT_RESET=1"]
        (units / "coach-.service.d/90-chaos.conf").write_text("[Service]\n" + "".join(f"Environment={one}\n" for one in settings))
        os.environ.update(COACH_UNITS=str(units), COACH_RUN=str(self.folder / "run"), COACH_PROGRAMS=str(programs))
        self.systemctl("start", "coach@T.target")
        self.stalled = subprocess.Popen(["lcm-logger", "--quiet", f"--lcm-url=udpm://239.255.76.67:7667", str(self.folder / "stalled.lcm")],
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(0.3)
        self.stalled.send_signal(signal.SIGSTOP)  # a reader that never reads
        self.watcher = watcher_type(f"http://127.0.0.1:{PAGE}")
        self.watcher.begin("en", [one for one in SERVICES if one not in ("capture", "record", "operator")], lambda: False)

    def systemctl(self, *arguments):
        return run(PROJECT / "tests/system/systemctl", *arguments)

    def unit(self, service):
        return json.loads(self.systemctl("show", f"coach-{service}@T"))[f"coach-{service}@T"]

    def step_clock(self, seconds):
        part = self.clock.with_suffix(".part")
        part.write_text(f"{seconds:+d}s\n")
        part.rename(self.clock)

    def resident(self):
        page = os.sysconf("SC_PAGESIZE")
        found = {}
        for service in SERVICES:
            try:
                found[service] = int(pathlib.Path(f"/proc/{self.unit(service)['pid']}/statm").read_text().split()[1]) * page
            except (OSError, KeyError):
                found[service] = 0
        return found

    def said(self):
        """Every utterance that the robot began: id, text."""
        log = (self.folder / "run/coach-robot-bridge@T.service.log").read_text(errors="replace")
        return re.findall(r"robot: say (\d+) \S+ \"(.*)\"", log)

    def end(self):
        self.systemctl("stop", "coach@T.target")
        self.stalled.kill()
        self.stalled.wait()
        run("umount", "-l", self.disk)
        shutil.rmtree(self.folder)


class Faults:
    """Each fault is a function that returns the moment from which recovery counts and what must be heard then."""

    def __init__(self, room, seed):
        self.room, self.random = room, random.Random(seed)
        self.all = {**{f"kill {service}": lambda service=service: self.kill(service) for service in SERVICES},
                    "camera unplugged": self.unplug, "bus flooded": self.flood, "page stalls": self.stall, "disk full": self.fill_disk,
                    "robot's network cut": lambda: self.drop("udp dport 7668", 2.5, "ROBOT_STATUS"),
                    "one packet in ten lost": lambda: self.drop("udp dport 7667 numgen random mod 10 == 0", 4, "PART_POSES")}
        if LIBFAKETIME:
            self.all.update({"clock an hour on": lambda: self.clock(3600), "clock back": lambda: self.clock(0)})

    def kill(self, service):
        pid = self.room.unit(service)["pid"]
        os.kill(pid, signal.SIGKILL)
        return time.monotonic(), lambda moment: self.answers(service, moment, pid)

    def answers(self, service, moment, old):
        """Whether a service's new process has done its work since."""
        health = self.room.listener.of_service(service)
        alive = health.get("time", 0) > moment and health["pid"] != old
        return alive and (service not in ANSWERS or self.room.listener.heard_since(f"{STATION}/{ANSWERS[service]}", health["time"]))

    def after(self, channel):
        return time.monotonic(), lambda moment: self.room.listener.heard_since(f"{STATION}/{channel}", moment)

    def unplug(self):
        self.room.plug.unlink()
        time.sleep(1.5)
        self.room.plug.touch()
        return self.after("PART_POSES")

    def flood(self):
        Hostile(self.room.listener, STATION, self.random.random()).flood(2)
        return self.after("PART_POSES")

    def stall(self):
        pid = self.room.unit("operator")["pid"]
        os.kill(pid, signal.SIGSTOP)
        time.sleep(3)
        os.kill(pid, signal.SIGCONT)
        moment = time.monotonic()
        return moment, lambda _: self.room.listener.of_service("operator").get("time", 0) > moment

    def fill_disk(self):
        filler = self.room.disk / "filler"
        with open(filler, "wb", buffering=0) as out:
            try:
                while True:
                    out.write(bytes(1 << 16))
            except OSError:
                pass
        time.sleep(2.5)
        filler.unlink()
        return self.after("PART_POSES")

    def clock(self, offset):
        self.room.step_clock(offset)
        time.sleep(1.5)  # the services look at it once a second
        return self.after("PART_POSES")

    def drop(self, what, seconds, channel):
        run("nft", "add table inet chaos")
        run("nft", "add chain inet chaos in { type filter hook input priority 0; }")
        run("nft", f"add rule inet chaos in {what} drop")
        time.sleep(seconds)
        run("nft", "delete table inet chaos")
        return self.after(channel)


def lesson(arguments, number, listener, watcher_type):
    """@return what was wrong"""
    room = Classroom(arguments.programs.resolve(), arguments.scene.resolve(), listener, watcher_type)
    problems = []
    try:
        faults = Faults(room, arguments.seed + number)
        names = [name for name in faults.all if arguments.faults in ("all", name) or name in arguments.faults.split(",")]
        faults.random.shuffle(names)
        names.sort(key=lambda name: name == "clock back")  # after the step on
        pause = max(0.1, (room.seconds - sum(2.5 for _ in names)) / max(1, len(names)))
        time.sleep(max(0, room.begin - time.monotonic()))
        before = room.resident()
        for name in names:
            time.sleep(faults.random.uniform(0, 2 * pause))
            moment, recovered = faults.all[name]()
            while not recovered(moment) and time.monotonic() - moment < 10:
                time.sleep(0.01)
            took = time.monotonic() - moment
            print(f"  {time.monotonic() - room.begin:5.1f} s  {name}: recovered in {took:.2f} s", flush=True)
            if took > RECOVERY:
                problems.append(f"{name}: {took:.1f} s until recovery")
        time.sleep(max(0, room.begin + room.seconds + REST - time.monotonic()))
        problems += judge(room, before, names)
        if problems and arguments.keep:
            shutil.copytree(room.folder, arguments.keep, ignore=shutil.ignore_patterns("stalled.lcm", "*.notify"), dirs_exist_ok=True)
    finally:
        room.end()
    return problems


def judge(room, before, names):
    summary, problems = room.watcher.summary(), []
    made = sorted(name for name, state in summary["connections"].items() if state)
    said = room.said()
    print(f"  {summary['made']} of {summary['required']} connections made ({', '.join(made)}), phase {summary['phase']}; {len(said)} utterances")
    if summary["made"] != summary["required"] or summary["phase"] != "complete":
        problems.append(f"the assembly is not complete: {summary['made']} of {summary['required']}, phase {summary['phase']}")
    if not said:
        problems.append("nothing was said")
    problems += [f"said twice: {text}" for i, (number, text) in enumerate(said) if number in [other for other, _ in said[:i]]]
    problems += [f"said again at once: {text}" for (_, text), (_, next_text) in zip(said, said[1:]) if text == next_text]
    after = room.resident()
    for service in SERVICES:
        unit = room.unit(service)
        if unit["state"] != "active":
            problems.append(f"{service} is {unit['state']}")
        if unit["restarts"] != int(f"kill {service}" in names):
            problems.append(f"{service} was started again {unit['restarts']} times")
        if after[service] - before[service] > GROWTH:
            problems.append(f"{service} grew from {before[service] / 1e6:.0f} to {after[service] / 1e6:.0f} MB")
    print("  memory, MB: " + ", ".join(f"{service} {before[service] / 1e6:.0f} -> {after[service] / 1e6:.0f}" for service in SERVICES))
    return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("--lessons", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--faults", default="all")
    parser.add_argument("--keep", type=pathlib.Path, help="copies the folder of a lesson that went wrong here")
    arguments = parser.parse_args()
    if not (arguments.scene / "scene_camera.json").exists():
        print(f"skipped: there is no scene {arguments.scene}")
        return 77
    for program in ("nft", "lcm-logger"):
        if not shutil.which(program):
            print(f"skipped: {program} is not installed")
            return 77
    if not LIBFAKETIME:
        print("libfaketime is not installed: the clock is not stepped")
    listener, watcher_type = Listener(load(PROJECT / "tools/coach-doctor").heard), load(PROJECT / "tools/run-station").Watcher
    problems = []
    for number in range(arguments.lessons):
        print(f"lesson {number + 1}, seed {arguments.seed + number}", flush=True)
        problems += lesson(arguments, number, listener, watcher_type)
        for problem in problems:
            print("  PROBLEM", problem, flush=True)
        if problems:
            return 1
    print("no problem")
    return 0


if __name__ == "__main__":
    sys.exit(main())
