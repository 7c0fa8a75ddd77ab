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
    grades, cells, statuses = [], [], []
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
        elif message.name == "GradeStatus" and data != b"\xff" * 8:
            statuses.append(signals)
    assert len(grades) > 5, f"{len(grades)} estimates"
    assert len(cells) > 100, f"{len(cells)} cells"
    assert len(statuses) > 1, f"{len(statuses)} statuses"
    for grade in grades:
        assert abs(grade["Grade"]) < 20 and 0 < grade["GradeSigma"] <= 5, grade
        assert 0.5 < grade["TractionScale"] < 2 and abs(grade["ModelBias"]) < 5, grade
    for before, after in zip(cells, cells[1:]):
        assert after["Distance"] - before["Distance"] == 2.5, (before, after)
        assert abs(after["LaggedGrade"] - before["LaggedGrade"]) < 0.5, (before, after)
    for status in statuses:
        assert 10_000 < status["GrossMass"] < 100_000, status
        assert 0 < status["GrossMassSigma"] < status["GrossMass"] / 2, status
        kinds = [status[f"{kind}Disagrees"] for kind in ("Climb", "Brake", "Torque", "Speed", "Gear")]
        assert status["Consistent"] == (sum(kinds) == 0), status
        assert status["LaggedConsistent"] in (0, 1, 3) and status["SuspectCells"] < 1000, status
    counts = f"{len(grades)} estimates, {len(cells)} cells, {len(statuses)} statuses"
    print(f"cantools {cantools.__version__}: {counts}")


main()
