# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# Programs, Rust targets and Python packages that the checks need, and their installation.

# Programs and their Debian packages.
declare -rA package_of=(
    [qemu-system-arm]=qemu-system-arm
    [qemu-system-x86_64]=qemu-system-x86 [busybox]=busybox-static
    [ip]=iproute2 [candump]=can-utils
    [gcc]=gcc [clang]=clang
    [arm-none-eabi-gcc]='gcc-arm-none-eabi libnewlib-arm-none-eabi'
)
# Those that checks outside CI need, which install them when they begin.
declare -rA package_apart_of=([java]=default-jre-headless [chromium]=chromium
    [x86_64-w64-mingw32-gcc]=gcc-mingw-w64-x86-64 [wine]='wine wine64')
readonly board=thumbv7em-none-eabihf # Cortex-M4F
readonly small=thumbv6m-none-eabi    # Cortex-M0: no float unit, no compare-and-swap
readonly python_packages=(cantools)
readonly python=$target/python/bin/python

check_setup() {
    local missing=() program package
    has_toolchain || install_toolchain || true
    has_toolchain || missing+=("the toolchain of rust-toolchain.toml")
    touch "$scratch/toolchain_is_there"
    install_programs || true
    for program in "${!package_of[@]}"; do
        has_program "$program" || missing+=("$program")
    done
    for package in "${python_packages[@]}"; do
        has_python_package "$package" || missing+=("$package")
    done
    if ((${#missing[@]})); then
        skip "could not install $(join_by ', ' "${missing[@]}")"
    fi
    cargo --version
    qemu-system-arm --version | head -n 1
}

# --- waiting for the setup that runs beside ------------------------------------------------------

await_toolchain() {
    until [[ -e $scratch/toolchain_is_there || ! -e $scratch/installing ]]; do
        sleep 0.2
    done
}

await_setup() {
    while [[ -e $scratch/installing ]]; do
        sleep 0.5
    done
}

# --- programs ------------------------------------------------------------------------------------

# What is used counts: a compiler for boards without its C library compiles nothing.
has_program() {
    command -v "$1" >/dev/null || return 1
    [[ $1 != arm-none-eabi-gcc || -f $("$1" -print-file-name=rdimon.specs) ]]
}

need_program() {
    has_program "$1" || await_setup
    # shellcheck disable=SC2086 # A program may need several packages.
    has_program "$1" || [[ ! -v package_apart_of[$1] ]] || install_packages ${package_apart_of[$1]} || true
    has_program "$1" || skip "$1 is not installed, or lacks a part"
}

# Installs the packages of Debian and of Python at the same time.
install_programs() {
    local program packages=()
    for program in "${!package_of[@]}"; do
        # shellcheck disable=SC2206 # A program may need several packages.
        has_program "$program" || packages+=(${package_of[$program]})
    done
    install_python_packages "${python_packages[@]}" &
    ((${#packages[@]} == 0)) || install_packages "${packages[@]}" || true
    wait $! || true
}

install_packages() {
    if ! has_program apt-get; then
        echo "$*: there is no apt-get to install them with"
        return 1
    fi
    # Nothing that is there is removed. One package that cannot be installed so costs itself.
    local package status=0 install=(env DEBIAN_FRONTEND=noninteractive
        apt-get install -y -q --no-remove --no-install-recommends)
    as_root "${install[@]}" "$@" && return
    as_root apt-get update -q
    as_root "${install[@]}" "$@" && return
    for package in "$@"; do
        as_root "${install[@]}" "$package" && continue
        status=1
        echo "$package: not installed; apt-get install $package says what it would remove, or what is missing"
    done
    return "$status"
}

as_root() {
    if ((EUID == 0)); then
        "$@"
    elif has_program sudo && sudo -n true 2>/dev/null; then
        sudo -n "$@"
    else
        echo "not allowed to run: $*"
        return 1
    fi
}

# --- packages of PyPI, in an environment of their own ---------------------------------------------

has_python_package() {
    # Without what is wanted of it: package[part].
    "$python" -c "import ${1%%[*}" 2>/dev/null
}

install_python_packages() {
    [[ -x $python ]] || python3 -m venv "$target/python" || return 1
    local package missing=()
    for package in "$@"; do
        has_python_package "$package" || missing+=("$package")
    done
    ((${#missing[@]} == 0)) || "$python" -m pip install -q --disable-pip-version-check "${missing[@]}"
}

# Succeeds if a package is installed or can be. Otherwise notes that $2 was skipped.
want_python_package() {
    await_setup
    install_python_packages "$1" && return
    note "SKIPPED $2: could not install $1"
    return 1
}

# --- Rust ----------------------------------------------------------------------------------------

has_target() {
    local libraries
    libraries=$(rustc --print target-libdir --target "$1") && [[ -d $libraries ]]
}

need_target() {
    has_target "$1" || skip "the Rust target $1 is not installed"
}

has_toolchain() {
    local triple
    for triple in "$board" "$small"; do
        has_target "$triple" || return 1
    done
    cargo fmt --version >/dev/null && cargo clippy --version >/dev/null
}

# rustup reads rust-toolchain.toml. Versions before 1.28 install it on `rustup show`.
install_toolchain() {
    if ! has_program rustup; then
        echo "the toolchain: there is no rustup to install it with (https://rustup.rs)"
        return 1
    fi
    rustup toolchain install || rustup show
}

# --- saying what was not done ----------------------------------------------------------------------

# Ends a check that cannot run here, with the reason.
skip() {
    echo "$1" >"$work/reason"
    exit "$skipped_status"
}

# Prints a line now, and again at the end.
note() {
    echo "$1" | tee -a "$work/notes"
}

join_by() {
    local separator=$1 joined=$2
    shift 2
    printf '%s' "$joined" "${@/#/$separator}"
}

# Builds the program, and `fleet`, which simulates runs for some checks. With an example among them,
# dependencies have the features that tests need: otherwise, all would be built a second time.
build_roadgrade() {
    cargo build "${host_packages[@]}" --bins --example fleet
}

# Simulates drives of one truck over a road of this length, m.
simulated_drives() {
    local folder=$1 length_m=$2 name
    shift 2
    mkdir -p "$folder"
    {
        printf '[road]\nlength_m = %s.0\n' "$length_m"
        for name in "$@"; do
            printf '[[runs]]\nname = "%s"\ntruck = "A"\n' "$name"
        done
    } >"$folder/scenario.toml"
    "$roadgrade" --quiet simulate --scenario "$folder/scenario.toml" --out "$folder"
}
