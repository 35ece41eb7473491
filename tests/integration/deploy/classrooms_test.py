"""Two classrooms on one network: each has the routes of coach-net.service, a table of the same name and a cable to the other. None hears
the other. In the first a second table is heard beside the first.

usage: classrooms_test.py DOCTOR PROGRAMS COACH-NET.SERVICE     exit code 77 (skipped) without network namespaces"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

DOCTOR, PROGRAMS, UNIT = (os.path.abspath(path) for path in sys.argv[1:4])
LISTEN = f"""
import importlib.machinery, importlib.util, json
loader = importlib.machinery.SourceFileLoader("doctor", {DOCTOR!r})
doctor = importlib.util.module_from_spec(importlib.util.spec_from_loader("doctor", loader))
loader.exec_module(doctor)
print(json.dumps(doctor.listen([doctor.TABLE_BUS, doctor.ROBOT_BUS], 3)))
"""


def main():
    if "COACH_CLASSROOMS_TEST" not in os.environ:
        user = [] if os.getuid() == 0 else ["-r"]
        if subprocess.run(["unshare", "-n", *user, "true"], check=False).returncode != 0:
            print("skipped: no network namespaces here")
            return 77
        os.environ["COACH_CLASSROOMS_TEST"] = "1"
        os.execvp("unshare", ["unshare", "-n", *user, sys.executable, "-B", *sys.argv])
    other = subprocess.Popen(["unshare", "-n", "sleep", "120"])
    children = [other]
    try:
        with tempfile.TemporaryDirectory() as folder:
            time.sleep(0.3)
            return rooms([[], ["nsenter", "-t", str(other.pid), "-n"]], other.pid, children, folder)
    finally:
        for child in children:
            child.kill()
            child.wait()


def rooms(prefixes, pid, children, folder):
    run = lambda *command: subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    run("ip", "link", "add", "cable", "type", "veth", "peer", "name", "cable", "netns", str(pid))
    for number, prefix in enumerate(prefixes):
        run(*prefix, "ip", "link", "set", "lo", "up")
        run(*prefix, "ip", "addr", "add", f"10.77.0.{number + 1}/24", "dev", "cable")
        run(*prefix, "ip", "link", "set", "cable", "up")
        run(*prefix, "ip", "route", "add", "default", "dev", "cable")
        for line in re.findall(r"^ExecStart=/usr/sbin/(ip .*)$", pathlib.Path(UNIT).read_text(), re.M):
            run(*prefix, *line.split())
    own = []
    for number, prefix in enumerate(prefixes):
        pids = {}
        for table in ["TABLE1", "TABLE2"] if number == 0 else ["TABLE1"]:
            for service, options in (("record", ["--folder", f"{folder}/{number}{table}"]), ("robot-bridge", ["--back-end", "log"])):
                child = subprocess.Popen([*prefix, f"{PROGRAMS}/coach-{service}", "--station", table, *options], stderr=subprocess.DEVNULL)
                children.append(child)
                pids.setdefault(table, {})[service] = child.pid
        own.append(pids)
    time.sleep(1)
    failed = 0
    for number, prefix in enumerate(prefixes):
        done = subprocess.run([*prefix, sys.executable, "-B", "-c", LISTEN], stdout=subprocess.PIPE, text=True, check=True)
        heard = {table: {service: facts.get("pid") for service, facts in services.items()} for table, services in json.loads(done.stdout).items()}
        print(f"classroom {number + 1}: heard {heard}, has {own[number]}")
        failed |= heard != own[number]
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
