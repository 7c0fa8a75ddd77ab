//! A small drive with every kind of frame that a bus carries, the same each time.

use embedded_can::{ExtendedId, Frame, StandardId};
use estimator_core::effect::CATALOGUE;
use estimator_core::signal::encode;
use estimator_core::vehicle::{Driveline, GRAVITY, STANDARD_AIR_DENSITY};
use estimator_core::{AdoptedEffect, Gear, Instant, Model, Signal, Value};
use host_sim::source::can_frame::{CanFrame, TimedFrame};
use std::f64::consts::TAU;
use std::ops::Range;
use test_kit::truck_with;

/// A little above 2 km.
const DURATION_S: f64 = 100.0;
const GEAR: Gear = Gear {
    ratio: 1.0,
    efficiency: 0.985,
};

/// Unusual events and their times, s.
const NO_FIX_YET: Range<f64> = 0.0..8.0;
const SHIFTING: Range<f64> = 40.0..41.0;
const PACKET_WITH_A_HOLE: Range<f64> = 50.0..51.0;
const BRAKING: Range<f64> = 60.0..62.0;
const FEW_SATELLITES: Range<f64> = 70.0..74.0;
const NO_SPEED: Range<f64> = 80.0..84.0;

const EEC1: u32 = 61_444;
const ETC1: u32 = 61_442;
const ETC2: u32 = 61_445;
const CCVS1: u32 = 65_265;
const GNSS_POSITION: u32 = 129_029;

/// Returns a loaded truck in its highest gears.
#[must_use]
pub fn truck() -> Model {
    truck_with(3_500.0, &[1.26, GEAR.ratio]).into()
}

/// Returns the truck with every effect of the catalogue.
///
/// # Panics
/// Panics if the catalogue has an effect that cannot be adopted.
#[must_use]
pub fn truck_with_every_effect() -> Model {
    let mut model = truck();
    for effect in CATALOGUE {
        let mut adopted = AdoptedEffect::new(effect, 0.2 * effect.typical, 0.5 * effect.typical);
        if effect.name == "road_surface" {
            assert!(adopted.set("latitude_deg", 58.0) && adopted.set("length_m", 3_000.0));
        }
        let adopted = model.effects.adopt(adopted);
        adopted.expect("there is room for each effect once");
    }
    model
}

/// Returns the drive of [`truck`] over rolling hills.
///
/// Its bus carries a shift, braking, a fix with too few satellites, a broken fast packet, a gap
/// without speed, frames that are ignored and one frame that is too late.
#[must_use]
pub fn drive() -> Vec<TimedFrame> {
    drive_for(DURATION_S)
}

/// Returns the same drive over the same hills, which goes on for longer.
#[must_use]
pub fn drive_for(seconds: f64) -> Vec<TimedFrame> {
    let mut bus = BusLog::default();
    for ms in (0..(seconds * 1e3) as u64).step_by(50) {
        let now = TruckMoment::at(ms as f64 * 1e-3);
        bus.now = Instant::from_micros(ms * 1000);
        bus.send(EEC1, |signal| now.engine(signal));
        if ms % 100 == 0 {
            bus.send(ETC1, |signal| now.gearbox(signal));
            bus.send(ETC2, |signal| now.gearbox(signal));
            if !NO_SPEED.contains(&now.seconds) {
                bus.send(CCVS1, |signal| now.chassis(signal));
            }
        }
        if ms % 1000 == 150 {
            bus.send_position(&now);
            bus.send_noise();
        }
    }
    bus.frames
}

/// The truck at one moment.
struct TruckMoment {
    seconds: f64,
    speed_mps: f64,
    altitude_m: f64,
    torque_percent: f64,
    north_m: f64,
}

impl TruckMoment {
    fn at(seconds: f64) -> Self {
        let model = truck();
        let vehicle = &model.vehicle;
        let swing = 0.07 * seconds;
        let speed_mps = 22.0 + 0.6 * swing.sin();
        let driven_m = 22.0 * seconds + 0.6 / 0.07 * (1.0 - swing.cos());
        let (hill_m, steepest) = (700.0, 0.015);
        let phase = TAU * driven_m / hill_m;
        let grade = steepest * phase.sin();

        let driveline = Driveline::Engaged(GEAR);
        let mass = f64::from(vehicle.mass_kg);
        let inertia_n = (mass + f64::from(model.rotating_kg(driveline))) * 0.6 * 0.07 * swing.cos();
        let air_n =
            0.5 * f64::from(vehicle.drag_area_m2 * STANDARD_AIR_DENSITY) * speed_mps * speed_mps;
        let weight_n = mass * f64::from(GRAVITY);
        let road_n = weight_n * (f64::from(vehicle.rolling_resistance) + grade.atan().sin());
        Self {
            seconds,
            speed_mps,
            altitude_m: 120.0 + steepest * hill_m / TAU * (1.0 - phase.cos()),
            torque_percent: (inertia_n + air_n + road_n)
                / f64::from(model.traction_n(driveline, 1.0)),
            north_m: driven_m,
        }
    }

    fn engine(&self, signal: Signal) -> Value {
        match signal {
            // The fraction refines the torque, which counts in whole percents.
            Signal::EngineTorque => Value::Real(self.torque_percent.floor() as f32),
            Signal::EngineTorqueFraction => Value::Real(self.torque_percent.rem_euclid(1.0) as f32),
            Signal::EngineSpeed => Value::Real(1_200.0),
            _ => Value::NotAvailable,
        }
    }

    fn gearbox(&self, signal: Signal) -> Value {
        match signal {
            Signal::ShiftInProcess => switch(SHIFTING.contains(&self.seconds)),
            Signal::DrivelineEngaged => switch(true),
            Signal::GearRatio => Value::Real(GEAR.ratio),
            Signal::CurrentGear => Value::Real(2.0),
            _ => Value::NotAvailable,
        }
    }

    fn chassis(&self, signal: Signal) -> Value {
        match signal {
            Signal::WheelSpeed => Value::Real(self.speed_mps as f32),
            Signal::BrakeSwitch => switch(BRAKING.contains(&self.seconds)),
            _ => Value::NotAvailable,
        }
    }

    fn receiver(&self, signal: Signal) -> Value {
        let satellites = if FEW_SATELLITES.contains(&self.seconds) {
            3.0
        } else {
            9.0
        };
        let metres_per_e7 = 0.011_1;
        match signal {
            Signal::FixMethod => Value::Real(1.0),
            Signal::Satellites => Value::Real(satellites),
            Signal::Hdop => Value::Real(0.9),
            Signal::Latitude => {
                Value::DegreesE7(557_000_000 + (self.north_m / metres_per_e7) as i32)
            }
            Signal::Longitude => Value::DegreesE7(131_000_000),
            Signal::Altitude => Value::Real(self.altitude_m as f32),
            _ => Value::NotAvailable,
        }
    }
}

fn switch(on: bool) -> Value {
    Value::Real(f32::from(u8::from(on)))
}

/// The frames sent so far.
#[derive(Default)]
struct BusLog {
    now: Instant,
    frames: Vec<TimedFrame>,
    packets: u8,
}

impl BusLog {
    fn push(&mut self, frame: Option<CanFrame>) {
        self.frames.push(TimedFrame {
            time: self.now,
            frame: frame.expect("identifier and length are those of CAN"),
        });
    }

    /// Sends a message as a single frame.
    fn send(&mut self, pgn: u32, value_of: impl FnMut(Signal) -> Value) {
        let mut payload = [0; 8];
        let length = encode(pgn, &mut payload, value_of).expect("a message of one frame");
        self.push(CanFrame::extended(identifier(pgn), &payload[..length]));
    }

    /// Sends a fix as the seven frames of a fast packet.
    fn send_position(&mut self, now: &TruckMoment) {
        if NO_FIX_YET.contains(&now.seconds) {
            return;
        }
        let mut payload = [0; 64];
        let length = encode(GNSS_POSITION, &mut payload, |signal| now.receiver(signal))
            .expect("a message that the core knows");
        let id = identifier(GNSS_POSITION);
        let frames = CanFrame::carrying(id, self.packets, &payload[..length]);
        self.packets = (self.packets + 1) % 8;
        for (index, frame) in frames.enumerate() {
            if index != 2 || !PACKET_WITH_A_HOLE.contains(&now.seconds) {
                self.push(Some(frame));
            }
        }
    }

    /// Sends an 11-bit identifier, an unknown message, a remote, a truncated and a late frame.
    fn send_noise(&mut self) {
        self.push(CanFrame::standard(0x123, &[1, 2, 3]));
        self.push(CanFrame::extended(identifier(65_262), &[0x7d; 8]));
        let id = ExtendedId::new(identifier(CCVS1)).expect("29 bits");
        self.push(CanFrame::new_remote(id, 8));
        self.push(CanFrame::extended(identifier(CCVS1), &[0xff, 0]));
        let now = self.now;
        self.now = Instant::from_micros(now.micros() - 1_000);
        self.push(CanFrame::new(StandardId::ZERO, &[]));
        self.now = now;
    }
}

fn identifier(pgn: u32) -> u32 {
    let (priority, source) = (6, 0x21);
    priority << 26 | pgn << 8 | source
}
