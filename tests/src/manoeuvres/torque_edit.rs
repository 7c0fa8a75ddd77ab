//! Changes of the indicated torque, which two signals of EEC1 share.

use crate::faults::frames::pgn;
use crate::faults::{Frames, Window, changed};
use embedded_can::Frame;
use host_sim::source::can_frame::{CanFrame, TimedFrame};

/// EEC1, with the torque in two signals.
const EEC1: u32 = 61_444;

/// Changes the indicated torque, %, at a time in the window, s; `None` is not available.
pub fn torque<'a>(
    frames: Frames<'a>,
    window: Window,
    mut of: impl FnMut(f64, f64) -> Option<f64> + 'a,
) -> Frames<'a> {
    let start = window.start;
    changed(frames, window, move |timed| {
        let seconds = timed.time.since(start).micros() as f64 * 1e-6;
        let frame = with_torque(&timed.frame, |percent| of(seconds, percent));
        Some(TimedFrame { frame, ..timed })
    })
}

/// Returns the frame with another torque, if it is EEC1 and has one. SPN 513 is byte 3, in percent
/// from −125 on; SPN 4154 is the upper half of byte 1, in eighths of a percent.
fn with_torque(frame: &CanFrame, of: impl FnOnce(f64) -> Option<f64>) -> CanFrame {
    let mut data = frame.data().to_vec();
    if pgn(frame) != Some(EEC1) || data.len() < 8 || data[2] > 250 {
        return *frame;
    }
    let eighths = Some(data[0] >> 4).filter(|&n| n < 8).unwrap_or(0);
    let percent = f64::from(data[2]) - 125.0 + 0.125 * f64::from(eighths);
    let (whole, eighths) = match of(percent) {
        Some(percent) => {
            let eighths = (8.0 * percent).round().clamp(0.0, 1_000.0) as u16;
            ((eighths / 8) as u8 + 125, (eighths % 8) as u8)
        }
        None => (0xff, 0x0f),
    };
    data[2] = whole;
    data[0] = data[0] & 0x0f | eighths << 4;
    CanFrame::new(frame.id(), &data).unwrap_or(*frame)
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::{Decoder, Signal, Value};

    fn eec1(whole: u8, eighths: u8) -> CanFrame {
        let id = 3 << 26 | EEC1 << 8;
        CanFrame::extended(
            id,
            &[eighths << 4 | 2, 0xff, whole + 125, 0, 40, 0xff, 0xff, 0xff],
        )
        .unwrap()
    }

    fn read(frame: &CanFrame) -> (Value, Value) {
        let (mut torque, mut fraction) = (Value::NotAvailable, Value::NotAvailable);
        Decoder::new().decode(frame, |_, _, reading| match reading.signal {
            Signal::EngineTorque => torque = reading.value,
            Signal::EngineTorqueFraction => fraction = reading.value,
            _ => {}
        });
        (torque, fraction)
    }

    #[test]
    fn torque_is_rewritten_in_both_of_its_signals() {
        let changed = with_torque(&eec1(49, 7), |percent| {
            assert_eq!(percent, 49.875);
            Some(percent + 0.5)
        });
        assert_eq!(read(&changed), (Value::Real(50.0), Value::Real(0.375)));
        let none = with_torque(&eec1(49, 7), |_| None);
        assert_eq!(read(&none), (Value::NotAvailable, Value::NotAvailable));
    }
}
