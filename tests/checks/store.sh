# shellcheck shell=bash disable=SC2154 # Variables of tests/run.
# Object storage: the same commands on files and on a server of S3 that runs here.

check_store() {
    local roadgrade=$target/debug/roadgrade
    need_program python3
    build_roadgrade
    want_python_package 'moto[server]' "object storage" || skip "there is no server of S3"
    simulated_drives "$work/drives" 3000 a b
    PYTHONDONTWRITEBYTECODE=1 "$python" tests/store/check_store.py "$roadgrade" "$work/drives"
}
