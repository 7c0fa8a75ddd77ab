# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# Checks that take hours. Each writes a committed file in tests/long: comments with the source that
# it belongs to and with the amount, then the figures.

readonly soak_days=${SOAK_DAYS:-365}
readonly seeds=${SEEDS:-20}
readonly diagnosis_sizes=${DIAGNOSIS_SIZES:-0.05,0.1,0.3}
readonly fuzz_s=${FUZZ_S:-3600}
readonly fuzz_jobs=${FUZZ_JOBS:-$(nproc)}
readonly mutants_shard=${MUTANTS_SHARD:-0/1}
readonly bad_inputs=${BAD_INPUTS:-500000}
readonly bus_minutes=${BUS_MINUTES:-60}
readonly trucks=${TRUCKS:-28}
readonly manoeuvres=${MANOEUVRES:-300}
readonly manoeuvres_seed=${MANOEUVRES_SEED:-$(date -u +%Y%m%d)}
# The largest accepted part of random drives that lie, %: 19 % did when this was written (36 of the 200
# of tests/faults.md, 61 of 300 with seed 20261122), and three standard errors of 300 drives more. It is
# no aim: lower it as the rate falls.
readonly most_lying_percent=27
readonly long_results=(
    soak.csv seeds.csv diagnosis.txt fuzz.csv mutants.csv bad_input.csv bus.csv manoeuvres.csv trucks.csv coverage.csv
)

# One estimator on a truck that drives for SOAK_DAYS days without a stop.
check_long_soak() {
    local log=$work/log status=0
    SOAK_DAYS=$soak_days cargo test "${host_packages[@]}" --test faults many_days_without_a_stop -- \
        --ignored --nocapture 2>&1 | tee "$log" || status=$?
    {
        echo "days,rms_laps_3_to_12_percent,rms_last_10_laps_percent,result"
        sed -n 's/^.*live, % RMS: \([0-9.]*\) in .*, \([0-9.]*\) in .*$/\1,\2/p' "$log" |
            sed "s/^/$soak_days,/; s/\$/,$(result_of "$status")/"
    } | write_result soak.csv "$soak_days days of driving"
    return "$status"
}

# The quick tests with many seeds. The property tests draw other cases with each seed.
check_long_seeds() {
    local seed counts rows=$work/rows
    for ((seed = 1; seed <= seeds; seed++)); do
        PROPTEST_RNG_SEED=$seed PROPTEST_CASES=1024 check_test_quick >"$work/log" 2>&1 ||
            cat "$work/log"
        counts=$(sed -n 's/^tests: \(.*\) passed; \(.*\) failed.*$/\1,\2/p' "$work/log")
        echo "$seed,$counts" | tee -a "$rows"
    done
    { echo "seed,tests_passed,tests_failed" && cat "$rows"; } |
        write_result seeds.csv "$seeds seeds, 1024 cases a property"
    ! grep -qv ',0$' "$rows"
}

# Drives with two or three manoeuvres or faults at once. The seed is the date, so that each day draws
# others.
check_long_manoeuvres() {
    [[ -f ../shared/data/e4/road.csv ]] || not_run manoeuvres.csv "there is no measured road"
    local log=$work/log status=0
    echo "seed: $manoeuvres_seed"
    cargo run -p cross-tests --example manoeuvres -- --random "$manoeuvres" \
        --seed "$manoeuvres_seed" --most-lying "$most_lying_percent" >"$log" || status=$?
    cat "$log"
    {
        echo "# bar: at most $most_lying_percent % of the drives lie: 19 % when it was set, and a margin"
        echo "seed,drives,lying,missing_a_bar,without_result,windows,above_4_smoothed,above_4_lagged,above_4_live,above_9_smoothed,above_9_lagged,above_9_live,result"
        echo "$manoeuvres_seed,$(manoeuvre_totals "$log"),$(result_of "$status")"
    } | write_result manoeuvres.csv "$manoeuvres drives drawn with seed $manoeuvres_seed"
    return "$status"
}

# Prints the totals of a log of the bench as fields of a row.
manoeuvre_totals() {
    local drives windows
    drives=$(sed -n 's/^\([0-9]*\) drives: \([0-9]*\) lie, \([0-9]*\) miss .*, \([0-9]*\) without result$/\1,\2,\3,\4/p' "$1")
    windows=$(sed -n 's/^windows of 5 km (s\/l\/v): \([0-9]*\) .*NEES above 4: \([^;]*\); above 9: \(.*\)$/\1,\2,\3/p' "$1")
    echo "$drives,${windows// \/ /,}"
}

# Trucks drawn with the date as seed, their vehicle file withheld.
check_long_trucks() {
    local log=$work/log status=0
    TRUCKS=$trucks TRUCKS_SEED=$manoeuvres_seed cargo test -p host-sim --test identify drawn:: -- --nocapture 2>&1 |
        tee "$log" || status=$?
    {
        echo "# bars: smoothed_ratio 1.2, live_ratio 1.3 (live after the first 10 km); $(result_of "$status")"
        echo "truck,log,mass_kg,gears,smoothed_percent,smoothed_ratio,live_percent,live_ratio,smoothed_nees,live_nees"
        sed -n 's/^.*drawn,\([0-9].*\)$/\1/p' "$log"
    } | write_result trucks.csv "$trucks trucks drawn with seed $manoeuvres_seed, on a full bus and on a bare one"
    return "$status"
}

# The bench of the diagnosis, on logs of many seeds.
check_long_diagnosis() {
    local status=0
    cargo run --release -p cross-tests --example diagnosis_bench -- \
        --seeds "$seeds" --sizes "$diagnosis_sizes" >"$work/table" || status=$?
    write_result diagnosis.txt "effects of $diagnosis_sizes % on two trucks, $seeds seeds" \
        <"$work/table"
    return "$status"
}

# Fuzzes each target for FUZZ_S seconds, FUZZ_JOBS of them beside each other, from the seeds and the
# inputs that earlier runs found.
check_long_fuzz() {
    build_fuzz
    local name
    while read -r name; do
        while (($(jobs -rp | wc -l) >= fuzz_jobs)); do
            wait -n || true # The result of each is in its row.
        done
        fuzz_long "$name" &
    done < <(fuzz_names)
    wait
    { echo "target,runs,coverage,features,inputs,result" && cat "$work"/*.row; } |
        write_result fuzz.csv "$fuzz_s s a target"
    (($(grep -c ',passed$' tests/long/fuzz.csv) == $(fuzz_names | wc -l)))
}

fuzz_long() {
    local name=$1 found=$target/fuzz/corpus/$1 log=$work/$1.log status=0
    mkdir -p "$found" "$target/fuzz/artifacts"
    "$(fuzz_program "$name")" "$found" "tests/fuzz/corpus/$name" -max_total_time="$fuzz_s" \
        -max_len=4096 -timeout=60 -print_final_stats=1 \
        -artifact_prefix="$target/fuzz/artifacts/$name-" >"$log" 2>&1 || status=$?
    ((status == 0)) || tail -n 40 "$log"
    local reached runs
    reached=$(grep -o 'cov: .*' "$log" | tail -n 1 |
        sed 's/^cov: \([0-9]*\) ft: \([0-9]*\) corp: \([0-9]*\).*$/\1,\2,\3/')
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    echo "$name,$runs,$reached,$(result_of "$status")" | tee "$work/$name.row"
    return "$status"
}

# Generated bad inputs in every command.
check_long_bad_input() {
    local log=$work/log status=0
    BAD_INPUT_CASES=$bad_inputs cargo test -p host-sim --test bad_input generated::bad_inputs -- \
        --nocapture 2>&1 | tee "$log" || status=$?
    {
        echo "cases,with_a_result,wrong,peak_mb,longest_s,result"
        sed -n 's/^bad inputs: \(.*\) cases, \(.*\) of them done, \(.*\) wrong, at most \(.*\) MB and \(.*\) s$/\1,\2,\3,\4,\5/p' "$log" |
            sed "s/\$/,$(result_of "$status")/"
    } | write_result bad_input.csv "$bad_inputs generated inputs"
    return "$status"
}

# A bus at full load for BUS_MINUTES minutes.
check_long_bus() {
    local log=$work/log status=0
    export BUS_MINUTES=$bus_minutes PASSED=BUS_MINUTES
    export VCAN_TIMEOUT_S=$((bus_minutes * 90 + 600))
    on_virtual_bus "$log" a_bus_at_full_load_for_minutes || status=$?
    {
        echo "minutes,frames,wanted,lost,dropped,cells,cells_of_the_drive,off_sigma,late_ms,result"
        sed -n '/^full load: /s/[^0-9.]\+/,/gp' "$log" |
            sed "s/^,//; s/,\$//; s/\$/,$(result_of "$status")/"
    } | write_result bus.csv "$bus_minutes minutes at full load"
    return "$status"
}

# Changes lines of the core. A test of the core must fail.
check_long_mutants() {
    has_mutants || not_run mutants.csv "cargo-mutants could not be installed"
    local outcome path=$target/mutants/mutants.out
    mutate "$target/mutants" --shard "$mutants_shard" --sharding round-robin
    {
        echo "outcome,count"
        for outcome in caught missed timeout unviable; do
            echo "$outcome,$(wc -l <"$path/$outcome.txt")"
        done
        sed 's/^/# missed: /' "$path/missed.txt"
    } | write_result mutants.csv "shard $mutants_shard of the mutants of the core"
    cargo run -q -p evidence -- mutants "$path/missed.txt"
}

# --- results ---------------------------------------------------------------------------------------

# Reports the results that are older than the source. They do not fail the check.
check_long_results() {
    local name file source
    source=$(source_digest)
    for name in "${long_results[@]}"; do
        file=tests/long/$name
        if [[ ! -f $file ]]; then
            note "tests/long: no result of $name"
        elif grep -q '^# not run: ' "$file"; then
            note "tests/long: $name was not run: $(sed -n 's/^# not run: //p' "$file")"
        elif ! grep -qx "# source: $source" "$file"; then
            note "tests/long: the result of $name is older than the source"
        else
            echo "$name: of this source"
        fi
    done
}

# The digest of the estimator and of the simulator.
source_digest() {
    find estimator-core/src host-sim/src -type f -print0 | LC_ALL=C sort -z |
        xargs -0 sha256sum | sha256sum | cut -c 1-16
}

# Writes stdin to a result, with the source and the amount.
write_result() {
    local name=$1 amount=$2
    {
        echo "# source: $(<"$work/source")"
        echo "# date: $(date -u +%F)"
        echo "# amount: $amount"
        echo "# seconds: $((SECONDS - started))"
        cat
    } >"$work/$name.result"
    mv "$work/$name.result" "tests/long/$name"
    echo "tests/long/$name:"
    sed 's/^/    /' "tests/long/$name"
}

# Ends the check and writes the reason as its result.
not_run() {
    printf '# source: %s\n# not run: %s\n' "$(source_digest)" "$2" >"tests/long/$1"
    skip "$2"
}

result_of() {
    if (($1 == 0)); then
        echo passed
    else
        echo failed
    fi
}
