# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# The reader of packed maps that docs/map-grade.md shows: it prints what the program packed.

check_map_format() {
    want_python_package numpy "the reader of packed maps" || skip "NumPy is not installed"
    local roadgrade=$target/debug/roadgrade maps=$work/maps
    build_roadgrade
    simulated_drives "$maps" 5000 a
    "$roadgrade" map --out "$maps/map" --vehicle "$maps/a.vehicle.toml" "$maps/a.log" >/dev/null
    "$roadgrade" pack "$maps/map/map.csv" --out "$maps/map.grade"
    "$roadgrade" export "$maps/map.grade" --out "$maps/back.csv"
    # The one block of Python on the page.
    awk '/^`+python$/ { inside = 1; next } /^`+$/ { inside = 0 } inside' docs/map-grade.md >"$maps/read.py"
    "$python" "$maps/read.py" "$maps/map.grade" >"$maps/read.csv"
    "$python" tests/map_format/compare.py "$maps/back.csv" "$maps/read.csv"
}
