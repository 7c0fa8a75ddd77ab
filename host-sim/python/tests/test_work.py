"""Long work: Ctrl-C, other threads, messages."""

import logging
import subprocess
import sys
import threading
import time

import roadgrade
from drives import FOLDER, LOGS, VEHICLE, DriveTest

INTERRUPTED = """
import os, signal, sys, threading, time
import roadgrade
log, vehicle, saved = sys.argv[1:]
# What makes files must not take the signals either.
roadgrade.estimate(log, vehicle).save(saved)
began = time.monotonic()
threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    WORK
except KeyboardInterrupt:
    print(f"interrupted after {time.monotonic() - began:.1f} s")
    is_idle = False
    while not is_idle and time.monotonic() - began < 30:
        before = time.process_time()
        time.sleep(0.3)
        is_idle = time.process_time() - before < 0.03
    print("idle" if is_idle else "busy")
"""


class Work(DriveTest):
    def interrupted(self, work):
        program = INTERRUPTED.replace("WORK", work)
        words = [sys.executable, "-c", program, LOGS[0], VEHICLE, FOLDER / "of_child.csv"]
        done = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        first, last = done.stdout.splitlines()
        self.assertIn("interrupted after", first)
        # The worker has ended.
        self.assertEqual(last, "idle")

    def test_ctrl_c_stops_an_estimate(self):
        self.interrupted("roadgrade.estimate([log] * 1000, vehicle)")

    def test_ctrl_c_stops_an_identification(self):
        self.interrupted("roadgrade.identify([log] * 1000)")

    def test_other_threads_go_on(self):
        ticks = 0
        is_over = threading.Event()

        def count():
            nonlocal ticks
            while not is_over.wait(0.001):
                ticks += 1

        counter = threading.Thread(target=count)
        counter.start()
        began = time.monotonic()
        roadgrade.estimate(LOGS[0], VEHICLE)
        took_s = time.monotonic() - began
        is_over.set()
        counter.join()
        # On a busy machine a thread may wait; one that has no interpreter lock never counts.
        self.assertGreater(ticks, min(20, took_s * 50))

    def test_messages_are_logged(self):
        run = FOLDER / "messages.csv"
        roadgrade.estimate(LOGS[0], VEHICLE).save(run)
        with self.assertLogs("roadgrade", logging.INFO) as logged:
            roadgrade.fuse(run)
        self.assertTrue(any("cells" in line and str(run) in line for line in logged.output))

    def test_threads_estimate_at_the_same_time(self):
        runs = [None, None]

        def estimate(number):
            runs[number] = roadgrade.estimate(LOGS[number], VEHICLE)

        threads = [threading.Thread(target=estimate, args=(number,)) for number in (0, 1)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(all(len(run) > 2000 for run in runs))
