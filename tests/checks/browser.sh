# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# The page in a browser: the same files as the program makes, byte for byte, in headless Chromium.

readonly full_bus_minutes=${FULL_BUS_MINUTES:-30}

check_browser() {
    need_program chromium
    need_program python3
    rustup target add wasm32-wasip1 || need_target wasm32-wasip1
    local cases=$work/cases
    packaging/browser
    # All packages: this one alone would be rebuilt with other features.
    cargo build "${host_packages[@]}" --bins --examples
    page_cases "$cases"
    PYTHONDONTWRITEBYTECODE=1 python3 tests/browser/check_page.py \
        "$target/page/roadgrade.html" "${ROADGRADE:-$target/debug/roadgrade}" "$cases"
}

# long_browser: compares the time with that of the program as users have it. A gate on time would fail beside other work.
check_long_browser() {
    cargo build --profile dist --bin roadgrade
    ROADGRADE=$target/dist/roadgrade check_browser
}

# Writes a folder of files for each time that the page is used.
page_cases() {
    local cases=$1 drives=$work/drives roadgrade=$target/debug/roadgrade name
    for name in drive two_drives packed wrong only_a_vehicle no_position timed; do
        mkdir -p "$cases/$name"
    done
    simulated_drives "$drives" 3000 a b
    cp "$drives/a.log" "$cases/drive/"
    cp "$drives/a.log" "$drives/b.log" "$drives/vehicle.toml" "$cases/two_drives/"
    gzip -nc "$drives/a.log" >"$cases/packed/a.log.gz"
    printf 'one\ntwo\nthree\n' >"$cases/wrong/a.log"
    cp "$drives/vehicle.toml" "$cases/only_a_vehicle/"
    echo "vehicle.toml: no log among the files; expected one" >"$cases/only_a_vehicle/reason"
    # Without NMEA 2000 129025 and 129029.
    grep -v -e '9F801' -e 'DF805' "$drives/a.log" >"$cases/no_position/a.log"
    measured_drive "$cases"
    simulated_drives "$drives/long" 45000 a
    python3 tests/browser/full_bus.py "$drives/long/a.log" "$cases/timed/full.log" "$full_bus_minutes"
}

# A measured drive, as CSV and as Parquet, where there is one.
measured_drive() {
    local cases=$1 folder=$work/measured mission
    mission=$(find ../shared/data/ztbus -name '*.csv' 2>/dev/null | head -n 1)
    if [[ -z $mission ]]; then
        note "SKIPPED a measured drive in the browser: there is none in ../shared/data/ztbus"
        return
    fi
    "$roadgrade" --quiet import ztbus "$mission" --out "$folder" >/dev/null
    mkdir -p "$cases/measured"
    cp "$folder/vehicle.toml" "$folder/pass_01_outbound.csv" "$cases/measured/"
    want_python_package duckdb "a log in Parquet in the browser" || return 0
    mkdir -p "$cases/parquet"
    cp "$folder/vehicle.toml" "$cases/parquet/"
    "$python" -c 'import duckdb, sys; duckdb.read_csv(sys.argv[1]).write_parquet(sys.argv[2])' \
        "$folder/pass_01_outbound.csv" "$cases/parquet/a.parquet"
}
