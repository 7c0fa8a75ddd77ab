# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# Tests with can-utils on virtual CAN interfaces: on this kernel if it has them and permits it,
# otherwise in a virtual machine.

check_vcan() {
    local log=$work/vcan status=0
    on_virtual_bus "$log" || status=$?
    totals "$log"
    ((status == 0)) || return "$status"
    # Decodes the published estimate with a public library and the layout file.
    want_python_package cantools "decoding with cantools" || return 0
    "$python" tests/vcan/decode.py estimator-core/dbc/grade.dbc <"$log"
}

# Runs the tests on virtual interfaces, or those whose names are given, and writes their output to a
# log. The environment must have the variables that they need; $PASSED names them.
on_virtual_bus() {
    local log=$1 program status=0
    shift
    for program in ip candump canplayer cangen; do
        need_program "$program"
    done
    # All packages: this one alone would be rebuilt with other features.
    program=$(cargo test "${host_packages[@]}" --test vcan --no-run --message-format=json |
        sed -n 's/.*"executable":"\([^"]*\/vcan-[^"]*\)".*/\1/p')
    local tests=("$program" "$@" --ignored --test-threads=1 --show-output)
    if has_vcan; then
        as_root unshare --net "${tests[@]}" 2>&1 | tee "$log" || status=$?
    else
        echo "this kernel has no vcan, or it is not allowed: in a virtual machine"
        in_machine "${tests[@]}" 2>&1 | tee "$log" || status=$?
        ((status != skipped_status)) || skip "there is no kernel for the virtual machine"
    fi
    return "$status"
}

# Succeeds if virtual CAN interfaces can be added here, in a network namespace of their own.
has_vcan() {
    {
        as_root modprobe vcan
        as_root unshare --net ip link add dev vcan0 type vcan
    } >/dev/null 2>&1
}

in_machine() {
    need_program qemu-system-x86_64
    need_program busybox
    need_program apt-get
    CARRIED="ip candump canplayer cangen $target/debug/roadgrade" \
        tests/vcan/machine "$target/vcan" "$@"
}
