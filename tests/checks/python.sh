# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# The Python package: its wheel in a new environment, against the binary; types, documentation, notebook.

readonly python_crate=host-sim/python
# What the tests and the notebook need beside the wheel.
readonly python_peers=(pyarrow geopandas polars matplotlib mypy)

check_python() {
    need_program python3
    local package wheels=$work/wheels fresh=$work/fresh peers
    for package in maturin "${python_peers[@]}"; do
        want_python_package "$package" "the Python package" || return 0
    done
    # All packages: the wheel then has most of what it needs.
    cargo build "${host_packages[@]}" --bins
    "$target/python/bin/maturin" build --profile dev --features as-tested --target-dir "$target" \
        --manifest-path "$python_crate/Cargo.toml" --auditwheel skip --out "$wheels"
    python3 -m venv "$fresh"
    "$fresh/bin/python" -m pip install -q --disable-pip-version-check --no-index "$wheels"/*.whl
    # The wheel itself needs nothing. The other libraries are those of the checks.
    peers=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
    echo "$peers" >"$("$fresh/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/peers.pth"
    ROADGRADE=$target/debug/roadgrade PYTHONDONTWRITEBYTECODE=1 \
        "$fresh/bin/python" -m unittest discover --buffer \
            --start-directory "$python_crate/tests"
    "$fresh/bin/python" -m mypy.stubtest roadgrade
}
