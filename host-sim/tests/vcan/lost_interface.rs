//! Interfaces that are missing, vanish, and return.

use crate::bus::{Vcan, ip};
use crate::drive::{VcanDrive, replay, write_log};
use crate::listener::{Listener, ListenerOutput, until_silent};
use crate::roadgrade;
use host_sim::files::run;
use predicates::str::contains;

/// Listens to a drive. `lose` takes the interface away in the middle and `find` brings it back.
fn interrupted(
    name: &'static str,
    words: &str,
    lose: fn(&Vcan),
    find: fn(&Vcan),
) -> (VcanDrive, ListenerOutput) {
    let vcan = Vcan::new(name);
    let drive = VcanDrive::new("A", 400.0);
    let (first, second) = drive.frames.split_at(drive.frames.len() / 2);
    write_log(&drive.file("first.log"), first);
    write_log(&drive.file("second.log"), second);
    let mut listener = Listener::start(&drive, &[vcan.0], &["--out", "live.csv"]);
    let speed = ["--speed", "2"];
    replay(vcan.0, &drive.file("first.log"), &speed);
    lose(&vcan);
    listener.wait_for(words);
    find(&vcan);
    listener.wait_for("interface back");
    replay(vcan.0, &drive.file("second.log"), &speed);
    listener.signal("INT");
    let output = listener.finish();
    assert_eq!(output.frames(0), drive.frames.len() as u64);
    assert_eq!(output.lost(0), 0);
    assert_eq!(output.event(0, "interface_back"), 1);
    let rows = run::read(&drive.file("live.csv")).unwrap();
    let last_s = rows.last().unwrap().time_s;
    assert!(rows.iter().filter(|row| row.time_s < 0.5 * last_s).count() > 10);
    assert!(rows.iter().filter(|row| row.time_s > 0.5 * last_s).count() > 10);
    (drive, output)
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn an_interface_that_vanishes_is_found_again() {
    let (_, output) = interrupted("rggone", "interface gone", Vcan::remove, Vcan::add);
    assert_eq!(output.event(0, "interface_gone"), 1);
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn an_interface_that_is_set_down_is_found_again() {
    let (_, output) = interrupted("rgdown", "interface down", Vcan::down, Vcan::up);
    assert_eq!(output.event(0, "interface_down"), 1);
    let reported = output
        .said
        .iter()
        .filter(|said| said.contains("interface down"))
        .count();
    assert_eq!(reported, 1);
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn an_interface_that_is_down_or_missing_at_the_start_is_an_error() {
    let vcan = Vcan::new("rgoff");
    vcan.down();
    let drive = VcanDrive::new("A", 300.0);
    let listen = |interface: &str| {
        roadgrade()
            .args(["listen", "--can", interface, "--vehicle"])
            .arg(drive.vehicle())
            .assert()
    };
    let replay = |interface: &str| {
        roadgrade()
            .args(["replay", "--can", interface])
            .arg(drive.log())
            .assert()
    };
    for assert in [listen("rgoff"), replay("rgoff")] {
        assert.code(1).stderr(contains("ip link set rgoff up"));
    }
    for assert in [listen("rgnone"), replay("rgnone")] {
        assert
            .code(1)
            .stderr(contains("ip link add dev rgnone type vcan"));
    }
    ip(&["link", "set", "lo", "up"]);
    for assert in [listen("lo"), replay("lo")] {
        assert
            .code(1)
            .stderr(contains("no CAN interface of this name"));
    }
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn a_bus_without_traffic_gives_no_run_and_a_reason() {
    let vcan = Vcan::new("rgmute");
    let drive = VcanDrive::new("A", 300.0);
    until_silent(&drive, vcan.0, "0.5")
        .assert()
        .code(1)
        .stderr(contains("rgmute: no speed"));
    assert!(!drive.file("live.csv").exists());
}

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn a_replay_with_log_time_needs_a_listener() {
    let vcan = Vcan::new("rgalone");
    let drive = VcanDrive::new("A", 300.0);
    roadgrade()
        .args(["replay", "--log-time", "--can", vcan.0])
        .arg(drive.log())
        .assert()
        .code(1)
        .stderr(contains("roadgrade listen --can rgalone --log-time"));
}
