"""Writes the log of a full bus: a simulated drive, and other traffic in every free place.

Half of that traffic is messages of the drive again, from another address, as of a second control unit.

    full_bus.py DRIVE.log FULL.log [MINUTES]
"""

import random
import sys

RATE_HZ = 1908  # J1939 at 250 kbit/s: 131 bits a frame
OTHER_ADDRESS = 0x7D
PROPRIETARY = 0xFF00  # groups that nobody but their maker reads
TRANSPORT = ("EB", "EC")  # parts of long messages, of which one alone says nothing


def other(draw, latest):
    """Returns a frame of other traffic, as candump writes it. `latest` is one of the drive."""
    if draw.random() < 0.5 and latest[2:4] not in TRANSPORT:
        return f"{latest[:6]}{OTHER_ADDRESS:02X}{latest[8:]}"
    identifier = draw.randrange(8) << 26 | (PROPRIETARY + draw.randrange(256)) << 8 | OTHER_ADDRESS
    return f"{identifier:08X}#{draw.randbytes(8).hex().upper()}"


def main(source, target, minutes=30.0):
    """Writes the log."""
    draw = random.Random(5)
    slot, start, latest = 0, None, None
    with open(source, encoding="ascii") as drive, open(target, "w", encoding="ascii") as full:
        for line in drive:
            time_s = float(line[1 : line.index(")")])
            _, interface, frame = line.split()
            start = time_s if start is None else start
            if time_s - start > 60 * minutes:
                break
            while start + slot / RATE_HZ < time_s:
                full.write(f"({start + slot / RATE_HZ:.6f}) {interface} {other(draw, latest)}\n")
                slot += 1
            latest = frame
            full.write(line)
            slot += 1


if __name__ == "__main__":
    main(*sys.argv[1:3], *map(float, sys.argv[3:4]))
