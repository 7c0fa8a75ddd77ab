#!/usr/bin/env python3
"""Runs `roadgrade`, and kills it the first times: at a random moment, with the Spark worker or without.

The environment has the program as ROADGRADE and a folder for a mark of each interruption as
INTERRUPTIONS; it ends after ten. The moments lie within the time that the program took when it was not
killed, on whatever machine.
"""

import os
import pathlib
import random
import signal
import subprocess
import sys
import time
import uuid

WANTED = 10
LONGEST_S = 0.4


def main():
    command = [os.environ["ROADGRADE"], *sys.argv[1:]]
    marks = pathlib.Path(os.environ["INTERRUPTIONS"])
    done = len(list(marks.iterdir()))
    if done >= WANTED:
        os.execv(command[0], command)
    took = marks.with_suffix(".took")
    longest_s = min(LONGEST_S, float(took.read_text())) if took.exists() else LONGEST_S
    begun = time.monotonic()
    process = subprocess.Popen(command)
    try:
        status = process.wait(timeout=random.uniform(0.0, longest_s))
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGKILL)
        process.wait()
        (marks / uuid.uuid4().hex).touch()
        if done % 2 == 1:
            os.kill(os.getppid(), signal.SIGKILL)
        sys.exit(128 + signal.SIGKILL)
    whole = took.with_suffix(f".{uuid.uuid4().hex}")
    whole.write_text(str(time.monotonic() - begun))
    whole.replace(took)
    # It was done before. The task is tried again all the same: nothing may be counted twice.
    sys.exit(status or 1)


main()
