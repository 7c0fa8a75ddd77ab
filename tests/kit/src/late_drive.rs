//! A drive whose receiver and force are late.

use crate::{Noise, TestFrame};
use estimator_core::{Estimator, Instant, Reading, Signal, Value};

/// Mass of the vehicle, kg.
const MASS_KG: f32 = 39_000.0;
/// Slip of the driven wheels at a force of 20 kN.
const SLIP: f32 = 0.005;

/// What is late, s.
#[derive(Clone, Copy)]
pub struct Late {
    pub receiver_s: f32,
    pub traction_s: f32,
}

/// A drive that goes on: a driver or a gearbox changes the force twelve times a minute, on a road
/// whose slope follows a wave of 2 %.
pub struct LateDrive {
    pub estimator: Estimator<f32>,
    /// Source address of the receiver.
    pub receiver: u8,
    /// Whether a clutch opens every twenty seconds, and the torque comes back within one.
    pub shifts: bool,
    noise: Noise,
    force_n: f32,
    until_s: f32,
    /// Speed, m/s, distance, m, and force, N, of each tenth of a second.
    past: Vec<(f32, f32, f32)>,
}

impl LateDrive {
    pub fn of(estimator: Estimator<f32>, seed: u64) -> Self {
        Self {
            estimator,
            receiver: 0x1c,
            shifts: false,
            noise: Noise(seed),
            force_n: 0.0,
            until_s: 0.0,
            past: vec![(15.0, 0.0, 0.0)],
        }
    }

    /// Drives on for so many seconds.
    pub fn on(&mut self, seconds: u32, late: Late) {
        for _ in 0..10 * seconds {
            self.tick(late);
        }
    }

    fn tick(&mut self, late: Late) {
        let tick = self.past.len();
        let now_s = 0.1 * tick as f32;
        let (before_mps, before_m, before_n) = *self.past.last().unwrap();
        let slope_n = 0.02 * 9.81 * MASS_KG * (0.05 * now_s).sin();
        let mps = before_mps + 0.1 * (before_n - slope_n) / MASS_KG;
        let mps = mps.clamp(5.0, 25.0);
        let metres = before_m + 0.05 * (before_mps + mps);
        if now_s >= self.until_s {
            self.until_s = now_s + 5.0 * (0.5 + self.noise.draw().abs());
            // Back to 15 m/s in the mean.
            self.force_n = 4_000.0 * (15.0 - mps) + 12_000.0 * self.noise.draw();
        }
        let since_shift_s = now_s % 20.0;
        let passed = if self.shifts {
            (since_shift_s - 0.8).clamp(0.0, 1.0)
        } else {
            1.0
        };
        self.past.push((mps, metres, passed * self.force_n));

        let (ground_mps, then_m, _) = self.before(late.receiver_s);
        let (_, _, reported_n) = self.before(late.traction_s);
        let wheels_mps = mps * (1.0 + SLIP * before_n / 20_000.0);
        let wheels_mps = wheels_mps + 0.02 * self.noise.draw();
        let now = Instant::from_micros(tick as u64 * 100_000);
        if tick % 2 == 1 {
            let noisy_mps = ground_mps + 0.05 * self.noise.draw();
            let frame = ground_speed(self.receiver, noisy_mps);
            self.estimator.on_frame(now, &frame);
        }
        let mut put = |signal, value| {
            let value = Value::Real(value);
            self.estimator.on_reading(now, Reading { signal, value });
        };
        put(Signal::TractionForce, reported_n);
        if tick % 10 == 3 {
            put(Signal::Satellites, 9.0);
            put(Signal::Altitude, 100.0 + 0.01 * then_m);
        }
        put(Signal::WheelSpeed, wheels_mps);
        while self.estimator.step().is_some() {
            while self.estimator.next_cell().is_some() {}
        }
    }

    /// Returns the state so many seconds ago, between two tenths.
    fn before(&self, seconds: f32) -> (f32, f32, f32) {
        let ticks = 10.0 * seconds;
        let part = ticks.fract();
        let at = |ticks: usize| self.past[(self.past.len() - 1).saturating_sub(ticks)];
        let (newer, older) = (at(ticks as usize), at(ticks as usize + 1));
        let between = |newer: f32, older: f32| newer + part * (older - newer);
        (
            between(newer.0, older.0),
            between(newer.1, older.1),
            between(newer.2, older.2),
        )
    }
}

/// Returns a frame with a speed over ground (129026).
fn ground_speed(source: u8, mps: f32) -> TestFrame {
    let [low, high] = ((100.0 * mps).round() as u16).to_le_bytes();
    let data = [0xff, 0xff, 0xff, 0xff, low, high, 0xff, 0xff];
    TestFrame::of_pgn(129_026, source, &data)
}
