# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# Fuzzing: arbitrary input, steered by coverage.

# The flags of cargo-fuzz for coverage, so that the stable toolchain without cargo-fuzz suffices.
readonly coverage="--cfg fuzzing -Cpasses=sancov-module \
-Cllvm-args=-sanitizer-coverage-level=4 \
-Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
-Cllvm-args=-sanitizer-coverage-pc-table \
-Cllvm-args=-sanitizer-coverage-trace-compares \
-Cllvm-args=-sanitizer-coverage-stack-depth"

# Starts from the committed seeds and is the same each time. `long_fuzz` takes an hour a target.
check_fuzz() {
    build_fuzz
    local name runs
    while read -r name; do
        runs=20000
        [[ $name != estimator ]] || runs=1000
        mkdir "$work/$name"
        echo "$name"
        "$(fuzz_program "$name")" "$work/$name" "tests/fuzz/corpus/$name" \
            -runs="$runs" -seed=20110301 -max_len=4096 -timeout=60 -verbosity=0 2>&1 |
            sed '/^"/d; /dictionary/d' || return 1 # A crash exits as a skipped check does: 77.
    done < <(fuzz_names)
}

fuzz_names() {
    local path
    for path in tests/fuzz/fuzz_targets/*.rs; do
        path=${path##*/}
        echo "${path%.rs}"
    done
}

fuzz_program() {
    echo "$target/fuzz/$(host_triple)/release/$1"
}

host_triple() {
    rustc -vV | sed -n 's/^host: //p'
}

# The target is named, so that build scripts are built without coverage.
build_fuzz() {
    RUSTFLAGS=$coverage cargo build --release --manifest-path tests/fuzz/Cargo.toml --bins \
        --target "$(host_triple)" --target-dir "$target/fuzz"
}
