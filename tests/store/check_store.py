"""Checks object storage against a server of S3 on this machine: read, write, interrupted, again.

    check_store.py ROADGRADE FOLDER

FOLDER has a.log, b.log, vehicle.toml and road.csv. The same commands run on files and on objects, and
all they write must be equal, byte for byte. Commands that are killed or cut off must leave what was
there before, and succeed the next time.
"""

import logging
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import boto3
from gate import CUT, DEAF, DOWN, HOLD, UP, Gate
from moto.server import ThreadedMotoServer

BUCKET = "fleet"
LONGEST_S = 60
# More than what a request has besides an object, and less than each object that is cut.
LITTLE = 20_000
# Bytes of a memory that is sent at once, on a condition, and of sums that are sent in pieces.
LARGE = "16777216"
IN_PIECES = 70_000_000


class Bench:
    """The program, the server, and the gate between them."""

    def __init__(self, program, folder, work):
        logging.getLogger("werkzeug").setLevel(logging.ERROR)
        server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
        server.start()
        _, port = server.get_host_and_port()
        self.program, self.work = program, work
        self.gate = Gate(port)
        self.temporary = work / "tmp"
        self.temporary.mkdir()
        access = dict(aws_access_key_id="id", aws_secret_access_key="key", region_name="us-east-1")
        self.s3 = boto3.client("s3", endpoint_url=f"http://127.0.0.1:{port}", **access)
        self.s3.create_bucket(Bucket=BUCKET)
        self.environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("AWS_")},
            "AWS_ACCESS_KEY_ID": "id",
            "AWS_SECRET_ACCESS_KEY": "key",
            "AWS_REGION": "us-east-1",
            "AWS_ENDPOINT_URL": f"http://127.0.0.1:{self.gate.port}",
            "AWS_ALLOW_HTTP": "true",
            "TMPDIR": str(self.temporary),
        }
        self.files = work / "files"
        shutil.copytree(folder, self.files / "in")
        for name in "runs", "pages":
            (self.files / name).mkdir()
        for path in (self.files / "in").iterdir():
            self.s3.upload_file(str(path), BUCKET, f"in/{path.name}")

    def file(self, name):
        return str(self.files / name)

    @staticmethod
    def object(name):
        return f"s3://{BUCKET}/{name}"

    def start(self, *arguments):
        return subprocess.Popen(
            [self.program, *arguments],
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def run(self, *arguments, status=0):
        """Runs the program to its end; returns what it printed on stdout and on stderr."""
        process = self.start(*arguments)
        out, messages = process.communicate(timeout=LONGEST_S)
        assert process.returncode == status, (arguments, process.returncode, messages)
        assert str(self.temporary) not in out + messages, (arguments, out, messages)
        return out, messages

    def interrupt(self, number, *arguments, meanwhile=lambda: None):
        """Runs the program until the gate is reached, and ends it by a signal after `meanwhile`."""
        process = self.start(*arguments)
        assert self.gate.reached(LONGEST_S), process.communicate()
        meanwhile()
        process.send_signal(number)
        process.communicate(timeout=LONGEST_S)
        assert process.returncode == -number, (arguments, process.returncode)
        # What the program had sent but the server has not got is lost, as in a network.
        self.gate.open(CUT)

    def names(self, prefix=""):
        listed = self.s3.list_objects_v2(Bucket=BUCKET, Prefix=prefix)
        return {found["Key"] for found in listed.get("Contents", [])}

    def content(self, name):
        return self.s3.get_object(Bucket=BUCKET, Key=name)["Body"].read()

    def left(self):
        """Returns what is in the folder of temporary files."""
        return [path.name for path in self.temporary.iterdir()]


def commands(at):
    """The chain from logs to maps; `at` returns a file or an object."""
    vehicle, road = ("--vehicle", at("in/vehicle.toml")), ("--road", at("in/road.csv"))
    day = ("--day", "2026-11-01")
    yield "inspect", "--json", at("in/a.log")
    yield "estimate", *vehicle, *day, "--out", at("runs/a.parquet"), at("in/a.log")
    own = ("--memory", at("roads.memory"), "--memory-bytes", LARGE, "--kept", at("kept"))
    pages = ("--page", at("pages/b.html"))
    yield "estimate", *vehicle, *day, *own, *pages, f"--dataset={at('data')}", at("in/b.log")
    yield "export", at("roads.memory"), "--out", at("learned.csv")
    placed = ("--placed", at("placed"))
    yield "fuse", *road, *placed, "--store", at("sums.csv"), "--out", at("map.parquet"), at("runs")
    yield "fuse", "--store", at("sums.csv"), "--out", at("both.csv"), "--json", at("data/")
    named = f"x={at('runs/a.parquet')},{at('data')}"
    yield "fuse", *road, "--out", at("named.csv"), "--session", named
    yield "place", *road, "--out", at("alone/"), "--json", at("runs"), at("data")
    yield "export", at("map.parquet"), "--out", at("map.geojson")
    yield "export", at("map.parquet"), "--out", at("ways")
    yield "pack", at("map.parquet"), "--out", at("map.grade")
    yield "map", "--out", at("made"), *vehicle, at("in/a.log"), at("in/b.log")


def same_as_files(bench):
    """Runs all commands on files and on objects."""
    for on_files, on_objects in zip(commands(bench.file), commands(bench.object), strict=True):
        expected, _ = bench.run(*on_files)
        found, _ = bench.run(*on_objects)
        in_objects = expected.replace(f"{bench.files}/", f"s3://{BUCKET}/")
        assert " frames/s" in found or found == in_objects, (on_objects, found, in_objects)
    paths = {str(path.relative_to(bench.files)): path for path in bench.files.rglob("*")}
    # The version before a store is for files; a bucket may keep versions.
    files = {name for name, path in paths.items() if path.is_file() and path.suffix != ".previous"}
    assert bench.names() == files, bench.names() ^ files
    different = [name for name in files if paths[name].read_bytes() != bench.content(name)]
    assert not different, different
    assert len(files) > 20, files
    assert not bench.left(), bench.left()
    return f"{len(files)} objects equal to the files of the same commands"


def place_again(bench):
    """Places one run, is killed at the second, and goes on."""
    runs = bench.object("runs"), bench.object("data")
    place = ("place", "--road", bench.object("in/road.csv"), "--out", bench.object("late"), *runs)
    sizes = [len(bench.content(name)) for name in bench.names("alone/")]
    assert len(sizes) == 2, sizes
    bench.gate.shut(UP, min(sizes) // 2, HOLD, spared=1)
    bench.interrupt(signal.SIGTERM, *place)
    assert len(bench.names("late/")) == 1, bench.names("late/")
    _, messages = bench.run(*place)
    assert "1 runs placed, 1 there already" in messages, messages
    for name in bench.names("alone/"):
        assert bench.content(name) == bench.content(name.replace("alone/", "late/")), name
    return "placing was killed between two runs and went on"


def estimate(bench, log, out):
    return "estimate", "--vehicle", bench.file("in/vehicle.toml"), "--out", out, log


def killed_while_sending(bench):
    """An object that is sent is absent, or the old one, until all of it is there."""
    command = estimate(bench, bench.file("in/a.log"), bench.object("sent.csv"))
    bench.run(*estimate(bench, bench.file("in/a.log"), bench.file("sent.csv")))
    for number, before in (signal.SIGTERM, None), (signal.SIGKILL, b"old"):
        if before:
            bench.s3.put_object(Bucket=BUCKET, Key="sent.csv", Body=before)
        bench.gate.shut(UP, LITTLE, HOLD)
        bench.interrupt(number, *command)
        assert bench.names("sent.csv") == ({"sent.csv"} if before else set())
        assert not before or bench.content("sent.csv") == before
        assert bool(bench.left()) == (number == signal.SIGKILL), bench.left()
    bench.run(*command)
    assert bench.content("sent.csv") == (bench.files / "sent.csv").read_bytes()
    assert not bench.left(), bench.left()
    return "killed while sending: the object is absent or the old one, then the new one"


def large_sums(bench):
    """Writes sums that are sent in pieces: those of the bench, of many sessions."""
    _, header, *rows = Path(bench.file("sums.csv")).read_text().splitlines()
    lines = [row for row in rows if not row.startswith("#")]
    cells = [cell for cell in (row.split(",") for row in lines) if cell[1]]
    size = sum(len(line) for line in lines)
    session = 0
    while size < IN_PIECES:
        for cell in cells:
            lines.append(",".join([cell[0], f"s{session:06}", "", "", *cell[4:]]))
            size += len(lines[-1])
        session += 1
    # Without a checksum, as an earlier release wrote it, and without runs: each is a new one.
    first = f"# roadgrade sums 2, rows: {len(lines)}, runs: 0"
    return "\n".join([first, header, *lines, ""]).encode()


def killed_between_pieces(bench):
    """A large object is sent in pieces; they are taken back."""
    sums = large_sums(bench)
    path = Path(bench.file("large.csv"))
    bench.s3.put_object(Bucket=BUCKET, Key="large.csv", Body=sums)
    path.write_bytes(sums)

    def command(at):
        return "fuse", "--store", at("large.csv"), "--out", bench.file("x.csv"), bench.file("data")

    def begun():
        return len(bench.s3.list_multipart_uploads(Bucket=BUCKET).get("Uploads", []))

    def is_begun():
        assert begun() == 1, begun()

    bench.gate.shut(UP, LITTLE, HOLD)
    bench.interrupt(signal.SIGTERM, *command(bench.object), meanwhile=is_begun)
    assert bench.content("large.csv") == sums
    assert begun() == 0, begun()
    bench.run(*command(bench.object))
    bench.run(*command(bench.file))
    assert bench.content("large.csv") == path.read_bytes() != sums
    # Another program replaces it while its pieces are on their way.
    bench.s3.put_object(Bucket=BUCKET, Key="large.csv", Body=sums)
    bench.gate.shut(UP, LITTLE, HOLD)
    process = bench.start(*command(bench.object))
    assert bench.gate.reached(LONGEST_S)
    bench.s3.put_object(Bucket=BUCKET, Key="large.csv", Body=b"of another program")
    bench.gate.open()
    _, messages = process.communicate(timeout=LONGEST_S)
    assert process.returncode == 1 and "changed by another program" in messages, messages
    assert bench.content("large.csv") == b"of another program" and begun() == 0
    return "killed between pieces: none is left behind"


def killed_while_reading(bench):
    out = bench.work / "read.csv"
    command = estimate(bench, bench.object("in/a.log"), str(out))
    bench.gate.shut(DOWN, LITTLE, HOLD)
    bench.interrupt(signal.SIGTERM, *command)
    assert not out.exists() and not bench.left(), bench.left()
    bench.run(*command)
    assert out.read_bytes() == (bench.files / "sent.csv").read_bytes()
    return "killed while reading: no output, then the whole"


def cut_off(bench):
    """A connection that breaks is taken up again; one that always breaks is an error."""
    out = bench.work / "cut.csv"
    log = bench.object("in/a.log")
    # Each connection brings another part of 2 MB.
    bench.gate.shut(DOWN, 1_000_000, CUT)
    bench.run(*estimate(bench, log, str(out)))
    assert bench.gate.reached(0)
    assert out.read_bytes() == (bench.files / "sent.csv").read_bytes()
    out.unlink()
    bench.gate.shut(DOWN, 600, CUT)
    _, messages = bench.run(*estimate(bench, log, str(out)), status=1)
    assert log in messages and "AWS_ENDPOINT_URL" in messages, messages
    assert not out.exists() and not bench.left()
    bench.gate.shut(UP, LITTLE, CUT)
    cut = bench.object("cut.csv")
    _, messages = bench.run(*estimate(bench, bench.file("in/a.log"), cut), status=1)
    assert cut in messages and "AWS_ENDPOINT_URL" in messages, messages
    bench.gate.open()
    assert not bench.names("cut.csv")
    return "connections cut: taken up again, or an error without output"


def changed_meanwhile(bench):
    """Sums that another program replaces are not lost: while they are read, and while they are sent."""
    other = b"of another program"

    def fuse(name, runs="runs"):
        sums = bench.object(name)
        return "fuse", "--store", sums, "--out", bench.object("all.csv"), bench.object(runs)

    def refused(process, name):
        bench.s3.put_object(Bucket=BUCKET, Key=name, Body=other)
        bench.gate.open()
        _, messages = process.communicate(timeout=LONGEST_S)
        assert process.returncode == 1 and "changed by another program" in messages, messages
        assert bench.content(name) == other

    bench.gate.shut(DOWN, LITTLE, HOLD)
    process = bench.start(*fuse("shared.csv"))
    assert bench.gate.reached(LONGEST_S)
    refused(process, "shared.csv")
    # A first one that another program makes as well, ...
    bench.gate.shut(UP, LITTLE, HOLD)
    process = bench.start(*fuse("first.csv"))
    assert bench.gate.reached(LONGEST_S)
    refused(process, "first.csv")
    # ... and one that was there: half of the new sums are on their way.
    bench.run(*fuse("second.csv", "data"))
    bench.gate.shut(UP, LITTLE, HOLD)
    process = bench.start(*fuse("second.csv"))
    assert bench.gate.reached(LONGEST_S)
    refused(process, "second.csv")
    return "sums that another program replaced are kept"


def reply_lost(bench):
    """A server that did what was asked, and whose reply got lost, is no error."""
    sums = bench.object("lost.csv")
    fuse = ("fuse", "--store", sums, "--out", bench.file("lost.csv"), bench.object("runs"))
    bench.run(*fuse)
    expected = bench.content("lost.csv")
    bench.s3.delete_object(Bucket=BUCKET, Key="lost.csv")
    bench.gate.shut(UP, LITTLE, DEAF)
    bench.run(*fuse)
    assert bench.gate.reached(0)
    bench.gate.open()
    assert bench.content("lost.csv") == expected
    return "a lost reply: the object is there, and no error"


def without_conditions(bench):
    """A server without conditions is asked what is there before it is sent anything."""
    bench.environment["AWS_CONDITIONAL_PUT"] = "disabled"
    sums = bench.object("plain.csv")

    def fuse(runs):
        return "fuse", "--store", sums, "--out", bench.file("plain.csv"), bench.object(runs)

    bench.run(*fuse("runs"))
    bench.gate.shut(DOWN, LITTLE, HOLD)
    process = bench.start(*fuse("data"))
    assert bench.gate.reached(LONGEST_S)
    bench.s3.put_object(Bucket=BUCKET, Key="plain.csv", Body=b"of another program")
    bench.gate.open()
    _, messages = process.communicate(timeout=LONGEST_S)
    assert process.returncode == 1 and "changed by another program" in messages, messages
    del bench.environment["AWS_CONDITIONAL_PUT"]
    return "a server without conditions is asked before"


def refused(bench):
    """What is not there, is named."""
    for address, words in (
        ("s3://nowhere/a.log", "no such bucket"),
        (bench.object("in/c.log"), "there is no such object"),
        (bench.object("in/"), "is a folder; expected an object"),
    ):
        _, messages = bench.run("inspect", address, status=1)
        assert address in messages and words in messages, messages
    for address in "s3://nowhere/runs", bench.object("nothing"):
        _, messages = bench.run("fuse", "--out", bench.file("no.csv"), address, status=1)
        assert address in messages and "expected" in messages, messages
    address = "s3://nowhere/map.csv"
    _, messages = bench.run("fuse", "--out", address, bench.object("runs"), status=1)
    assert address in messages and "there is no bucket nowhere" in messages, messages
    return "missing buckets and objects are named"


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as work:
        bench = Bench(program, folder, Path(work))
        for check in (
            same_as_files,
            place_again,
            killed_while_sending,
            killed_between_pieces,
            killed_while_reading,
            cut_off,
            changed_meanwhile,
            reply_lost,
            without_conditions,
            refused,
        ):
            started = time.monotonic()
            print(f"{check(bench)} ({time.monotonic() - started:.1f} s)", flush=True)


main()
