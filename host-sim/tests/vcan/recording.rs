//! Recording with the kernel's time stamps: the recording has the sent frames and gives the same
//! run.

use crate::bus::Vcan;
use crate::drive::{VcanDrive, frames_of, replay, untimed};
use crate::listener::Listener;
use host_sim::files::run;
use host_sim::source::frame_log::FrameLog;

#[test]
#[ignore = "needs a CAN interface: tests/run vcan"]
fn a_drive_in_real_time_is_recorded_and_estimated_as_from_its_file() {
    let vcan = Vcan::new("rgrec");
    let drive = VcanDrive::new("A", 600.0);
    let options = ["--out", "live.csv", "--log", "output.log"];
    let listener = Listener::start(&drive, &[vcan.0], &options);
    let sent = replay(vcan.0, &drive.log(), &["--speed", "1"]);
    listener.signal("TERM");
    let output = listener.finish();
    assert_eq!(output.lost(0), 0);

    // About once a second it printed its state.
    assert!(output.lines.len() > 5);
    let newest = output.lines.last().unwrap();
    assert_eq!(newest["interfaces"][0]["frames"], drive.frames.len());
    assert!(newest["grade_percent"]["sigma"].as_f64().unwrap() > 0.0);
    assert!(newest["distance_m"].as_f64().unwrap() > 500.0);

    // Every frame is there, in order, and the recording gives the same run.
    let recording = drive.file("output.log");
    assert_eq!(frames_of(&recording), untimed(&drive.frames));
    assert_eq!(drive.estimate(&recording), drive.read("live.csv"));

    // The run is close to that of the file. The time stamps differ by the delay of sending.
    let rows = run::read(&drive.file("live.csv")).unwrap();
    drive.estimate(&drive.log());
    let from_file = run::read(&drive.file("estimated.csv")).unwrap();
    assert!(rows.len().abs_diff(from_file.len()) <= 2);
    let off = rows.iter().zip(&from_file).map(|(live, file)| {
        (live.grade_percent - file.grade_percent).abs() / file.grade_sigma_percent
    });
    let worst = off.fold(0.0, f64::max);
    assert!(worst < 1.0, "{worst} sigma");

    let stamps = FrameLog::open_candump(&recording)
        .unwrap()
        .map(|timed| timed.unwrap().time);
    let stamps: Vec<f64> = stamps.map(|time| time.micros() as f64 * 1e-3).collect();
    let log: Vec<f64> = drive
        .frames
        .iter()
        .map(|f| f.time.micros() as f64 * 1e-3)
        .collect();
    let mut late: Vec<f64> = stamps
        .iter()
        .zip(&log)
        .map(|(stamp, log)| (stamp - stamps[0]) - (log - log_start(&drive)))
        .collect();
    late.sort_by(f64::total_cmp);
    println!(
        "stamps off the log's by {:.3} ms in the middle, {:.3} to {:.3} ms at most; sent {:.2} ms \
         late at most; cells off by {worst:.3} sigma at most",
        late[late.len() / 2],
        late[0],
        late[late.len() - 1],
        sent["latest_ms"].as_f64().unwrap(),
    );
}

fn log_start(drive: &VcanDrive) -> f64 {
    drive.frames[0].time.micros() as f64 * 1e-3
}
