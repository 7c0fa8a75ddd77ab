# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# The evidence in docs/evidence: requirements and tests, bounds from the linked image, coverage.

# Requirements name their tests, and tests of the core their requirements. This package needs little,
# so that it is built alone.
check_evidence() {
    cargo test -q -p evidence
    cargo run -q -p evidence -- requirements
}

# Stack and instructions of each call, recursion, indirect calls and panics, from the linked image.
check_evidence_image() {
    need_target "$board"
    cargo build -q -p firmware --profile dist --target "$board"
    cargo run -q -p evidence -- calls "$target/$board/dist/alone_calls"
}

# Lines and branches of the core that its own tests reach. Branches need the nightly toolchain.
check_long_coverage() {
    rustup component add llvm-tools --toolchain nightly ||
        not_run coverage.csv "there is no nightly toolchain with llvm-tools"
    local program status=0 folder=$target/coverage
    # From nothing: which lines a closing brace counts for differs after an incremental build.
    rm -rf "$folder"
    mkdir -p "$folder"
    covered_tests "$folder" >"$work/programs"
    while read -r program; do
        coverage_of "$program"
    done <"$work/programs" >"$folder/core.lcov"
    cargo run -q -p evidence -- coverage "$folder/core.lcov" >"$work/coverage" || status=$?
    write_result coverage.csv "the core by its own tests" <"$work/coverage"
    return "$status"
}

# Builds the tests of the core with counters in them. Prints the paths of their programs.
covered_tests() {
    RUSTFLAGS="-C instrument-coverage -Z coverage-options=branch" CARGO_TARGET_DIR=$1 \
        cargo +nightly test -p estimator-core --features fixed,serde --lib --tests --no-run \
        --message-format=json | sed -n 's/.*"executable":"\([^"]*\)".*/\1/p'
}

# Runs a test program and prints what it reached. Each one by itself: the programs have functions of
# the same name and not of the same counters, of which llvm-cov would leave out all but one.
coverage_of() {
    local program=$1 tools
    tools=$(dirname "$(rustc +nightly --print target-libdir)")/bin
    (cd estimator-core && LLVM_PROFILE_FILE=$work/one.profraw "$program" --quiet) >&2
    "$tools/llvm-profdata" merge -sparse "$work/one.profraw" -o "$work/one.profdata"
    "$tools/llvm-cov" export --format=lcov --instr-profile="$work/one.profdata" "$program"
}

# Changes the lines of the core that differ from MUTANTS_BASE: a test of the core must fail, or the
# mutant has a reason. By default that is where the branch left main, or the commit before. Of many
# mutants it takes MUTANTS_MOST at most, in turns, and says so.
check_mutants_changed() {
    local base total shards most=${MUTANTS_MOST:-20} diff=$work/core.diff out=$target/mutants-changed
    base=${MUTANTS_BASE:-}
    # A forge gives zeros where there was no commit before.
    [[ -n $base ]] && git cat-file -e "$base^{commit}" 2>/dev/null || base=$(branch_base) ||
        skip "there is no commit to compare with"
    git diff "$base" -- estimator-core/src >"$diff"
    if [[ ! -s $diff ]]; then
        echo "the core is as in $base"
        return
    fi
    has_mutants || skip "cargo-mutants could not be installed"
    total=$(cargo mutants "${mutants_of_core[@]}" --list --in-diff "$diff" | wc -l)
    shards=$(((total + most - 1) / most))
    echo "$total mutants of the lines that differ from $base"
    ((total > 0)) || return 0
    ((shards == 1)) || note "mutants_changed: $((total / shards)) of $total mutants were run (MUTANTS_MOST=$most)"
    mutate "$out" --in-diff "$diff" --shard "0/$shards" --sharding round-robin
    cargo run -q -p evidence -- mutants "$out/mutants.out/missed.txt"
}

# Prints the commit at which this branch left main; on main, the commit before.
branch_base() {
    local head base
    head=$(git rev-parse HEAD)
    base=$(git merge-base HEAD origin/main 2>/dev/null || git merge-base HEAD main 2>/dev/null || echo "$head")
    if [[ $base == "$head" ]]; then
        git rev-parse HEAD~1
    else
        echo "$base"
    fi
}

readonly mutants_of_core=(--package estimator-core --features "fixed,serde")

has_mutants() {
    has_program cargo-mutants || cargo install --locked cargo-mutants
}

# Runs mutants of the core; their outcomes are in the folder $1/mutants.out. To build all tests for each
# mutant takes ten times as long as to build one of them, so the change indicators come first. All
# tests are run for what these do not catch.
mutate() {
    local out=$1 outcome again=() roads='estimator-core/src/roadmap/**'
    shift
    rm -rf "$out"
    mkdir -p "$out/mutants.out"
    mutants_by "$out/roads" --timeout 60 --file "$roads" "$@" \
        --cargo-arg=--test=road_memory --cargo-arg=--test=packed_map
    mutants_by "$out/drives" --timeout 60 --exclude "$roads" "$@" --cargo-arg=--test=change_indicator
    cat "$out"/{roads,drives}/mutants.out/missed.txt >"$out/missed.txt"
    # Names are patterns here.
    # shellcheck disable=SC2016 # The dollar is that of sed.
    sed 's/[].[\*^$()+?{}|]/\\&/g; s/^/--re=^/; s/$/$/' "$out/missed.txt" >"$out/again"
    sed 's/:.*//; s/^/--file=/' "$out/missed.txt" | sort -u >>"$out/again"
    mapfile -t again <"$out/again"
    for outcome in caught missed timeout unviable; do
        cat "$out"/{roads,drives}/mutants.out/$outcome.txt >"$out/mutants.out/$outcome.txt"
    done
    [[ -s $out/missed.txt ]] || return 0
    # They take more than a minute where two are run at once.
    mutants_by "$out/missed" --timeout 300 "${again[@]}" --cargo-arg=--lib --cargo-arg=--tests
    : >"$out/mutants.out/missed.txt"
    # Options do not choose among fields that are left out: all of those in a file run once more.
    for outcome in caught missed timeout unviable; do
        grep -Fxf "$out/missed.txt" "$out/missed/mutants.out/$outcome.txt" >>"$out/mutants.out/$outcome.txt" || true
    done
}

# Runs the mutants and the tests that the options choose. Tests are chosen by options of cargo, for its
# build and for its run; what follows `--` is for its run alone, and all of them are built. The variable
# is unset, so that the temporary copies do not share the target folder.
mutants_by() {
    local out=$1 status=0
    shift
    env -u CARGO_TARGET_DIR cargo mutants "${mutants_of_core[@]}" "$@" --output "$out" \
        --jobs 2 --no-times --colors never || status=$?
    # 2: some mutants were not caught, 3: some took too long.
    ((status == 0 || status == 2 || status == 3))
}
