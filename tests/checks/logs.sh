# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# Logs that the public tools python-can and asammdf write: each format gives the same cells.

check_logs() {
    need_program python3
    local roadgrade=$target/debug/roadgrade runs=$work/logs log status=0
    want_python_package python-can "logs of other programs" || return 0
    want_python_package asammdf "logs of other programs" || return 0
    build_roadgrade
    mkdir -p "$runs/formats"
    simulated_drives "$runs" 3000 a
    "$python" tests/logs/write_logs.py "$runs/a.log" "$runs/formats"
    cells_of_log "$runs/formats/grid.log" "$runs/expected.csv"
    for log in "$runs"/formats/*; do
        cells_of_log "$log" "$runs/cells.csv"
        if cmp "$runs/expected.csv" "$runs/cells.csv"; then
            echo "same cells: ${log##*/}"
        else
            status=1
        fi
    done
    return "$status"
}

cells_of_log() {
    "$roadgrade" estimate --vehicle "$runs/a.vehicle.toml" --out "$2" "$1" >/dev/null
}
