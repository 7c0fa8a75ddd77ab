"""Compares the program for Windows, under Wine, with that for this system.

    check_windows.py PROGRAM PROGRAM.exe WRITE_LOGS.py FOLDER

Both programs get the same inputs in a folder of their own, with spaces and letters beyond ASCII in its
name, and lines that end in CR LF. All files that they write, what they print and their exit codes must
be the same. Fails at the end if any differs.
"""

import shutil
import subprocess
import sys
from pathlib import Path

COMMANDS = [
    ["inspect", "--json", "drive é.log"],
    ["inspect", "--json", "crlf.log"],
    ["inspect", "--json", "formats/python_can.blf"],
    ["map", "--out", "map of blf", "formats/python_can.blf"],
    ["map", "--out", "Karte für mdf", "formats/asammdf_2.mf4"],
    ["map", "--out", "two", "--vehicle", "crlf.toml", "drive é.log", "crlf.log"],
    ["estimate", "--vehicle", "crlf.toml", "--out", "run.csv", "crlf.log"],
    ["estimate", "--vehicle", "crlf.toml", "--out", "run.parquet", "drive é.log"],
    ["export", "map of blf/map.csv", "--out", "map.geojson"],
    ["inspect", "no such file.log"],
    ["estimate", "--vehicle", "crlf.toml", "--out", "run.csv", "wrong.log"],
]
# It only exists on Linux, and says so.
LIVE = ["listen", "can0"]


def run(program, arguments, folder):
    """Returns the exit code and what is printed, with the line ends and the separators of this system."""
    done = subprocess.run([*program, *arguments], cwd=folder, capture_output=True)
    text = done.stdout.decode() if done.returncode == 0 else done.stderr.decode()
    return done.returncode, text.replace("\r\n", "\n").replace("\\\\", "/").replace("\\", "/")


def inputs(program, writer, folder):
    """Writes a simulated drive in several forms."""
    folder.mkdir(parents=True)
    run([program], ["demo", "--out", "demo"], folder)
    log = (folder / "demo/a1.log").read_bytes()
    lines = log.splitlines(keepends=True)[:60_000]
    (folder / "drive é.log").write_bytes(b"".join(lines))
    (folder / "crlf.log").write_bytes(b"".join(lines).replace(b"\n", b"\r\n"))
    vehicle = (folder / "demo/a1.vehicle.toml").read_bytes()
    (folder / "crlf.toml").write_bytes(vehicle.replace(b"\n", b"\r\n"))
    (folder / "wrong.log").write_text("one\ntwo\nthree\n")
    (folder / "formats").mkdir()
    subprocess.run([sys.executable, writer, folder / "drive é.log", folder / "formats"], check=True)
    shutil.rmtree(folder / "demo")


def files(folder):
    paths = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in paths}


def main(program, exe, writer, scratch):
    scratch = Path(scratch).absolute()
    here, there = scratch / "this system ü", scratch / "Windows ü"
    program, exe = str(Path(program).absolute()), str(Path(exe).absolute())
    inputs(program, Path(writer).absolute(), here)
    shutil.copytree(here, there)
    differences = []
    for arguments in [["demo", "--out", "demo"], *COMMANDS]:
        expected = run([program], arguments, here)
        found = run(["wine", exe], arguments, there)
        # The systems have words of their own for their errors.
        if found[0] != expected[0] or (found[0] == 0 and found[1] != expected[1]):
            differences.append(f"{' '.join(arguments)}: {expected} here, {found} on Windows")
        print(found[0], *arguments)
    expected, found = files(here), files(there)
    for name in sorted(expected.keys() | found.keys()):
        if expected.get(name) != found.get(name):
            differences.append(f"{name}: differs, or is absent on one of them")
    code, text = run(["wine", exe], LIVE, there)
    if code != 1 or "only Linux has" not in text:
        differences.append(f"listen: {code} {text}")
    print(f"{len(found)} files, {len(differences)} differences", *differences, sep="\n")
    return 1 if differences else 0


sys.exit(main(*sys.argv[1:]))
