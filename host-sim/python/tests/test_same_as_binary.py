"""Runs, maps and vehicles are those of the binary, to the last bit, and so are its errors."""

import json
import tomllib

import pyarrow
import pyarrow.parquet
import roadgrade
from drives import FOLDER, LOGS, VEHICLE, DriveTest, columns_of_csv, well
from drives import roadgrade as binary


def same_values(table, of_file) -> bool:
    """Compares columns by name, kind and value; metadata and chunks may differ."""
    return table.column_names == of_file.column_names and all(
        table[name].combine_chunks().equals(of_file[name].combine_chunks())
        for name in table.column_names
    )


class Estimate(DriveTest):
    def test_cells_are_those_of_the_csv_file(self):
        well("estimate", "--vehicle", VEHICLE, "--out", FOLDER / "run.csv", LOGS[0])
        run = roadgrade.estimate(LOGS[0], VEHICLE)
        columns = pyarrow.table(run).to_pydict()
        self.assertEqual(columns, columns_of_csv(FOLDER / "run.csv"))
        self.assertGreater(len(run), 2000)
        run.save(FOLDER / "saved.csv")
        expected = (FOLDER / "run.csv").read_bytes()
        self.assertEqual((FOLDER / "saved.csv").read_bytes(), expected)

    def test_cells_are_those_of_the_parquet_file(self):
        out = FOLDER / "run.parquet"
        day = "2026-11-21"
        well("estimate", "--vehicle", VEHICLE, "--day", day, "--out", out, LOGS[0])
        run = roadgrade.estimate(LOGS[0], VEHICLE, day=day)
        cells, of_file = pyarrow.table(run), pyarrow.parquet.read_table(out)
        self.assertTrue(same_values(cells, of_file))
        self.assertEqual(cells.schema.field("grade_percent").metadata, {b"unit": b"%"})
        metadata = pyarrow.parquet.read_metadata(out).metadata
        for key, value in run.cells.metadata.items():
            self.assertEqual(metadata[key.encode()], value.encode())
        self.assertIn("roadgrade.session", run.cells.metadata)
        run.save(FOLDER / "saved.parquet")
        self.assertEqual((FOLDER / "saved.parquet").read_bytes(), out.read_bytes())

    def test_options_are_those_of_the_binary(self):
        options = ["--double", "--ignore", "gear", "--vehicle", VEHICLE]
        out = FOLDER / "options.csv"
        printed = well("estimate", *options, "--json", "--out", out, LOGS[0])
        run = roadgrade.estimate(str(LOGS[0]), VEHICLE, double=True, ignore=["gear"])
        self.assertEqual(pyarrow.table(run).to_pydict(), columns_of_csv(out))
        self.assertEqual(run.summary, json.loads(printed))
        self.assertEqual(run.verdict, run.summary["verdict"])
        self.assertEqual(run.counters, run.summary["events"])
        self.assertEqual(run.warnings, run.summary["warnings"])

    def test_a_vehicle_has_several_forms(self):
        tables = tomllib.loads(VEHICLE.read_text())
        vehicle = roadgrade.Vehicle.from_dict(tables)
        self.assertEqual(vehicle.to_dict(), tables)
        self.assertEqual(vehicle.toml, roadgrade.Vehicle.read(VEHICLE).toml)
        runs = [roadgrade.estimate(LOGS[0], form) for form in (tables, vehicle, VEHICLE)]
        self.assertTrue(all(run.vehicle.name == vehicle.name for run in runs))
        expected = pyarrow.table(runs[0])
        self.assertTrue(all(pyarrow.table(run).equals(expected) for run in runs))

    def test_parts_are_one_drive(self):
        lines = LOGS[0].read_text().splitlines(keepends=True)
        parts = [FOLDER / "part1.log", FOLDER / "part2.log"]
        parts[0].write_text("".join(lines[: len(lines) // 2]))
        parts[1].write_text("".join(lines[len(lines) // 2 :]))
        whole = pyarrow.table(roadgrade.estimate(LOGS[0], VEHICLE))
        self.assertTrue(pyarrow.table(roadgrade.estimate(parts, VEHICLE)).equals(whole))


class Identify(DriveTest):
    def test_the_file_is_that_of_the_binary(self):
        out = FOLDER / "identified.toml"
        printed = well("identify", "--json", "--out", out, *LOGS)
        vehicle = roadgrade.identify(LOGS)
        self.assertEqual(vehicle.toml, out.read_text())
        self.assertEqual(vehicle.values, json.loads(printed))
        self.assertEqual(vehicle.to_dict(), tomllib.loads(out.read_text()))
        vehicle.save(FOLDER / "saved.toml")
        self.assertEqual((FOLDER / "saved.toml").read_text(), out.read_text())

    def test_an_estimate_without_a_vehicle_identifies_it(self):
        vehicle = roadgrade.identify(LOGS[0])
        run = roadgrade.estimate(LOGS[0])
        self.assertEqual(run.vehicle.toml, vehicle.toml)
        same = roadgrade.estimate(LOGS[0], vehicle)
        self.assertTrue(pyarrow.table(run).equals(pyarrow.table(same)))


class Fuse(DriveTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.files = [FOLDER / "a.csv", FOLDER / "b.csv"]
        for out, log in zip(cls.files, LOGS):
            well("estimate", "--vehicle", VEHICLE, "--out", out, log)

    def test_the_map_is_that_of_the_binary(self):
        out = FOLDER / "map.parquet"
        well("fuse", "--out", out, *self.files)
        expected = pyarrow.parquet.read_table(out)
        runs = [roadgrade.estimate(log, VEHICLE) for log in LOGS]
        for given in (self.files, runs, [runs[0], self.files[1]]):
            fused = roadgrade.fuse(given)
            self.assertTrue(same_values(pyarrow.table(fused), expected))
            self.assertGreater(len(fused), 2000)
        fused.save(FOLDER / "saved.parquet")
        self.assertEqual((FOLDER / "saved.parquet").read_bytes(), out.read_bytes())
        again = roadgrade.read_map(FOLDER / "saved.parquet")
        self.assertTrue(pyarrow.table(again).equals(pyarrow.table(fused)))

    def test_sessions_and_roads_are_those_of_the_binary(self):
        out, road = FOLDER / "sessions.csv", FOLDER / "road.csv"
        well("fuse", "--out", road, self.files[0])
        session = f"truck={self.files[0]},{self.files[1]}"
        well("fuse", "--out", out, "--road", road, "--session", session)
        fused = roadgrade.fuse([], road=road, sessions={"truck": self.files})
        fused.save(FOLDER / "saved.csv")
        self.assertEqual((FOLDER / "saved.csv").read_bytes(), out.read_bytes())


# Without them nothing drives.
SPEEDS = ["wheel_speed_mps", "front_axle_speed_mps"]


class Errors(DriveTest):
    def assert_same(self, error, *arguments):
        """The text is what the binary prints."""
        printed = binary(*arguments).stderr.splitlines()
        self.assertIn(f"roadgrade: {error}", printed)

    def test_they_name_file_and_line(self):
        log = FOLDER / "bad.csv"
        log.write_text("time_s,wheel_speed_mps\n0,1\n1,fast\n2,1\n")
        with self.assertRaises(roadgrade.Error) as raised:
            roadgrade.estimate(log, VEHICLE, strict=True)
        self.assertEqual((raised.exception.path, raised.exception.line), (log, 3))
        out = FOLDER / "bad.out.csv"
        self.assert_same(
            raised.exception, "estimate", "--strict", "--vehicle", VEHICLE, "--out", out, log
        )

    def test_missing_files_and_signals(self):
        missing = FOLDER / "missing.log"
        for options, log in (({}, missing), ({"ignore": SPEEDS}, LOGS[0])):
            with self.assertRaises(roadgrade.Error) as raised:
                roadgrade.estimate(log, VEHICLE, **options)
            words = [word for name in options.get("ignore", []) for word in ("--ignore", name)]
            out = FOLDER / "none.csv"
            self.assert_same(
                raised.exception, "estimate", "--vehicle", VEHICLE, "--out", out, *words, log
            )
            self.assertEqual((raised.exception.path, raised.exception.line), (log, None))

    def test_vehicles(self):
        tables = tomllib.loads(VEHICLE.read_text())
        del tables["vehicle"]["mass_kg"]
        with self.assertRaisesRegex(roadgrade.Error, "^vehicle: .*missing field `mass_kg`"):
            roadgrade.estimate(LOGS[0], tables)
        tables["vehicle"]["mass_kg"] = object()
        with self.assertRaisesRegex(TypeError, "mass_kg: is a object; expected a number"):
            roadgrade.estimate(LOGS[0], tables)

    def test_wrong_arguments(self):
        for problem, wrong in (
            ("no such signal", {"ignore": ["speed"]}),
            ("dbc without signals", {"dbc": "bus.dbc"}),
            ("is not a date", {"day": "yesterday"}),
        ):
            with self.assertRaisesRegex(ValueError, problem):
                roadgrade.estimate(LOGS[0], VEHICLE, **wrong)
        with self.assertRaisesRegex(ValueError, "neither a class nor a file"):
            roadgrade.identify(LOGS, like="spaceship")
        with self.assertRaisesRegex(ValueError, "session name"):
            roadgrade.fuse([], sessions={"": LOGS})
