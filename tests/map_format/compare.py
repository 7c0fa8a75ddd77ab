"""Compares two maps in CSV that must be equal but for the last digit.

    compare.py EXPECTED FOUND

FOUND may have more columns.
"""

import csv
import sys


def rows(path):
    with open(path) as table:
        return list(csv.DictReader(table))


expected, found = map(rows, sys.argv[1:])
assert len(expected) == len(found) > 1000, (len(expected), len(found))
for number, (left, right) in enumerate(zip(expected, found), start=2):
    for column, text in left.items():
        limit = 2e-7 if column.endswith("_deg") else 2e-3 if column == "altitude_m" else 2e-5
        same = text == right[column] or abs(float(text) - float(right[column])) < limit
        assert same, f"line {number}: {column} is {right[column]}, expected {text}"
print(f"{len(expected)} cells are equal")
