"""Reads lines of `candump -L` from stdin, decodes the published estimate with its layout file, and
checks that it is a drive: `decode.py grade.dbc <recording`.

cantools reads the layout file and the frames. This script does not know the position of a signal.
"""

import re
import sys

import cantools

LINE = re.compile(r"^\(\d+\.\d+\) \S+ ([0-9A-F]{8})#([0-9A-F]{16})$")


def main():
    layout = cantools.database.load_file(sys.argv[1])
    grades, cells = [], []
    for line in sys.stdin:
        match = LINE.match(line.strip())
        if not match:
            continue
        message = layout.get_message_by_frame_id(int(match[1], 16))
        data = bytes.fromhex(match[2])
        signals = message.decode(data, decode_choices=False)
        if message.name == "GradeLive" and data != b"\xff" * 8:
            grades.append(signals)
        elif message.name == "GradeCell":
            cells.append(signals)
    assert len(grades) > 5, f"{len(grades)} estimates"
    assert len(cells) > 100, f"{len(cells)} cells"
    for grade in grades:
        assert abs(grade["Grade"]) < 20 and 0 < grade["GradeSigma"] <= 5, grade
        assert 0.5 < grade["TractionScale"] < 2 and abs(grade["ModelBias"]) < 5, grade
    for before, after in zip(cells, cells[1:]):
        assert after["Distance"] - before["Distance"] == 2.5, (before, after)
        assert abs(after["LaggedGrade"] - before["LaggedGrade"]) < 0.5, (before, after)
    print(f"cantools {cantools.__version__}: {len(grades)} estimates, {len(cells)} cells")


main()
