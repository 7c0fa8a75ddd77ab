# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# The packages that others build: complete, and without anything beside them.

readonly published=(estimator-core host-sim)

check_packages() {
    cargo publish --workspace --dry-run --no-verify --allow-dirty
}

# Compares the public interface with that of the last release: the version says whether a user's code may
# have to change. SEMVER_BASE is a commit to compare with instead.
check_semver() {
    local base=${SEMVER_BASE:-} package
    [[ -n $base ]] || base=$(git describe --tags --match 'v[0-9]*' --abbrev=0 2>/dev/null) ||
        skip "there is no release to compare with (no tag v…), and SEMVER_BASE is not set"
    has_program cargo-semver-checks || cargo install --locked cargo-semver-checks ||
        skip "cargo-semver-checks could not be installed"
    for package in "${published[@]}"; do
        cargo semver-checks -p "$package" --baseline-rev "$base"
    done
}

# Installs the tool from the unpacked packages alone. It builds all dependencies anew.
check_long_packages() {
    local name version folder=$work/unpacked patches=()
    cargo package "${published[@]/#/-p}" --no-verify --allow-dirty --target-dir "$target"
    version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
    mkdir -p "$folder"
    for name in "${published[@]}"; do
        tar -xf "$target/package/$name-$version.crate" -C "$folder"
        patches+=(--config "patch.crates-io.$name.path='$folder/$name-$version'")
    done
    cargo install --path "$folder/host-sim-$version" --root "$work/installed" "${patches[@]}" \
        --target-dir "$target/unpacked" --debug
    "$work/installed/bin/roadgrade" demo --out "$work/demo"
}

# Builds what users install, runs the tool from the Debian package where nothing else is, and imports the
# wheel in a new environment.
check_long_release() {
    local bare=$work/bare
    need_program dpkg-deb
    need_program clang
    packaging/release x86_64-unknown-linux-musl
    dpkg-deb --extract "$target"/packages/roadgrade_*_amd64.deb "$bare"
    mkdir "$bare/tmp"
    as_root chroot "$bare" /usr/bin/roadgrade demo --out /demo
    packaging/wheel
    python3 -m venv "$work/fresh"
    "$work/fresh/bin/python" -m pip install -q --disable-pip-version-check --no-index "$target"/packages/*.whl
    "$work/fresh/bin/python" -c 'import roadgrade; print(roadgrade.__version__)'
    (cd "$target/packages" && sha256sum --check SHA256SUMS)
}
