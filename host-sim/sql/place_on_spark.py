"""Places runs on a road or a network, spread over the executors of a Spark cluster.

    spark-submit place_on_spark.py --road NETWORK.geojson --out PLACED RUNS...

RUNS are run files or folders of them, PLACED is a folder; road, runs and folder must have the same path
on all machines. Each task runs `roadgrade place` on some of the files. A task that fails is tried again
by Spark, and the whole job may be started again: runs that were placed are not read again. Then
fuse.sql sums the placed cells.
"""

import argparse
import pathlib
import subprocess

from pyspark.sql import SparkSession

RUN_SUFFIXES = {".parquet", ".csv"}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--road", required=True, help="road or network, as `roadgrade place` takes it")
    parser.add_argument("--out", required=True, help="folder for the placed runs")
    parser.add_argument("--program", default="roadgrade", help="the program on the executors")
    parser.add_argument("--files-a-task", type=int, default=16, help="run files of one task")
    parser.add_argument("runs", nargs="+", type=pathlib.Path, help="run files, or folders of them")
    return parser.parse_args()


def run_files(paths):
    """Returns the run files at these paths, in an order that does not depend on the file system."""
    for path in paths:
        if path.is_dir():
            found = (file for file in path.rglob("*") if file.suffix in RUN_SUFFIXES)
            yield from sorted(str(file.resolve()) for file in found)
        else:
            yield str(path.resolve())


def placing(program, road, out):
    """Returns the work of a task."""

    def place(files):
        files = list(files)
        if not files:
            return []
        command = [program, "place", "--quiet", "--road", road, "--out", out, *files]
        done = subprocess.run(command, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{program} place: status {done.returncode}: {done.stderr[-2000:]}")
        return [len(files)]

    return place


def main():
    options = arguments()
    files = list(run_files(options.runs))
    if not files:
        raise SystemExit("no run files there")
    road, out = (str(pathlib.Path(path).resolve()) for path in (options.road, options.out))
    session = SparkSession.builder.appName("roadgrade place").getOrCreate()
    tasks = -(-len(files) // options.files_a_task)
    spread = session.sparkContext.parallelize(files, tasks)
    placed = spread.mapPartitions(placing(options.program, road, out)).sum()
    print(f"{placed} run files placed by {tasks} tasks")
    session.stop()


main()
