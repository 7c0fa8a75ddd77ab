"""Writes a candump log in the formats that python-can and asammdf write.

    write_logs.py LOG FOLDER

LOG is written by `candump -l`; its time stamps are cut to a grid of 1 ms. FOLDER gets the cut log,
grid.log, and the same frames in each format and packing, one file each.
"""

import gzip
import sys
from pathlib import Path

import can
import numpy
from asammdf import MDF, Signal, Source
from asammdf.blocks import mdf_v4


def read(path):
    """Returns the frames of a log, with times on a grid of 1 ms."""
    frames = []
    for line in Path(path).read_text().splitlines():
        stamp, _, frame = line.split(" ")
        name, data = frame.split("#")
        message = can.Message(
            timestamp=int(float(stamp.strip("()")) * 1000) / 1000,
            arbitration_id=int(name, 16),
            is_extended_id=len(name) == 8,
            data=bytes.fromhex(data),
            channel=0,
            is_rx=True,
        )
        frames.append(message)
    return frames


def write_candump(frames, path):
    with open(path, "w") as log:
        for frame in frames:
            digits = 8 if frame.is_extended_id else 3
            name = f"{frame.arbitration_id:0{digits}X}"
            log.write(f"({frame.timestamp:.6f}) can0 {name}#{frame.data.hex().upper()}\n")


def write_python_can(frames, path):
    with can.Logger(str(path)) as log:
        for frame in frames:
            log(frame)


def write_savvy_can(frames, path):
    columns = "Time Stamp,ID,Extended,Dir,Bus,LEN,D1,D2,D3,D4,D5,D6,D7,D8"
    with open(path, "w") as log:
        log.write(columns + "\n")
        for frame in frames:
            micros = round(frame.timestamp * 1e6)
            extended = str(frame.is_extended_id).lower()
            data = "".join(f"{byte:02X}," for byte in frame.data)
            log.write(f"{micros},{frame.arbitration_id:08X},{extended},Rx,0,{frame.dlc},{data}\n")


def write_screen(frames, path, stamps):
    """Writes what candump prints on a terminal with `-t a` or `-t d`."""
    with open(path, "w") as log:
        last = frames[0].timestamp
        for frame in frames:
            stamp = frame.timestamp - (last if stamps == "d" else 0)
            last = frame.timestamp
            digits = 8 if frame.is_extended_id else 3
            name = f"{frame.arbitration_id:0{digits}X}"
            data = " ".join(f"{byte:02X}" for byte in frame.data)
            log.write(f" ({stamp:010.6f})  can0  {name}   [{frame.dlc}]  {data}\n")


def write_mdf(frames, path, compression, version="4.10"):
    """Writes bus events as asammdf does for bus loggers."""
    data = numpy.zeros((len(frames), 8), dtype="u1")
    for row, frame in zip(data, frames):
        row[: frame.dlc] = frame.data
    kind = numpy.dtype(
        [
            ("CAN_DataFrame.BusChannel", "u1"),
            ("CAN_DataFrame.ID", "<u4"),
            ("CAN_DataFrame.IDE", "u1"),
            ("CAN_DataFrame.DLC", "u1"),
            ("CAN_DataFrame.DataLength", "u1"),
            ("CAN_DataFrame.DataBytes", "(8,)u1"),
        ]
    )
    rows = numpy.zeros(len(frames), dtype=kind)
    rows["CAN_DataFrame.BusChannel"] = 1
    rows["CAN_DataFrame.ID"] = [frame.arbitration_id for frame in frames]
    rows["CAN_DataFrame.IDE"] = [frame.is_extended_id for frame in frames]
    rows["CAN_DataFrame.DLC"] = [frame.dlc for frame in frames]
    rows["CAN_DataFrame.DataLength"] = [frame.dlc for frame in frames]
    rows["CAN_DataFrame.DataBytes"] = data
    times = numpy.array([frame.timestamp for frame in frames])
    source = Source("CAN", "CAN", "", Source.SOURCE_BUS, Source.BUS_TYPE_CAN)
    signal = Signal(rows, times, name="CAN_DataFrame", source=source)
    with MDF(version=version) as file:
        file.configure(write_fragment_size=1 << 16)
        file.append([signal], acq_source=source, comment="frames")
        file.save(path, overwrite=True, compression=compression)


def write_mdf_4_3(frames, path, compression, method):
    """Writes the same in MDF 4.3, with Zstandard (2) or LZ4 (4) in place of deflate."""
    plain = mdf_v4.DataZippedBlock

    def block(**arguments):
        return plain(**{**arguments, "zip_type": arguments["zip_type"] + method})

    mdf_v4.DataZippedBlock = block
    try:
        write_mdf(frames, path, compression, "4.30")
    finally:
        mdf_v4.DataZippedBlock = plain


def main():
    log, folder = sys.argv[1], Path(sys.argv[2])
    frames = read(log)
    write_candump(frames, folder / "grid.log")
    for ending in ("asc", "blf", "trc", "csv", "mf4"):
        write_python_can(frames, folder / f"python_can.{ending}")
    write_savvy_can(frames, folder / "savvy_can.csv")
    write_screen(frames, folder / "screen_a.log", "a")
    write_screen(frames, folder / "screen_d.log", "d")
    for compression in (0, 1, 2):
        write_mdf(frames, folder / f"asammdf_{compression}.mf4", compression)
    for name, method in (("zstd", 2), ("lz4", 4)):
        for compression in (1, 2):
            path = folder / f"asammdf_{name}_{compression}.mf4"
            write_mdf_4_3(frames, path, compression, method)
    text = (folder / "grid.log").read_text()
    (folder / "grid.log.gz").write_bytes(gzip.compress(text.encode()))
    (folder / "utf16.log").write_bytes(text.encode("utf-16"))
    packed = (folder / "asammdf_2.mf4").read_bytes()
    (folder / "asammdf_2.mf4.gz").write_bytes(gzip.compress(packed))


main()
