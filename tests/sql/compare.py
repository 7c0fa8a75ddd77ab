"""Compares the maps of host-sim/sql/fuse.sql with those of `roadgrade fuse`.

    compare.py duckdb|spark STATEMENT.sql PLACED MAP.parquet...

PLACED is the output of `fuse --placed` for these maps, and each MAP is a road of it. Prints the
largest difference and the time of the statement. Fails if a difference exceeds 1e-9.
"""

import os
import pathlib
import sys
import time

LIMIT = 1e-9
PLACE = ["way", "direction", "distance_m"]
COLUMNS = [*PLACE, "altitude_m", "grade_percent", "grade_sigma_percent", "runs"]


def selected(names):
    """Returns the columns of a map for a SELECT; the map of a single road has no ways."""
    return [name if name in names else f"NULL AS {name}" for name in COLUMNS]


class DuckDb:
    def __init__(self):
        import duckdb

        self.connection = duckdb.connect()
        threads, memory = os.environ.get("DUCKDB_THREADS"), os.environ.get("DUCKDB_MEMORY")
        if threads:
            self.connection.execute(f"SET threads = {threads}")
        if memory:
            self.connection.execute(f"SET memory_limit = '{memory}'")

    def view(self, placed):
        self.connection.execute(
            "CREATE VIEW placed AS SELECT * FROM "
            f"read_parquet('{placed}/*/*.parquet', hive_partitioning = true)"
        )

    def rows(self, statement):
        return self.connection.execute(statement).fetchall()

    def close(self):
        self.connection.close()

    def map(self, path):
        names = [row[0] for row in self.rows(f"DESCRIBE SELECT * FROM '{path}'")]
        return self.rows(f"SELECT {', '.join(selected(names))} FROM '{path}'")


class Spark:
    def __init__(self):
        from pyspark.sql import SparkSession

        # Two executors, each in its own process, beside the driver.
        master = os.environ.get("SPARK_MASTER", "local-cluster[2,1,1024]")
        self.session = (
            SparkSession.builder.master(master)
            .config("spark.ui.enabled", "false")
            .config("spark.driver.host", "127.0.0.1")
            .config("spark.driver.bindAddress", "127.0.0.1")
            .config("spark.sql.shuffle.partitions", os.environ.get("SPARK_PARTITIONS", "2"))
            .config("spark.sql.adaptive.enabled", "false")
            .config("spark.ui.showConsoleProgress", "false")
            .getOrCreate()
        )
        self.session.sparkContext.setLogLevel("ERROR")

    def view(self, placed):
        self.session.sql(f"CREATE TEMPORARY VIEW placed USING parquet OPTIONS (path '{placed}')")

    def rows(self, statement):
        return [tuple(row) for row in self.session.sql(statement).collect()]

    def close(self):
        # Otherwise executors are restarted while the driver ends.
        self.session.stop()

    def map(self, path):
        table = self.session.read.parquet(str(path))
        rows = table.selectExpr(*selected(table.columns)).collect()
        return [tuple(row) for row in rows]


def difference(ours, theirs):
    """Returns the largest difference over rows, which must be of the same cells."""

    def place(row):
        return (row[0] or "", row[1] or "", row[2])

    ours, theirs = sorted(ours, key=place), sorted(theirs, key=place)
    if [place(row) for row in ours] != [place(row) for row in theirs]:
        raise SystemExit(f"{len(theirs)} cells of the statement; fuse has {len(ours)}, or others")
    worst = 0.0
    for a, b in zip(ours, theirs):
        a, b = a[len(PLACE) :], b[len(PLACE) :]
        if (a[0] is None) != (b[0] is None) or int(a[3]) != int(b[3]):
            raise SystemExit(f"{b} of the statement; fuse has {a}")
        pairs = [(x, y) for x, y in zip(a, b) if x is not None]
        worst = max(worst, max(abs(x - y) for x, y in pairs))
    return worst


def main():
    name, statement, placed, *maps = sys.argv[1:]
    engine = {"duckdb": DuckDb, "spark": Spark}[name]()
    try:
        compare(engine, name, statement, placed, maps)
    finally:
        engine.close()


def compare(engine, name, statement, placed, maps):
    engine.view(pathlib.Path(placed).resolve())
    started = time.monotonic()
    rows = engine.rows(pathlib.Path(statement).read_text())
    seconds = time.monotonic() - started
    of_road = {}
    for row in rows:
        of_road.setdefault(row[0], []).append(row[1:])
    roads = [pathlib.Path(path).stem for path in maps]
    if sorted(of_road) != sorted(roads):
        raise SystemExit(f"roads {sorted(of_road)} of the statement; expected {sorted(roads)}")
    for road, path in zip(roads, maps):
        apart = difference(engine.map(pathlib.Path(path).resolve()), of_road[road])
        cells = len(of_road[road])
        print(f"{name}: {road}: {cells} cells, at most {apart:.1e} apart, {seconds:.1f} s in all")
        if not (cells > 0 and apart <= LIMIT):
            raise SystemExit(f"{name}: more than {LIMIT} apart")


main()
