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
    grades, cells, statuses, ahead, next_grades = [], [], [], [], []
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
        elif message.name == "GradeAhead":
            ahead.append(signals)
        elif message.name == "PCC1" and data[6] != 0xFF:
            next_grades.append(signals)
    assert len(grades) > 5, f"{len(grades)} estimates"
    assert len(cells) > 100, f"{len(cells)} cells"
    assert len(statuses) > 1, f"{len(statuses)} statuses"
    assert len(ahead) > 20 and next_grades, f"{len(ahead)} parts of the road ahead"
    for part in ahead:
        if part["Content"] == 0:
            assert part["HorizonLength"] == 2200 and 0 <= part["BranchFrom"] <= 2200, part
        elif part["Content"] == 1 and part["AheadGrade"] < 65:
            assert abs(part["AheadGrade"]) < 20 and part["AheadGradeSigma"] <= 2.5, part
    for grade in next_grades:
        assert abs(grade["RoadwayNextGrade"]) <= 16 and grade["NextGradeDistance"] <= 2200, grade
    for grade in grades:
        assert abs(grade["Grade"]) < 20 and 0 < grade["GradeSigma"] <= 5, grade
        assert 0.5 < grade["TractionScale"] < 2 and abs(grade["ModelBias"]) < 5, grade
    for before, after in zip(cells, cells[1:]):
        assert after["Distance"] - before["Distance"] == 2.5, (before, after)
        assert abs(after["LaggedGrade"] - before["LaggedGrade"]) < 0.5, (before, after)
    for status in statuses:
        assert 10_000 < status["GrossMass"] < 100_000, status
        assert 0 < status["GrossMassSigma"] < status["GrossMass"], status
        kinds = [status[f"{kind}Disagrees"] for kind in ("Climb", "Brake", "Torque", "Speed", "Gear")]
        assert status["Consistent"] == (sum(kinds) == 0), status
        assert status["LaggedConsistent"] in (0, 1, 3) and status["SuspectCells"] < 1000, status
    counts = f"{len(grades)} estimates, {len(cells)} cells, {len(statuses)} statuses, {len(ahead)} parts ahead"
    print(f"cantools {cantools.__version__}: {counts}")


main()
