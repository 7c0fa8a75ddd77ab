//! Messages that stand in for others, or go before them: TCO1, GCVW, AMB2, VP2, EBC5.

use estimator_core::signal::encode;
use estimator_core::{Estimator, Instant, Sample, Signal, Tuning, Value};
use test_kit::{frames_of, truck};

const EEC1: u32 = 61_444;
const ETC2: u32 = 61_445;
const VP2: u32 = 64_502;
const GCVW: u32 = 64_872;
const EBC5: u32 = 64_964;
const AMB2: u32 = 64_992;
const TCO1: u32 = 65_132;
const CVW: u32 = 65_136;
const EBC2: u32 = 65_215;
const VDS: u32 = 65_256;
const CCVS1: u32 = 65_265;
const AMB: u32 = 65_269;

/// Drives for some seconds with these speeds, and with other messages once a second.
struct Drive {
    estimator: Estimator<f32>,
    now_us: u64,
}

/// A message with its source and the value of all its signals.
type Message = (u32, u8, f32);

impl Drive {
    fn new() -> Self {
        Self {
            estimator: Estimator::new(truck(), Tuning::default()).unwrap(),
            now_us: 1_000_000,
        }
    }

    fn message(
        &mut self,
        pgn: u32,
        source: u8,
        value_of: impl Fn(Signal) -> Value,
    ) -> Option<Sample> {
        let mut payload = [0; 64];
        let length = encode(pgn, &mut payload, value_of).unwrap();
        let now = Instant::from_micros(self.now_us);
        let mut sample = None;
        for frame in frames_of(pgn, source, 0, &payload[..length]) {
            self.estimator.on_frame(now, &frame);
            while self.estimator.step().is_some() {
                sample = self.estimator.sample().copied();
            }
            while self.estimator.next_cell().is_some() {}
        }
        sample
    }

    fn on(&mut self, seconds: usize, speeds: &[Message], others: &[Message]) -> Vec<Sample> {
        let mut samples = Vec::new();
        for tenth in 0..10 * seconds {
            for pgn in [EEC1, ETC2] {
                samples.extend(self.message(pgn, 0, |signal| match signal {
                    Signal::EngineTorque => Value::Real(40.0),
                    Signal::EngineSpeed => Value::Real(55.77 * 20.0),
                    Signal::CurrentGear => Value::Real(11.0),
                    _ => Value::NotAvailable,
                }));
            }
            if tenth % 10 == 0 {
                for (pgn, source, value) in others {
                    samples.extend(self.message(*pgn, *source, |_| Value::Real(*value)));
                }
            }
            for (pgn, source, mps) in speeds {
                samples.extend(self.message(*pgn, *source, |signal| match signal {
                    Signal::WheelSpeed | Signal::FrontAxleSpeed | Signal::TachographSpeed => {
                        Value::Real(mps + 0.004 * (tenth % 5) as f32)
                    }
                    _ => Value::NotAvailable,
                }));
            }
            self.now_us += 100_000;
        }
        samples
    }

    fn mps(&self) -> f32 {
        self.estimator.live().unwrap().estimate.speed_mps
    }
}

#[test]
fn the_tachograph_is_the_speed_of_last_resort() {
    let (wheels, axle, tachograph) = ((CCVS1, 0, 20.0), (EBC2, 11, 21.0), (TCO1, 0xee, 22.0));
    for (speeds, expected_mps) in [
        (vec![tachograph], 22.0),
        (vec![tachograph, axle], 21.0),
        (vec![tachograph, wheels], 20.0),
        (vec![tachograph, axle, wheels], 20.0),
    ] {
        let mut drive = Drive::new();
        let samples = drive.on(30, &speeds, &[]);
        assert!(samples.len() > 200, "{speeds:?}");
        assert!((drive.mps() - expected_mps).abs() < 0.1, "{speeds:?}");
        // It stands in when the others fall silent.
        drive.on(30, &[tachograph], &[]);
        assert!((drive.mps() - 22.0).abs() < 0.1, "{speeds:?}");
    }
}

#[test]
fn the_gross_combination_weight_is_a_mass() {
    let mut drive = Drive::new();
    let wheels = [(CCVS1, 0, 20.0)];
    let samples = drive.on(30, &wheels, &[(GCVW, 0, 31_234.0)]);
    let last = samples.last().unwrap();
    assert_eq!(last.forces.mass_kg, 31_234.0);
    assert!(last.mass_is_reported);
    // As of CVW: a load that changes on the move is noise of the weighing.
    let samples = drive.on(10, &wheels, &[(CVW, 0, 25_000.0)]);
    assert_eq!(samples.last().unwrap().forces.mass_kg, 31_234.0);
}

#[test]
fn the_pressure_with_finer_steps_goes_before() {
    let density = |pressures: &[Message]| {
        let mut drive = Drive::new();
        for _ in 0..20 {
            for (pgn, source, pascal) in pressures {
                drive.message(*pgn, *source, |signal| match signal {
                    Signal::AirPressure => Value::Real(*pascal),
                    _ => Value::Real(15.0),
                });
            }
            drive.on(1, &[(CCVS1, 0, 20.0)], &[]);
        }
        drive.estimator.sample().unwrap().forces.air_density
    };
    let coarse = density(&[(AMB, 0, 98_500.0)]);
    let fine = density(&[(AMB, 0, 98_500.0), (AMB2, 0, 98_700.0)]);
    assert!((fine / coarse - 98_700.0 / 98_500.0).abs() < 1e-5);
    // Whichever comes first.
    assert_eq!(density(&[(AMB2, 0, 98_700.0), (AMB, 0, 98_500.0)]), fine);
}

#[test]
fn few_satellites_by_j1939_make_a_fix_poor() {
    for (satellites, poor) in [(3.0, true), (9.0, false)] {
        let mut drive = Drive::new();
        drive.on(
            30,
            &[(CCVS1, 0, 20.0)],
            &[(VP2, 0x1c, satellites), (VDS, 0x1c, 100.0)],
        );
        let counters = drive.estimator.counters();
        assert_eq!(counters.poor_fixes > 0, poor);
        assert_eq!(counters.altitudes_used == 0, poor);
    }
}

#[test]
fn foundation_brakes_make_the_model_invalid_without_a_pedal() {
    let mut drive = Drive::new();
    let wheels = [(CCVS1, 0, 20.0)];
    let brake = |on: f32| [(EBC5, 11, on)];
    let braking = |samples: &[Sample]| {
        let last = samples.last().unwrap();
        last.end.condition.braking
    };
    assert!(!braking(&drive.on(10, &wheels, &brake(0.0))));
    assert!(braking(&drive.on(5, &wheels, &brake(1.0))));
    assert!(!braking(&drive.on(10, &wheels, &brake(0.0))));
}
