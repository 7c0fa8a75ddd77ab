//! Accelerometers and motors on the bus: which message counts.

use estimator_core::sample::{InertialMeasurement, Sample};
use estimator_core::signal::encode;
use estimator_core::{Counters, Estimator, Instant, Signal, Tuning, Value};
use test_kit::{TestFrame, truck, truck_with};

const VDC2: u32 = 61_449;
const ACCS: u32 = 61_485;
const MG1IS1: u32 = 64_372;
const MG1IR1: u32 = 64_373;
const CCVS1: u32 = 65_265;

/// A message with its source address and the value of all its signals.
type Message = (u32, u8, f32);

struct Drive {
    estimator: Estimator<f32>,
    now_ms: u64,
}

impl Drive {
    fn of(estimator: Estimator<f32>) -> Self {
        Self {
            estimator,
            now_ms: 1_000,
        }
    }

    fn truck() -> Self {
        Self::of(Estimator::new(truck(), Tuning::default()).unwrap())
    }

    /// Drives at 20 m/s with these messages every 20 ms. Returns the last sample.
    fn on(&mut self, seconds: u64, messages: &[Message]) -> Sample {
        let mut last = None;
        for step in 0..50 * seconds {
            for (pgn, source, value) in messages {
                self.send(*pgn, *source, |_| Value::Real(*value));
            }
            if step % 5 == 0 {
                self.send(CCVS1, 0, |signal| match signal {
                    Signal::WheelSpeed => Value::Real(20.0),
                    _ => Value::NotAvailable,
                });
            }
            while self.estimator.step().is_some() {
                last = self.estimator.sample().copied();
            }
            while self.estimator.next_cell().is_some() {}
            self.now_ms += 20;
        }
        last.unwrap()
    }

    fn send(&mut self, pgn: u32, source: u8, value_of: impl Fn(Signal) -> Value) {
        let mut payload = [0; 8];
        encode(pgn, &mut payload, value_of).unwrap();
        self.frame(&TestFrame::of_pgn(pgn, source, &payload));
    }

    fn frame(&mut self, frame: &TestFrame) {
        let now = Instant::from_micros(1_000 * self.now_ms);
        self.estimator.on_frame(now, frame);
    }

    fn counters(&self) -> &Counters {
        self.estimator.counters()
    }
}

fn mps2(sample: &Sample) -> f32 {
    sample.inertial.unwrap().acceleration_mps2
}

#[test]
fn the_finer_message_counts_in_any_order_and_from_any_address() {
    for (fine_source, coarse_source) in [(11, 11), (0x3e, 11), (11, 0x3e)] {
        let (fine, coarse) = ((ACCS, fine_source, 2.0), (VDC2, coarse_source, 1.0));
        for both in [[fine, coarse], [coarse, fine]] {
            let mut drive = Drive::truck();
            let sample = drive.on(5, &both);
            assert!((mps2(&sample) - 2.0).abs() < 1e-4, "{both:?}");
            // It stands in when the finer one falls silent.
            let sample = drive.on(10, &[coarse]);
            assert!((mps2(&sample) - 1.0).abs() < 1e-4, "{both:?}");
            let sample = drive.on(10, &both);
            assert!((mps2(&sample) - 2.0).abs() < 1e-4, "{both:?}");
        }
    }
}

#[test]
fn the_resolution_is_that_of_the_message_that_counts() {
    let mut drive = Drive::truck();
    let wave = |drive: &mut Drive, pgn, step: f32| -> InertialMeasurement {
        let mut last = None;
        for k in 0..200 {
            let value = if k % 2 == 0 { 1.0 } else { 1.0 + step };
            last = drive.on(1, &[(pgn, 11, value)]).inertial;
        }
        last.unwrap()
    };
    let fine = wave(&mut drive, ACCS, 0.01);
    assert!((fine.resolution_mps2 - 0.01).abs() < 1e-3);
    let coarse = wave(&mut drive, VDC2, 0.1);
    assert!((coarse.resolution_mps2 - 0.1).abs() < 1e-3);
}

#[test]
fn a_degraded_sensor_is_none_and_its_readings_are_counted_as_errors() {
    let mut drive = Drive::truck();
    drive.on(5, &[(ACCS, 11, 1.0)]);
    assert_eq!(drive.counters().errors, 0);
    for _ in 0..100 {
        // 1.25 m/s², degraded.
        let data = [0xff, 0xff, 0x7d, 0x7d, 0xff, 0xff, 0xf7, 0xff];
        drive.frame(&TestFrame::of_pgn(ACCS, 11, &data));
        drive.now_ms += 10;
    }
    assert_eq!(drive.counters().errors, 100);
    assert!(drive.on(5, &[]).inertial.is_none());
}

#[test]
fn stability_control_without_an_acceleration_costs_no_count() {
    let mut drive = Drive::truck();
    drive.on(1, &[]);
    let before = drive.counters().not_available;
    drive.send(VDC2, 11, |signal| match signal {
        Signal::YawRate => Value::Real(0.0),
        _ => Value::NotAvailable,
    });
    assert_eq!(drive.counters().not_available, before);
}

#[test]
fn a_motor_on_the_bus_drives_through_a_single_reduction() {
    // The file has another reference torque than the inverter.
    let vehicle = truck_with(250.0, &[3.2]);
    let mut drive = Drive::of(Estimator::new(vehicle, Tuning::default()).unwrap());
    for (percent, reference_nm) in [(40.0, 600.0), (-20.0, 600.0)] {
        let sample = drive.on(10, &[(MG1IR1, 0xef, reference_nm), (MG1IS1, 0xef, percent)]);
        let per_nm = 3.2 * 2.92 * 0.985 * 0.98 / 0.5;
        let expected_n = 0.01 * percent * reference_nm * per_nm;
        let off_n = sample.forces.traction_n - expected_n;
        assert!(off_n.abs() < 0.1, "{off_n} N of {expected_n} N");
        assert!(sample.end.condition.is_valid());
    }
}
