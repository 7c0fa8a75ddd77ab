//! What the engine says of itself (EC1) goes before what the vehicle file says.

use estimator_core::signal::encode;
use estimator_core::{
    Estimator, Instant, PersistentState, Reading, Signal, Traction, Tuning, Value,
    VehicleParameters,
};
use test_kit::{TestFrame, frames_of, truck};

const EEC1: u32 = 61_444;
const ETC2: u32 = 61_445;
const CCVS1: u32 = 65_265;
const EC1: u32 = 65_251;
const POSITION: u32 = 129_029;

/// Values of EC1: reference torque in Nm and inertia in kg m².
type Configuration = (f32, f32);

fn powertrain(vehicle: &VehicleParameters) -> (f32, f32) {
    let Traction::Powertrain(powertrain) = &vehicle.traction else {
        panic!("a truck has an engine");
    };
    (
        powertrain.reference_torque_nm,
        powertrain.engine_inertia_kgm2,
    )
}

/// A drive on a level road at 20 m/s.
struct Drive {
    estimator: Estimator<f32>,
    now_us: u64,
    fixes: u32,
}

impl Drive {
    fn of(vehicle: VehicleParameters) -> Self {
        Self {
            estimator: Estimator::new(vehicle, Tuning::default()).unwrap(),
            now_us: 1_000_000,
            fixes: 0,
        }
    }

    fn put(&mut self, frame: &TestFrame) {
        let now = Instant::from_micros(self.now_us);
        self.estimator.on_frame(now, frame);
        while self.estimator.step().is_some() {}
        while self.estimator.next_cell().is_some() {}
    }

    fn message(&mut self, pgn: u32, source: u8, value_of: impl Fn(Signal) -> Value) {
        let mut payload = [0; 64];
        let length = encode(pgn, &mut payload, value_of).unwrap();
        for frame in frames_of(pgn, source, 0, &payload[..length]) {
            self.put(&frame);
        }
    }

    /// Sends EC1, one frame each 50 ms.
    fn configuration(&mut self, source: u8, (torque_nm, inertia_kgm2): Configuration) {
        let mut payload = [0; 64];
        let length = encode(EC1, &mut payload, |signal| match signal {
            Signal::EngineReferenceTorque => Value::Real(torque_nm),
            _ => Value::Real(inertia_kgm2),
        });
        for frame in frames_of(EC1, source, 0, &payload[..length.unwrap()]) {
            self.put(&frame);
            self.now_us += 50_000;
        }
    }

    /// Drives for some seconds with this engine torque.
    fn on(&mut self, seconds: u32, torque_percent: f32) {
        for tenth in 0..10 * seconds {
            for pgn in [EEC1, ETC2, CCVS1] {
                self.message(pgn, 0, |signal| match signal {
                    Signal::EngineTorque => Value::Real(torque_percent),
                    Signal::EngineTorqueFraction => Value::Real(0.0),
                    Signal::EngineSpeed => Value::Real(55.77 * 20.0),
                    Signal::CurrentGear => Value::Real(11.0),
                    Signal::WheelSpeed => Value::Real(20.0 + 0.004 * (tenth % 5) as f32),
                    _ => Value::NotAvailable,
                });
            }
            if tenth % 10 == 0 {
                self.fixes += 1;
                let altitude_m = 100.0 + 0.01 * (self.fixes % 3) as f32;
                self.message(POSITION, 0x1c, |signal| match signal {
                    Signal::Latitude | Signal::Longitude => Value::DegreesE7(100_000_000),
                    Signal::Altitude => Value::Real(altitude_m),
                    Signal::FixMethod => Value::Real(1.0),
                    Signal::Satellites => Value::Real(12.0),
                    _ => Value::Real(1.0),
                });
            }
            self.now_us += 100_000;
        }
    }

    fn in_use(&self) -> (f32, f32) {
        powertrain(&self.estimator.model().vehicle)
    }

    fn replaced(&self) -> u32 {
        self.estimator.counters().parameters_replaced
    }
}

#[test]
fn a_confirmed_reference_torque_goes_before_the_file() {
    let file = powertrain(&truck());
    let mut drive = Drive::of(truck());
    drive.on(1, 40.0);
    drive.configuration(0, (1_900.0, file.1));
    assert_eq!((drive.in_use(), drive.replaced()), (file, 0));
    drive.on(4, 40.0);
    drive.configuration(0, (1_900.0, file.1));
    assert_eq!(drive.in_use(), (1_900.0, file.1));
    assert_eq!(drive.replaced(), 1);
    // The same again is no change.
    drive.configuration(0, (1_900.0, file.1));
    assert_eq!(drive.replaced(), 1);
}

#[test]
fn rounding_and_accessories_are_no_difference() {
    let (torque_nm, inertia_kgm2) = powertrain(&truck());
    for (configuration, expected) in [
        ((torque_nm * 1.004, inertia_kgm2 * 1.15), 0),
        ((torque_nm * 0.996, inertia_kgm2 * 0.85), 0),
        ((torque_nm * 1.01, inertia_kgm2), 1),
        ((torque_nm, inertia_kgm2 * 1.3), 1),
        ((torque_nm * 0.9, inertia_kgm2 * 0.5), 2),
    ] {
        let mut drive = Drive::of(truck());
        drive.on(1, 40.0);
        for _ in 0..3 {
            drive.configuration(0, configuration);
        }
        assert_eq!(drive.replaced(), expected, "{configuration:?}");
        let (used_nm, used_kgm2) = drive.in_use();
        if expected == 2 {
            assert!((used_nm - configuration.0).abs() <= 0.5);
            assert!((used_kgm2 - configuration.1).abs() <= 0.002);
        }
    }
}

#[test]
fn values_that_no_engine_has_and_values_that_change_are_not_used() {
    let file = powertrain(&truck());
    let mut drive = Drive::of(truck());
    drive.on(1, 40.0);
    for implausible in [(0.0, 0.0), (10_001.0, 51.0), (64_255.0, 257.0)] {
        for _ in 0..3 {
            drive.configuration(0, implausible);
        }
    }
    for torque_nm in [1_900.0, 2_000.0, 1_900.0, 2_000.0] {
        drive.configuration(0, (torque_nm, file.1));
    }
    assert_eq!((drive.in_use(), drive.replaced()), (file, 0));
}

#[test]
fn the_engine_whose_torque_is_used_counts() {
    let file = powertrain(&truck());
    let mut drive = Drive::of(truck());
    // Before any torque nobody knows which engine it is.
    drive.configuration(0, (1_900.0, file.1));
    drive.configuration(0, (1_900.0, file.1));
    drive.on(1, 40.0);
    for _ in 0..3 {
        drive.configuration(1, (2_500.0, file.1));
    }
    assert_eq!((drive.in_use(), drive.replaced()), (file, 0));
    assert!(drive.estimator.counters().other_source >= 6);
    for _ in 0..2 {
        drive.configuration(0, (1_900.0, file.1));
        drive.configuration(1, (2_500.0, file.1));
    }
    assert_eq!(drive.in_use().0, 1_900.0);
}

#[test]
fn a_measured_force_has_no_reference_torque() {
    let vehicle = VehicleParameters {
        traction: Traction::Force,
        ..truck()
    };
    let mut drive = Drive::of(vehicle.clone());
    drive.on(1, 40.0);
    for _ in 0..3 {
        drive.configuration(0, (1_900.0, 3.0));
    }
    assert_eq!(drive.estimator.model().vehicle, vehicle);
    assert_eq!(drive.replaced(), 0);
}

#[test]
fn readings_without_a_bus_count_too() {
    let mut drive = Drive::of(truck());
    for second in 1..=2 {
        let reading = Reading {
            signal: Signal::EngineReferenceTorque,
            value: Value::Real(1_900.0),
        };
        let now = Instant::from_micros(1_000_000 * second);
        drive.estimator.on_reading(now, reading);
    }
    assert_eq!(drive.in_use().0, 1_900.0);
}

/// Torque that holds the truck at 20 m/s on the level, % of what the bus says.
const HOLDS_PERCENT: f32 = 40.0;

#[test]
fn the_grade_is_that_of_the_right_torque() {
    // The right file, and one that is off by 15 % until EC1 was heard twice.
    let grade_percent = |file_factor: f32, heard_at_s: u32| {
        let mut vehicle = truck();
        let (right_nm, inertia) = powertrain(&vehicle);
        if let Traction::Powertrain(powertrain) = &mut vehicle.traction {
            powertrain.reference_torque_nm = file_factor * right_nm;
        }
        let mut drive = Drive::of(vehicle);
        drive.on(heard_at_s, HOLDS_PERCENT);
        for _ in 0..2 {
            drive.configuration(0, (right_nm, inertia));
            drive.on(5, HOLDS_PERCENT);
        }
        drive.on(600 - heard_at_s, HOLDS_PERCENT);
        let live = drive.estimator.live().unwrap();
        let reopened = drive.estimator.counters().loads_reopened;
        let state = drive.estimator.persistent_state();
        (live.estimate.grade_percent, reopened, state)
    };
    let (right, reopened, _) = grade_percent(1.0, 1);
    assert_eq!(reopened, 0);
    let (early, reopened, _) = grade_percent(1.15, 1);
    assert_eq!(reopened, 0, "nothing was learned yet");
    let (late, reopened, state) = grade_percent(1.15, 300);
    assert_eq!(reopened, 1);
    for other in [early, late] {
        let difference = (other.value - right.value).abs();
        assert!(difference < 2.0 * right.sigma + 0.05, "{other:?} {right:?}");
    }
    // The state belongs to the vehicle of the file, which is what the next drive begins with.
    let mut file = truck();
    if let Traction::Powertrain(powertrain) = &mut file.traction {
        powertrain.reference_torque_nm *= 1.15;
    }
    let state: PersistentState = state.expect("12 km were driven");
    assert!(Estimator::<f32>::restore(file, Tuning::default(), &state).is_ok());
}
