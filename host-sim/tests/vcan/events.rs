//! Error frames of the CAN controller, sent as a driver sends them.

use crate::bus::Vcan;
use crate::drive::{VcanDrive, replay};
use crate::listener::Listener;
use socketcan::{CanErrorFrame, CanFrame, CanSocket, Socket};

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn error_frames_of_the_controller_are_reported_and_counted() {
    let vcan = Vcan::new("rgerr");
    let drive = VcanDrive::new("A", 300.0);
    let mut listener = Listener::start(&drive, &[vcan.0], &[]);
    let socket = CanSocket::open(vcan.0).unwrap();
    let report = |class: u32, data: &[u8]| {
        let frame = CanFrame::Error(CanErrorFrame::new_error(class, data).unwrap());
        socket.write_frame(&frame).unwrap();
    };
    // Classes and codes of linux/can/error.h.
    report(0x004 | 0x200, &[0, 0x08, 0, 0, 0, 0, 96, 0]);
    listener.wait_for("error warning");
    report(0x004 | 0x200, &[0, 0x20, 0, 0, 0, 0, 128, 0]);
    listener.wait_for("error passive");
    for _ in 0..1_000 {
        report(0x008 | 0x080, &[0, 0, 0x04, 0]);
    }
    report(0x040, &[]);
    listener.wait_for("bus off");
    report(0x100, &[]);
    listener.wait_for("restarted");
    replay(vcan.0, &drive.log(), &["--speed", "20"]);
    listener.signal("INT");
    let output = listener.finish();
    for (event, count) in [
        ("error_warning", 1),
        ("error_passive", 1),
        ("wire_error", 1_000),
        ("bus_off", 1),
        ("restarted", 1),
    ] {
        assert_eq!(output.event(0, event), count, "{event}");
    }
    // Error frames do not count as frames, and the estimate goes on.
    assert_eq!(output.frames(0), drive.frames.len() as u64);
    assert!(!output.said.iter().any(|said| said.contains("wire")));
}
