"""Decodes the head of a candump log with python-can and cantools: `decode.py LOG`. Prints a line of
JSON with the time for a frame. cantools does not know fast packets: their frames are read but not
decoded, which is less work than the estimator does."""

import itertools
import json
import sys
import time
from pathlib import Path

import can
import cantools

FRAMES = 20_000
# Mask of the identifier without priority and source address.
GROUP = 0x03FFFF00


def main():
    folder = Path(__file__).parents[3] / "estimator-core" / "dbc"
    layout = cantools.database.Database(frame_id_mask=GROUP)
    for name in ("j1939.dbc", "nmea2000.dbc"):
        layout.add_dbc_file(folder / name)
    single = {m.frame_id & GROUP for m in layout.messages if m.length <= 8}
    decoded = frames = 0
    started = time.perf_counter_ns()
    with can.LogReader(sys.argv[1]) as log:
        for frame in itertools.islice(log, FRAMES):
            frames += 1
            if frame.arbitration_id & GROUP in single:
                message = layout.get_message_by_frame_id(frame.arbitration_id)
                message.decode(frame.data, decode_choices=False)
                decoded += 1
    frame_ns = (time.perf_counter_ns() - started) / frames
    assert decoded > frames / 2, f"{decoded} of {frames} frames decoded"
    print(json.dumps({"frame_ns": frame_ns}))


main()
