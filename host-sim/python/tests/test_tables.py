"""Tables of logs, and what other libraries make of tables."""

import json
import re

import geopandas
import polars
import pyarrow
import pyarrow.parquet
import roadgrade
from drives import FOLDER, LOGS, VEHICLE, DriveTest, well


class Logs(DriveTest):
    def test_frames_are_those_of_the_log(self):
        table = pyarrow.table(roadgrade.read_frames(LOGS[0]))
        line = re.compile(r"\((\d+\.\d+)\) \S+ ([0-9A-F]+)#([0-9A-F]*)")
        expected = [line.match(text).groups() for text in LOGS[0].read_text().splitlines()]
        self.assertEqual(table.num_rows, len(expected))
        self.assertEqual(table["time_s"].to_pylist(), [float(of[0]) for of in expected])
        self.assertEqual(table["id"].to_pylist(), [int(of[1], 16) for of in expected])
        data = [bytes.fromhex(of[2]) for of in expected]
        self.assertEqual(table["data"].to_pylist(), data)
        first = table.slice(0, 1).to_pylist()[0]
        self.assertEqual(first["pgn"], (first["id"] >> 8 & 0x3FFFF) & (
            0x3FF00 if first["id"] >> 16 & 0xFF < 240 else 0x3FFFF))
        self.assertEqual(first["source"], first["id"] & 0xFF)

    def test_every_format_gives_the_same_frames(self):
        packed = FOLDER / "monday.log.gz"
        import gzip
        packed.write_bytes(gzip.compress(LOGS[0].read_bytes(), 1))
        plain = pyarrow.table(roadgrade.read_frames(LOGS[0]))
        self.assertTrue(pyarrow.table(roadgrade.read_frames(packed)).equals(plain))

    def test_signals_are_a_table_that_can_be_estimated(self):
        table = pyarrow.table(roadgrade.read_log(LOGS[0]))
        speeds = table["wheel_speed_mps"].drop_null()
        self.assertEqual(speeds.type, pyarrow.float32())
        self.assertEqual(table.schema.field("wheel_speed_mps").metadata, {b"unit": b"m/s"})
        self.assertGreater(len(speeds), 1000)
        report = json.loads(table.schema.metadata[b"roadgrade.report"])
        self.assertEqual(report["damage"]["lines"], 0)
        # It is a signal table: its signals give the same grade as the frames, but for the inputs of
        # several senders.
        path = FOLDER / "signals.parquet"
        pyarrow.parquet.write_table(table, path)
        again = pyarrow.table(roadgrade.read_log(path))
        self.assertTrue(again.equals(table))
        run = roadgrade.estimate(path, VEHICLE)
        self.assertEqual(run.verdict, "consistent")

    def test_signals_can_be_left_out(self):
        table = roadgrade.read_log(LOGS[0], ignore=["altitude_m", "gear"])
        self.assertNotIn("altitude_m", table.column_names)
        self.assertNotIn("gear", table.column_names)
        self.assertIn("wheel_speed_mps", table.column_names)

    def test_a_signal_table_has_no_frames(self):
        path = FOLDER / "table.csv"
        path.write_text("time_s,wheel_speed_mps\n0,1.5\n1,\n2,2.5\n")
        with self.assertRaisesRegex(roadgrade.Error, "has no frames"):
            roadgrade.read_frames(path)
        table = pyarrow.table(roadgrade.read_log(path)).to_pydict()
        self.assertEqual(table, {"time_s": [0.0, 2.0], "wheel_speed_mps": [1.5, 2.5]})


class Libraries(DriveTest):
    def test_memory_is_shared(self):
        run = roadgrade.estimate(LOGS[0], VEHICLE)
        def address(table):
            return pyarrow.table(table)["grade_percent"].chunk(0).buffers()[1].address
        self.assertEqual(address(run), address(run.cells))
        before = pyarrow.total_allocated_bytes()
        tables = [pyarrow.table(run) for _ in range(100)]
        self.assertLess(pyarrow.total_allocated_bytes() - before, 10_000)
        # A table outlives what it came from.
        cells = run.cells
        expected = tables[0]["grade_percent"].to_pylist()
        del run, tables
        self.assertEqual(pyarrow.table(cells)["grade_percent"].to_pylist(), expected)

    def test_polars_and_pandas_read_a_run(self):
        run = roadgrade.estimate(LOGS[0], VEHICLE)
        expected = pyarrow.table(run)["grade_percent"].to_pylist()
        self.assertEqual(polars.DataFrame(run)["grade_percent"].to_list(), expected)
        frame = pyarrow.table(run).to_pandas()
        self.assertEqual(frame["grade_percent"].to_list(), expected)

    def test_geopandas_reads_a_map(self):
        runs = [roadgrade.estimate(log, VEHICLE) for log in LOGS]
        fused = roadgrade.fuse(runs)
        frame = geopandas.GeoDataFrame.from_arrow(fused)
        self.assertEqual(frame.crs.to_string(), "OGC:CRS84")
        self.assertEqual(frame.geometry.x.to_list(), frame["longitude_deg"].to_list())
        self.assertEqual(frame.geometry.y.to_list(), frame["latitude_deg"].to_list())
        # A copy that pyarrow writes is GeoParquet too.
        path = FOLDER / "written.parquet"
        pyarrow.parquet.write_table(pyarrow.table(fused), path)
        again = geopandas.read_parquet(path)
        self.assertTrue(again.geometry.equals(frame.geometry))

    def test_a_packed_map_is_read(self):
        runs = [roadgrade.estimate(log, VEHICLE) for log in LOGS]
        roadgrade.fuse(runs).save(FOLDER / "map.csv")
        well("pack", FOLDER / "map.csv", "--out", FOLDER / "map.grade")
        packed = roadgrade.read_map(FOLDER / "map.grade")
        self.assertIn("grade_percent", packed.cells.column_names)
        run = roadgrade.estimate(LOGS[0], VEHICLE, map=FOLDER / "map.grade")
        known = pyarrow.table(run)["map_grade_percent"].drop_null()
        self.assertGreater(len(known), 1000)
