# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# A router builds its graph with the elevation tiles of a map, and has the map's slopes.

check_routers() {
    need_program python3
    local roadgrade=$target/debug/roadgrade
    want_python_package osmium "Valhalla on a map" || return 0
    # Building it from source takes an hour and a dozen libraries.
    PIP_ONLY_BINARY=pyvalhalla want_python_package pyvalhalla "Valhalla on a map" || return 0
    if [[ ! -x $target/python/bin/valhalla_build_tiles ]]; then
        skip "pyvalhalla has no valhalla_build_tiles for $("$python" --version); expected Python 3.12 or later"
    fi
    build_roadgrade
    "$python" tests/routers/compare.py "$roadgrade" "$work/routers"
}
