//! A drive whose receiver and force are late.

use crate::{Noise, TestFrame};
use estimator_core::{Estimator, Instant, Reading, Signal, Value};

/// Mass of the vehicle, kg.
const MASS_KG: f32 = 39_000.0;
/// Slip of the driven wheels at a force of 20 kN.
const SLIP: f32 = 0.005;
/// Altitude at the start, m.
const ALTITUDE_M: f32 = 100.0;

/// What is late, s.
#[derive(Clone, Copy)]
pub struct Late {
    pub receiver_s: f32,
    pub traction_s: f32,
    /// Time constant of the receiver's low-pass on altitudes.
    pub altitude_s: f32,
}

impl Late {
    /// What comes in time.
    pub const IN_TIME: Self = Self {
        receiver_s: 0.15,
        traction_s: 0.0,
        altitude_s: 0.0,
    };
}

/// A drive so many seconds ago.
#[derive(Clone, Copy)]
struct Past {
    mps: f32,
    force_n: f32,
    altitude_m: f32,
}

/// A drive that goes on: a driver or a gearbox changes the force twelve times a minute, on a road
/// whose slope follows two waves of 2 and 1.5 %.
pub struct LateDrive {
    pub estimator: Estimator<f32>,
    /// Source address of the receiver.
    pub receiver: u8,
    /// Whether a clutch opens every twenty seconds, and the torque comes back within one.
    pub shifts: bool,
    noise: Noise,
    force_n: f32,
    until_s: f32,
    /// Altitude behind the low-pass of the receiver, m.
    smoothed_m: f32,
    /// Each tenth of a second.
    past: Vec<Past>,
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
            smoothed_m: ALTITUDE_M,
            past: vec![Past {
                mps: 15.0,
                force_n: 0.0,
                altitude_m: ALTITUDE_M,
            }],
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
        let before = *self.past.last().unwrap();
        let slope = 0.02 * (0.05 * now_s).sin() + 0.015 * (0.17 * now_s).sin();
        let mps = before.mps + 0.1 * (before.force_n / MASS_KG - 9.81 * slope);
        let mps = mps.clamp(5.0, 25.0);
        let altitude_m = before.altitude_m + 0.05 * (before.mps + mps) * slope;
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
        self.past.push(Past {
            mps,
            force_n: passed * self.force_n,
            altitude_m,
        });

        let then = self.before(late.receiver_s);
        let reported_n = self.before(late.traction_s).force_n;
        let part = 1.0 - (-0.1 / late.altitude_s.max(1e-3)).exp();
        self.smoothed_m += part * (then.altitude_m - self.smoothed_m);
        let altitude_m = self.smoothed_m + 0.2 * self.noise.draw();
        let wheels_mps = mps * (1.0 + SLIP * before.force_n / 20_000.0);
        let wheels_mps = wheels_mps + 0.02 * self.noise.draw();
        let now = Instant::from_micros(tick as u64 * 100_000);
        if tick % 2 == 1 {
            let noisy_mps = then.mps + 0.05 * self.noise.draw();
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
            put(Signal::Altitude, altitude_m);
        }
        put(Signal::WheelSpeed, wheels_mps);
        while self.estimator.step().is_some() {
            while self.estimator.next_cell().is_some() {}
        }
    }

    /// Returns the state so many seconds ago, between two tenths.
    fn before(&self, seconds: f32) -> Past {
        let ticks = 10.0 * seconds;
        let part = ticks.fract();
        let at = |ticks: usize| self.past[(self.past.len() - 1).saturating_sub(ticks)];
        let (newer, older) = (at(ticks as usize), at(ticks as usize + 1));
        let between = |newer: f32, older: f32| newer + part * (older - newer);
        Past {
            mps: between(newer.mps, older.mps),
            force_n: between(newer.force_n, older.force_n),
            altitude_m: between(newer.altitude_m, older.altitude_m),
        }
    }
}

/// Returns a frame with a speed over ground (129026).
fn ground_speed(source: u8, mps: f32) -> TestFrame {
    let [low, high] = ((100.0 * mps).round() as u16).to_le_bytes();
    let data = [0xff, 0xff, 0xff, 0xff, low, high, 0xff, 0xff];
    TestFrame::of_pgn(129_026, source, &data)
}
