//! candump logs, plain or gzip: frames in the order of time, or an error that names file and line.

#![no_main]

use fuzz_targets::as_file;
use host_sim::source::frame_log::FrameLog;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    as_file(".log", bytes, |path| {
        let mut log = FrameLog::open_candump(path).expect("there is such a file");
        let mut newest = None;
        loop {
            match log.next_frame() {
                Ok(Some(timed)) => {
                    assert!(newest.is_none_or(|newest| newest <= timed.time));
                    newest = Some(timed.time);
                }
                Ok(None) => {
                    assert!(newest.is_some(), "a log without a frame is an error");
                    return;
                }
                Err(error) => {
                    assert!(error.to_string().contains(&path.display().to_string()));
                    return;
                }
            }
        }
    });
});
