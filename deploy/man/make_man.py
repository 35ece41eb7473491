"""Writes a man page (section 1) from a program's own --help and --version. usage: make_man.py PROGRAM OUTPUT"""
import pathlib
import re
import subprocess
import sys


def escaped(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text.startswith((".", "'")) else text


def page(program, help_text):
    """troff of CLI11's help: first line description, then 'Usage:', then 'Options:' with two columns."""
    name = pathlib.Path(program).name
    head, _, options = help_text.partition("\nOptions:\n")
    description, _, usage = head.partition("\nUsage:")
    usage = re.sub(r"\S*/" + re.escape(name), name, usage)
    lines = [f".TH {name.upper()} 1 \"\" Coach \"User commands\"", ".SH NAME",
             f"{escaped(name)} \\- {escaped(description.strip().splitlines()[0].rstrip('.'))}", ".SH SYNOPSIS",
             f".B {escaped(usage.strip().splitlines()[0] if usage.strip() else name)}", ".SH DESCRIPTION",
             escaped(" ".join(description.split())), ".SH OPTIONS"]
    for line in options.splitlines():
        match = re.match(r"  (\S.*?)(?:\s{2,}(.*))?$", line)
        if match:
            lines += [".TP", f".B {escaped(match.group(1))}", escaped(match.group(2) or "")]
        elif line.strip():
            lines.append(escaped(line.strip()))
    lines += [".SH EXIT STATUS", "0 ended as asked, 1 failed, 2 wrong usage or configuration, 3 device missing, 4 bus unusable.",
              ".SH SEE ALSO", ".BR coach (7)"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    done = subprocess.run([sys.argv[1], "--help"], capture_output=True, text=True, timeout=20)
    if done.returncode != 0 or not done.stdout.strip():
        sys.exit(f"{sys.argv[1]} --help: exit code {done.returncode}")
    pathlib.Path(sys.argv[2]).write_text(page(sys.argv[1], done.stdout))
