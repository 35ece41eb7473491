"""The robot bridge on another host: two network namespaces joined by a cable that loses one packet in a hundred both ways
and is cut for five seconds. Every command is carried out once or is out of
date; none twice, and none that is forged.

Runs itself again in a network namespace of its own. Skipped (exit code 77) where that can't be had, or without nft.

usage: robot_link_test.py BRIDGE SENDER [COUNT]"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

BRIDGE, SENDER = (os.path.abspath(p) for p in sys.argv[1:3])
COUNT = int(sys.argv[3]) if len(sys.argv) > 3 else 24
URL = "udpm://239.255.76.67:7668?ttl=1"


def skip(why):
    print("skipped:", why)
    sys.exit(77)


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def lossy(prefix):
    run(*prefix, "nft", "add table inet coach")
    run(*prefix, "nft", "add chain inet coach in { type filter hook input priority 0; }")
    run(*prefix, "nft", "add rule inet coach in udp dport 7668 numgen random mod 100 == 0 drop")


def main():
    if not shutil.which("nft"):
        skip("nft is not installed (package nftables)")
    if "COACH_LINK_TEST" not in os.environ:
        user = [] if os.getuid() == 0 else ["-r"]
        if subprocess.run(["unshare", "-n", *user, "true"], check=False).returncode != 0:
            skip("no network namespaces here")
        os.environ["COACH_LINK_TEST"] = "1"
        os.execvp("unshare", ["unshare", "-n", *user, sys.executable, "-B", *sys.argv])

    far = subprocess.Popen(["unshare", "-n", "sleep", "300"])
    folder = tempfile.TemporaryDirectory()
    bridge = None
    try:
        time.sleep(0.3)
        there = ["nsenter", "-t", str(far.pid), "-n"]
        run("ip", "link", "add", "table", "type", "veth", "peer", "name", "robot", "netns", str(far.pid))
        for prefix, name, address in (([], "table", "10.77.0.1/24"), (there, "robot", "10.77.0.2/24")):
            run(*prefix, "ip", "link", "set", "lo", "up")
            run(*prefix, "ip", "addr", "add", address, "dev", name)
            run(*prefix, "ip", "link", "set", name, "up")
            run(*prefix, "ip", "route", "add", "224.0.0.0/4", "dev", name)
            lossy(prefix)
        key = os.path.join(folder.name, "key")
        with open(key, "wb") as out:
            out.write(os.urandom(32))
        station = os.path.join(folder.name, "station.yaml")
        with open(station, "w", encoding="utf-8") as out:
            out.write(f"station: LINK\nbus:\n  robot: {URL}\n  key_file: {key}\nrobot:\n  back_end: log\n")
        log = open(os.path.join(folder.name, "log"), "w+", encoding="utf-8")
        bridge = subprocess.Popen([*there, BRIDGE, "--config", station], stderr=log)
        time.sleep(1)
        sender = subprocess.Popen([SENDER, URL, "LINK", str(COUNT), key], stdout=subprocess.PIPE, text=True)
        time.sleep(0.3 * COUNT)
        run(*there, "ip", "link", "set", "robot", "down")
        time.sleep(5)
        run(*there, "ip", "link", "set", "robot", "up")
        run(*there, "ip", "route", "replace", "224.0.0.0/4", "dev", "robot")
        output, _ = sender.communicate(timeout=0.7 * COUNT + 60)
        states = dict(line.split() for line in output.splitlines())
        bridge.terminate()
        bridge.wait(10)
        log.seek(0)
        lines = log.read()
        said = re.findall(r"robot: say (\d+) ", lines)
        forged = [i for i in said if int(i) > COUNT]
        refused = len(re.findall("its signature is not of this station's key", lines))
        said = [i for i in said if int(i) <= COUNT]
        problems = [f"the forged command {i} was said" for i in forged]
        if refused < COUNT:
            problems.append(f"only {refused} forgeries were noticed")
        problems += [f"command {i} said {said.count(i)} times" for i in set(said) if said.count(i) > 1]
        for command, state in states.items():
            if command in said and state != "done":
                problems.append(f"command {command} was said, but the sender knows of '{state}'")
            if command not in said and state not in ("none", "expired"):
                problems.append(f"command {command} was not said, but the sender was told '{state}'")
        print(f"{COUNT} commands: {len(said)} said once, {COUNT - len(said)} out of date, {refused} forgeries refused; {len(problems)} problems")
        if len(said) < COUNT / 2 or len(said) == COUNT:
            problems.append("the cut was not what was meant")
        for problem in problems:
            print(problem)
        return 1 if problems else 0
    finally:
        for process in (bridge, far):
            if process:
                process.kill()
                process.wait()
        folder.cleanup()


if __name__ == "__main__":
    sys.exit(main())
