//! A bus of one's own: the signals of `car.dbc` (11-bit identifiers, Motorola order, a multiplexer) in
//! a table that is made at build time, as a firmware would have it.
//!
//! ```text
//! cargo run -p estimator-core --example own_dbc
//! ```
//!
//! Three parts make it:
//! 1. `signals.rs` names the signals: ours, and those of the file.
//! 2. The build script calls `own_messages::table` (`build/own_messages.rs`) and writes the table to
//!    `OUT_DIR`, as `build.rs` of this crate does for this example.
//! 3. The loop below gives each frame to [`decode_own`] first, and its readings to `on_reading`.

use embedded_can::{Frame, Id, StandardId};
use estimator_core::signal::own_message::{
    FrameMatch, Multiplexer, OwnMessage, OwnSignal, decode_own,
};
use estimator_core::signal::raw_field::{ByteOrder, NumberKind, RawField};
use estimator_core::{Estimator, Instant, Signal, Traction, Tuning, VehicleParameters};

include!(concat!(env!("OUT_DIR"), "/own_dbc_example.rs"));

fn main() -> Result<(), estimator_core::ParameterError> {
    let car = VehicleParameters {
        mass_kg: 1_500.0,
        drag_area_m2: 0.7,
        rolling_resistance: 0.01,
        wheel_radius_m: 0.31,
        wheel_inertia_kgm2: 4.0,
        traction: Traction::Force,
    };
    let mut estimator = Estimator::<f32>::new(car, Tuning::default())?;
    // The same signals of built-in messages, if the bus has any, are left out.
    for own in CAR_MESSAGES.iter().flat_map(|message| message.signals) {
        estimator.reserve(own.signal);
    }
    for (now, frame) in drive() {
        let is_own = decode_own(&CAR_MESSAGES, &frame, |reading| {
            estimator.on_reading(now, reading);
        });
        // A bus may have built-in messages beside our own.
        if !is_own {
            estimator.on_frame(now, &frame);
        }
        while estimator.step().is_some() {}
    }
    let live = estimator.live().map(|live| live.estimate);
    if let Some(estimate) = live {
        println!(
            "{:.1} m/s, grade {:.2} % (sigma {:.2} %); the road climbs by 2 %",
            estimate.speed_mps, estimate.grade_percent.value, estimate.grade_percent.sigma
        );
    }
    Ok(())
}

/// Returns five minutes of a steady climb of 2 % at 72 km/h, as the car's bus has it.
fn drive() -> impl Iterator<Item = (Instant, CarFrame)> {
    (0..3_000_u32).flat_map(|k| {
        let now = Instant::from_micros(u64::from(k) * 100_000);
        // Weight times grade and rolling resistance, and air.
        let force_n = 1_500.0 * 9.81 * (0.02 + 0.01) + 0.5 * 1.2 * 0.7 * 20.0 * 20.0;
        let height_m = 400.0 + 0.02 * 20.0 * 0.1 * f64::from(k);
        let [f1, f0] = ((force_n * 2.0) as i16).to_be_bytes();
        let [_, h2, h1, h0] = (((height_m + 500.0) * 8.0) as u32).to_be_bytes();
        let [s1, s0] = 7_200_u16.to_be_bytes();
        let fix = k.is_multiple_of(10).then_some((300, [1, 9, h2, h1, h0]));
        let others = [(257, [f1, f0, 0, 0, 0]), (513, [0, s1, s0, 0, 0])];
        let frames = fix.into_iter().chain(others);
        frames.filter_map(move |(id, data)| {
            let id = StandardId::new(id)?;
            Some((now, CarFrame::new(id, &data)?))
        })
    })
}

/// A frame, as a bus driver would give it.
struct CarFrame {
    id: Id,
    data: Vec<u8>,
}

impl Frame for CarFrame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        (data.len() <= 8).then(|| Self {
            id: id.into(),
            data: data.to_vec(),
        })
    }

    fn new_remote(_id: impl Into<Id>, _dlc: usize) -> Option<Self> {
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
        self.data.len()
    }

    fn data(&self) -> &[u8] {
        &self.data
    }
}
