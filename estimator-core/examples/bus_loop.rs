//! The loop of a controller: frames in, estimate out, with any driver that has `embedded-can`'s traits.
//!
//! ```text
//! cargo run -p estimator-core --example bus_loop
//! ```

use embedded_can::blocking::Can;
use embedded_can::{ErrorKind, ExtendedId, Frame, Id};
use estimator_core::signal::encode;
use estimator_core::{
    Estimator, Gear, Instant, Powertrain, Signal, Traction, Tuning, Value, VehicleParameters,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let powertrain = Powertrain {
        engine_inertia_kgm2: 3.5,
        reference_torque_nm: 2_500.0,
        final_drive_ratio: 2.6,
        final_drive_efficiency: 0.97,
        gears: [1.26, 1.0]
            .map(|ratio| Gear {
                ratio,
                efficiency: 0.985,
            })
            .into_iter()
            .collect(),
    };
    let truck = VehicleParameters {
        mass_kg: 39_000.0,
        drag_area_m2: 5.8,
        rolling_resistance: 0.006,
        wheel_radius_m: 0.5,
        wheel_inertia_kgm2: 120.0,
        traction: Traction::Powertrain(powertrain),
    };
    let mut estimator = Estimator::<f32>::new(truck, Tuning::default())?;
    let mut bus = Replay::default();
    while let Ok(frame) = bus.receive() {
        // On a board: a timer that never stops.
        let now = bus.now();
        estimator.on_frame(now, &frame);
        // One cell of 2.5 m a step; a frame may close none, or several.
        while estimator.step().is_some() {
            while estimator.next_cell().is_some() {
                // Finished, 500 m back: for a map, or a log.
            }
        }
    }
    let live = estimator.live().ok_or("no estimate in a minute")?.estimate;
    let grade = live.grade_percent;
    println!(
        "{:.1} m/s, grade {:.2} % (sigma {:.2} %)",
        live.speed_mps, grade.value, grade.sigma
    );
    Ok(())
}

/// A driver that replays a minute of a truck on a level road: engine, gearbox and speed in turn, every
/// 50 ms. It ends like a bus that is switched off.
#[derive(Default)]
struct Replay {
    received: u32,
}

/// Returns what a message says of a signal.
type ValueOf = fn(Signal) -> Value;

/// Messages, and what they say. 32 % of the torque in the direct gear holds 80 km/h.
const MESSAGES: [(u32, ValueOf); 3] = [
    (61_444, |signal| match signal {
        Signal::EngineTorque => Value::Real(32.0),
        Signal::EngineSpeed => Value::Real(1_105.0),
        _ => Value::NotAvailable,
    }),
    (61_445, |signal| match signal {
        Signal::GearRatio => Value::Real(1.0),
        Signal::CurrentGear => Value::Real(2.0),
        _ => Value::NotAvailable,
    }),
    (65_265, |signal| match signal {
        Signal::WheelSpeed => Value::Real(80.0 / 3.6),
        _ => Value::NotAvailable,
    }),
];

impl Replay {
    fn now(&self) -> Instant {
        Instant::from_micros(u64::from(self.received) * 50_000)
    }
}

impl Can for Replay {
    type Frame = ClassicFrame;
    type Error = ErrorKind;

    fn transmit(&mut self, _: &ClassicFrame) -> Result<(), ErrorKind> {
        Ok(())
    }

    fn receive(&mut self) -> Result<ClassicFrame, ErrorKind> {
        if self.received == 1_200 {
            return Err(ErrorKind::Other);
        }
        let (pgn, value_of) = MESSAGES[self.received as usize % MESSAGES.len()];
        self.received += 1;
        let mut payload = [0; 8];
        let length = encode(pgn, &mut payload, value_of).ok_or(ErrorKind::Other)?;
        // Priority 6, source address 0.
        let id = ExtendedId::new(6 << 26 | pgn << 8).ok_or(ErrorKind::Other)?;
        ClassicFrame::new(id, &payload[..length]).ok_or(ErrorKind::Other)
    }
}

/// A frame, as a bus driver gives it.
struct ClassicFrame {
    id: Id,
    length: usize,
    data: [u8; 8],
}

impl Frame for ClassicFrame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let mut bytes = [0; 8];
        bytes.get_mut(..data.len())?.copy_from_slice(data);
        Some(Self {
            id: id.into(),
            length: data.len(),
            data: bytes,
        })
    }

    fn new_remote(_: impl Into<Id>, _: usize) -> Option<Self> {
        None
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        false
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        self.length
    }

    fn data(&self) -> &[u8] {
        &self.data[..self.length]
    }
}
