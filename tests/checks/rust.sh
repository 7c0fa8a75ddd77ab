# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# Checks by cargo on the host: format, clippy, documentation, tests and Miri.

# Property tests draw the same cases each time, so that a red run can be repeated.
export PROPTEST_RNG_SEED=${PROPTEST_RNG_SEED:-20110301} PROPTEST_DISABLE_FAILURE_PERSISTENCE=true

# The packages that hosts test. They are built together: one alone would be rebuilt with other features.
readonly host_packages=(-p estimator-core -p host-sim -p cross-tests -p test-kit)

# These test binaries take most of the time.
readonly slow_tests=(diagnosis thesis faults accuracy_others)

check_format() {
    cargo fmt --check
    # Workspaces of their own.
    local own
    for own in tests/peers firmware/stm32g4 tests/benches; do
        cargo fmt --check --manifest-path "$own/Cargo.toml"
    done
    # A macro declares these files, so cargo does not see them.
    rustfmt --check --edition 2024 estimator-core/src/effect/*.rs
    check_subjects
    if has_program shellcheck; then
        shellcheck tests/run tests/checks/*.sh tests/vcan/machine tests/benches/run
    fi
}

# The subjects of the last commits: scope and imperative, at most 60 characters.
check_subjects() {
    local wrong
    wrong=$(git log -5 --no-merges --format=%s 2>/dev/null |
        awk 'length > 60 || !/^[a-z0-9_-]+(, [a-z0-9_-]+)*: ./')
    if [[ -n $wrong ]]; then
        printf 'commit subjects; expected "scope: imperative", at most 60 characters:\n%s\n' "$wrong"
        return 1
    fi
}

check_clippy() {
    cargo clippy --workspace --exclude firmware --exclude estimator-c --all-targets -- -D warnings
}

check_docs() {
    RUSTDOCFLAGS="-D warnings" cargo doc "${host_packages[@]}" --no-deps
    cargo test "${host_packages[@]}" --doc
    need_target "$board"
    RUSTDOCFLAGS="-D warnings" cargo doc --no-deps -p firmware --target "$board"
}

check_test_quick() {
    run_tests "${slow_tests[@]}" firmware
}

# All tests except the examples in the documentation (see docs) and those of the firmware's images
# (see firmware).
check_test() {
    run_tests firmware
}

# Runs the tests of all packages except those of the named binaries. It always builds the same, so
# that nothing is rebuilt with other features.
run_tests() {
    local name log=$work/tests status=0 tests=()
    while read -r name; do
        [[ " $* " == *" $name "* ]] || tests+=(--test "$name")
    done < <(test_names)
    cargo test "${host_packages[@]}" --lib --bins --no-fail-fast "${tests[@]}" -- --show-output 2>&1 |
        tee "$log" || status=$?
    totals "$log"
    # Failed tests; and the targets, since one that is killed names no test.
    { grep -hE '^(SKIPPED|test .* \.\.\. FAILED$|    `-p )' "$log" || true; } | sort -u >>"$work/notes"
    return "$status"
}

# Builds an example of these packages, and runs it with the arguments that follow its name.
run_example() {
    local name=$1
    shift
    cargo build -q "${host_packages[@]}" --example "$name"
    "$target/debug/examples/$name" "$@"
}

# Prints the names of the test binaries.
test_names() {
    local path
    for path in {estimator-core,host-sim,tests}/tests/{*.rs,*/main.rs}; do
        [[ -f $path ]] || continue
        path=${path%/main.rs}
        path=${path##*/}
        echo "${path%.rs}"
    done
}

# Prints the sum of the test results in a log.
totals() {
    awk '/^test result:/ { passed += $4; failed += $6; ignored += $8 }
        END { printf "tests: %d passed; %d failed; %d ignored\n", passed, failed, ignored }' "$1"
}

# The C interface, the only `unsafe` of what runs on a controller.
check_miri() {
    need_miri
    under_miri -p estimator-c --test misuse
}

# The core has no `unsafe`, but its dependencies have. Without two tests that take minutes there; others
# lead through the same code.
check_miri_core() {
    need_miri
    under_miri -p estimator-core --features fixed --test signal --test numerics -- \
        --skip transport::no_payload_mixes_two \
        --skip own_messages::a_reserved_signal_is_not_taken_from_built_in_messages
}

need_miri() {
    cargo +nightly miri --version ||
        rustup toolchain install nightly --profile minimal --component miri,rust-src ||
        skip "there is no nightly toolchain with miri"
}

# For a target for which libm has no assembly, which Miri does not know; 32 bits as on controllers.
under_miri() {
    MIRIFLAGS=-Zmiri-disable-isolation PROPTEST_CASES=2 CARGO_TARGET_DIR=$target/miri \
        cargo +nightly miri test --target armv7-unknown-linux-gnueabihf "$@"
}
