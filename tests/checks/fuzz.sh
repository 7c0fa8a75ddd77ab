# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# Fuzzing: arbitrary input, steered by coverage. The test `damaged_seeds` runs the same targets without.

# The flags of cargo-fuzz for coverage, so that the stable toolchain without cargo-fuzz suffices.
readonly coverage="--cfg fuzzing -Cpasses=sancov-module \
-Cllvm-args=-sanitizer-coverage-level=4 \
-Cllvm-args=-sanitizer-coverage-inline-8bit-counters \
-Cllvm-args=-sanitizer-coverage-pc-table \
-Cllvm-args=-sanitizer-coverage-trace-compares \
-Cllvm-args=-sanitizer-coverage-stack-depth"

fuzz_names() {
    local path
    for path in tests/fuzz/fuzz_targets/*.rs; do
        path=${path##*/}
        echo "${path%.rs}"
    done
}

fuzz_program() {
    echo "$target/fuzz/$(host_triple)/debug/$1"
}

host_triple() {
    rustc -vV | sed -n 's/^host: //p'
}

# The target is named, so that build scripts are built without coverage.
build_fuzz() {
    RUSTFLAGS=$coverage cargo build -p fuzz-targets --features libfuzzer --bins \
        --target "$(host_triple)" --target-dir "$target/fuzz"
}
