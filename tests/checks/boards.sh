# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# The code for boards: clippy, the core alone, the images, and their cost.

check_clippy_boards() {
    need_target "$board"
    cargo clippy -p estimator-core --target "$board" -- -D warnings
    cargo clippy -p estimator-core --target "$board" --features defmt,fixed,serde -- -D warnings
    cargo clippy -p firmware --target "$board" -- -D warnings
    cargo clippy --manifest-path tests/peers/Cargo.toml --target "$board" \
        --target-dir "$target" -- -D warnings
}

# Benches are not run here; they have to compile.
check_benches() {
    cargo clippy --manifest-path tests/benches/Cargo.toml --all-targets \
        --target-dir "$target" -- -D warnings
}

# `clippy_boards` checks the same for the board.
check_no_std() {
    need_target "$small"
    cargo check -p estimator-core --target "$small"
    cargo check -p estimator-core --features fixed --target "$small"
}

check_firmware() {
    need_target "$board"
    need_program qemu-system-arm
    cargo build -p firmware --profile dist --target "$board"
    print_size "$target/$board/dist/mps2_an386"
    local names name others=()
    mapfile -t names < <(test_names)
    for name in "${names[@]}"; do
        [[ $name == firmware ]] || others+=("$name")
    done
    run_tests "${others[@]}"
    # The real board: linked, not run.
    local features
    for features in "" gnss-serial; do
        (cd firmware/stm32g4 &&
            cargo build --release --features "$features" --target-dir "$target")
    done
    print_size "$target/$board/release/stm32g4"
}

print_size() {
    if has_program size && [[ -f $1 ]]; then
        size "$1"
    fi
}

# Counts of instructions and bytes against firmware/budgets.csv.
check_budgets() {
    need_target "$board"
    need_target "$small"
    need_program qemu-system-arm
    # The profile of the tests. The example itself builds the measured images with the profile `dist`.
    run_example budgets --check
}
