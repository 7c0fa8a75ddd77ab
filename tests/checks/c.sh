# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# The C interface: header, examples and mistakes, on this machine and on the emulated board.

readonly c_folder=firmware/c
readonly c_warnings=(-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -I "$c_folder/include")

check_c() {
    need_program gcc
    need_program clang
    need_program arm-none-eabi-gcc
    need_program qemu-system-arm
    need_target "$board"
    need_target "$small"
    run_example c_header
    cargo test -q -p estimator-c
    cargo build -q -p estimator-c --profile dist
    cargo build -q -p estimator-c --profile dist --target "$board"
    cargo build -q -p estimator-c --profile dist --target "$small"
    run_example recorded_drive "$work"
    compile_examples
    compare_cells "$work/replay" "$work/replay"
    compile_for_board
    compare_cells "$work/board.elf" emulate "$work/board.elf"
    compare_cells "$work/interrupted.elf" emulate "$work/interrupted.elf"
}

# Compiles each example as C99 and as C++, with two compilers, and runs the mistakes under the address
# and undefined-behaviour sanitizers.
compile_examples() {
    local source compiler library=$target/dist/libroad_grade.a
    for source in replay misuse; do
        for compiler in gcc clang; do
            "$compiler" -std=c99 "${c_warnings[@]}" -c "$c_folder/examples/$source.c" \
                -o "$work/$source.$compiler.o"
            "$compiler" -x c++ -std=c++11 "${c_warnings[@]}" -c "$c_folder/examples/$source.c" \
                -o "$work/$source.$compiler.cc.o"
        done
    done
    # The program of the documentation.
    awk '/^```c$/ { on = 1; next } /^```$/ { on = 0 } on' docs/c.md >"$work/docs.c"
    gcc -std=c99 "${c_warnings[@]}" -c "$work/docs.c" -o "$work/docs.o"
    gcc "$work/replay.gcc.o" "$library" -lpthread -ldl -lm -o "$work/replay"
    gcc -std=c99 -g -fsanitize=address,undefined -fno-sanitize-recover "${c_warnings[@]}" \
        "$c_folder/examples/misuse.c" "$library" -lpthread -ldl -lm -o "$work/misuse"
    "$work/misuse"
}

compile_for_board() {
    local board_folder=$c_folder/examples/board library=$target/$board/dist/libroad_grade.a
    # shellcheck disable=SC2054 # The comma belongs to the option.
    local options=(-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -O2 -std=gnu99
        "${c_warnings[@]}" -nostartfiles -Wl,--gc-sections -z noexecstack --specs=rdimon.specs -T "$board_folder/board.ld"
        "$board_folder/startup.c" "$c_folder/examples/replay.c")
    arm-none-eabi-gcc "${options[@]}" "$library" -o "$work/board.elf"
    arm-none-eabi-gcc "${options[@]}" -DINTERRUPTED "$board_folder/interrupt.c" "$library" \
        -o "$work/interrupted.elf"
}

emulate() {
    timeout 120 qemu-system-arm -machine mps2-an386 -nographic \
        -semihosting-config enable=on,target=native -kernel "$1"
}

# Runs a program in the folder of the drive, and compares its cells with those of the Rust estimator.
compare_cells() {
    local name=$1
    shift
    (cd "$work" && rm -f cells.bin && "$@" </dev/null)
    cmp "$work/cells.bin" "$work/expected.bin"
    echo "$(basename "$name"): every cell is that of the Rust estimator, bit for bit"
}
