# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# Compares the statement of host-sim/sql with fuse, on DuckDB and on Spark with two executors.

check_sql() {
    need_program python3
    local runs=$work/sql status=0
    local fuse=("$target/debug/roadgrade" fuse --placed "$runs/placed")
    build_roadgrade
    # Twelve runs of two trucks, one without a session. Those of the second truck are another road.
    "$target/debug/examples/fleet" "$runs" 480000
    "${fuse[@]}" --out "$runs/all.parquet" --road "$runs/road.csv" "$runs/runs"
    "${fuse[@]}" --out "$runs/second.parquet" "$runs"/runs/*/day=2026-11-02
    # The network around the road. Its runs are placed by a process for each of two partitions.
    "$target/debug/roadgrade" fuse --out "$runs/network.parquet" --road "$runs/network.geojson" \
        "$runs/runs"
    local day
    for day in 1 2; do
        "$target/debug/roadgrade" place --road "$runs/network.geojson" --out "$runs/placed" \
            "$runs"/runs/*/day=2026-11-0$day
    done
    await_setup
    compare_sql duckdb duckdb || status=1
    if (need_program java); then
        # Only this machine needs to reach it.
        export SPARK_LOCAL_IP=127.0.0.1
        compare_sql spark pyspark || status=1
        place_on_spark || status=1
    else
        note "SKIPPED the fusion on Spark: there is no java"
    fi
    return "$status"
}

# Places the runs on the network once more, by tasks of Spark that are killed ten times.
place_on_spark() {
    local again=$runs/again marks=$runs/interruptions
    has_python_package pyspark || return 0
    mkdir -p "$again" "$marks"
    PATH=$(dirname "$python"):$PATH PYSPARK_PYTHON=$python \
        ROADGRADE=$target/debug/roadgrade INTERRUPTIONS=$marks \
        spark-submit --master 'local-cluster[2,1,1024]' \
        --conf spark.task.maxFailures=30 --conf spark.ui.enabled=false \
        host-sim/sql/place_on_spark.py --program "$PWD/tests/sql/interrupted.py" --files-a-task 3 \
        --road "$runs/network.geojson" --out "$again" "$runs/runs" 2>"$work/spark.log" ||
        { tail -n 40 "$work/spark.log" && return 1; }
    echo "interruptions: $(find "$marks" -type f | wc -l)"
    "$python" tests/sql/compare.py duckdb host-sim/sql/fuse.sql "$again" "$runs/network.parquet"
}

# Runs the comparison on an engine, which is a package of PyPI.
compare_sql() {
    local engine=$1 package=$2
    want_python_package "$package" "the fusion on $engine" || return 0
    "$python" tests/sql/compare.py "$engine" host-sim/sql/fuse.sql "$runs/placed" \
        "$runs/all.parquet" "$runs/second.parquet" "$runs/network.parquet"
}
