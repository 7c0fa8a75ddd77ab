# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# The program for Windows under Wine: the same bytes as on this system.

readonly windows=x86_64-pc-windows-gnu

check_windows() {
    need_program x86_64-w64-mingw32-gcc
    need_program wine
    need_program python3
    rustup target add "$windows" || need_target "$windows"
    want_python_package python-can "logs of other programs on Windows" || return 0
    want_python_package asammdf "logs of other programs on Windows" || return 0
    cargo build --release -p host-sim --bin roadgrade --features full
    cargo build --release -p host-sim --bin roadgrade --features full --target "$windows"
    mkdir -p "$work/windows"
    cp "$target/$windows/release/roadgrade.exe" "$work/windows/"
    x86_64-w64-mingw32-gcc -shared -o "$work/windows/bcryptprimitives.dll" tests/windows/bcryptprimitives.c -ladvapi32
    WINEPREFIX=$work/wine WINEDEBUG=-all "$python" tests/windows/check_windows.py \
        "$target/release/roadgrade" "$work/windows/roadgrade.exe" tests/logs/write_logs.py "$work/drives"
}
