//! The faults by name.

use super::attack::{STRANGER, both, foretold, out_of_step, replayed};
use super::clock::{leaps, set_back, strays, wraps};
use super::frames::{
    bit_flipped, delayed, every_lost, lost, overlong_packets, pgn, randomly_lost, readdressed,
    repeated, sequenced, swapped, truncated, with_short_twins,
};
use super::shortfalls::Short;
use super::signals::{altered, replaced, stuck};
use super::{Frames, Window, random, seconds};
use estimator_core::{Duration, Instant, Signal, Value};
use host_sim::source::can_frame::TimedFrame;
use rand::RngExt;

/// Start of the faults, s from the first frame on: halfway, when the filter has converged.
const START_S: f64 = 600.0;
/// A time after the end of any drive, s.
const FOR_EVER_S: f64 = 1e5;
/// Speed of the simulator's trucks, for faults that are given by distance, m/s.
const CRUISE_MPS: f64 = 22.2;

const SPEED: &[Signal] = &[Signal::WheelSpeed];
const SPEEDS: &[Signal] = &[Signal::WheelSpeed, Signal::FrontAxleSpeed];
const TORQUE: &[Signal] = &[Signal::EngineTorque, Signal::EngineTorqueFraction];
const FRICTION: &[Signal] = &[Signal::FrictionTorque];
const ENGINE_SPEED: &[Signal] = &[Signal::EngineSpeed];
const GEAR: &[Signal] = &[Signal::GearRatio, Signal::CurrentGear];
const GEARBOX: &[Signal] = &[
    Signal::GearRatio,
    Signal::CurrentGear,
    Signal::SelectedGear,
    Signal::ShiftInProcess,
    Signal::DrivelineEngaged,
    Signal::ClutchSlip,
    Signal::OutputShaftSpeed,
];
const BRAKES: &[Signal] = &[
    Signal::BrakeSwitch,
    Signal::BrakePedal,
    Signal::ParkingBrake,
    Signal::RetarderTorque,
];
const BRAKE_SWITCH: &[Signal] = &[Signal::BrakeSwitch];
const SHIFT: &[Signal] = &[Signal::ShiftInProcess];
const ALTITUDE: &[Signal] = &[Signal::Altitude];
const POSITION: &[Signal] = &[Signal::Altitude, Signal::Latitude, Signal::Longitude];
const FIX: &[Signal] = &[Signal::FixMethod];

/// Returns the frames of a recording as they are received with a fault.
type Wrap = dyn for<'a> Fn(&'a [TimedFrame], Window) -> Frames<'a> + Sync + Send;

/// A fault.
pub struct Fault {
    /// Its name.
    pub name: String,
    /// The part that is at fault.
    pub kind: FaultKind,
    /// Start and end, s from the first frame on.
    pub window_s: (f64, f64),
    /// How far the clock is ahead from the start on, s.
    pub ahead_s: f64,
    /// The requirements that the estimator does not meet under it.
    pub short: Short,
    wrap: Box<Wrap>,
}

/// The part that is at fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// Nothing.
    Nothing,
    /// The bus.
    Bus,
    /// A sender.
    Signal,
    /// The GNSS receiver.
    Receiver,
    /// The listener's clock.
    Clock,
    /// An attacker on the bus.
    Attack,
}

impl Fault {
    fn new(
        kind: FaultKind,
        name: impl Into<String>,
        for_s: f64,
        wrap: impl for<'a> Fn(&'a [TimedFrame], Window) -> Frames<'a> + Sync + Send + 'static,
    ) -> Self {
        let name = name.into();
        Self {
            short: Short::of(&name),
            name,
            kind,
            window_s: (START_S, START_S + for_s),
            ahead_s: 0.0,
            wrap: Box::new(wrap),
        }
    }

    fn from(mut self, from_s: f64) -> Self {
        let length_s = self.window_s.1 - self.window_s.0;
        self.window_s = (from_s, from_s + length_s);
        self
    }

    /// Returns the duration, s; empty if the fault does not end.
    #[must_use]
    pub fn lasts(&self) -> String {
        let for_s = self.window_s.1 - self.window_s.0;
        if for_s < FOR_EVER_S {
            format!("{for_s:.0}")
        } else {
            String::new()
        }
    }

    /// Returns a recording as it is received with the fault.
    #[must_use]
    pub fn received<'a>(&self, recording: &'a [TimedFrame]) -> Frames<'a> {
        let first = recording.first().map_or(Instant::ZERO, |timed| timed.time);
        let at = |since_s: f64| first + seconds(since_s);
        (self.wrap)(recording, at(self.window_s.0)..at(self.window_s.1))
    }
}

/// Returns a fault that changes the true frames.
fn wraps_frames(
    kind: FaultKind,
    name: impl Into<String>,
    for_s: f64,
    wrap: impl for<'a> Fn(Frames<'a>, Window) -> Frames<'a> + Sync + Send + 'static,
) -> Fault {
    Fault::new(kind, name, for_s, move |recording, window| {
        wrap(true_frames(recording), window)
    })
}

fn true_frames(recording: &[TimedFrame]) -> Frames<'_> {
    Box::new(recording.iter().copied())
}

/// Returns all faults. The first is none.
#[must_use]
pub fn catalogue() -> Vec<Fault> {
    let mut faults = vec![wraps_frames(FaultKind::Nothing, "none", 60.0, |f, _| f)];
    faults.extend(of_the_bus());
    faults.extend(of_signals());
    faults.extend(of_the_receiver());
    faults.extend(of_the_clock());
    faults.extend(attacks());
    faults
}

fn of_the_bus() -> Vec<Fault> {
    let bus = |name, for_s, wrap: fn(Frames<'_>, Window) -> Frames<'_>| {
        wraps_frames(FaultKind::Bus, name, for_s, wrap)
    };
    vec![
        bus("every tenth frame lost", 120.0, |f, w| every_lost(f, w, 10)),
        bus("half of the frames lost", 120.0, |f, w| {
            randomly_lost(f, w, 0.5)
        }),
        bus("silence of 1 s", 1.0, |f, w| lost(f, w, |_| true)),
        bus("silence of 10 s", 10.0, |f, w| lost(f, w, |_| true)),
        bus("silence of 60 s", 60.0, |f, w| lost(f, w, |_| true)),
        bus("every frame repeated", 120.0, |f, w| repeated(f, w, 2)),
        bus("frames 0.5 s late", 120.0, |f, w| {
            delayed(f, w, |_| seconds(0.5))
        }),
        bus("frames up to 0.2 s late at random", 120.0, |f, w| {
            delayed(f, w, |rng| seconds(rng.random_range(0.0..0.2)))
        }),
        bus(
            "neighbouring frames swapped, with their time stamps",
            120.0,
            |f, w| swapped(f, w, true),
        ),
        bus(
            "neighbouring frames swapped before time stamping",
            120.0,
            |f, w| swapped(f, w, false),
        ),
        bus("one frame in five cut short", 120.0, |f, w| {
            truncated(f, w, 5)
        }),
        bus("over-long fast packets", 120.0, overlong_packets),
        bus("one bit flipped in one frame of 100", 120.0, |f, w| {
            bit_flipped(f, w, 100)
        }),
        bus("fast packet sequence counter stuck", 120.0, |f, w| {
            sequenced(f, w, |_| 0)
        }),
        bus("fast packet sequence counter random", 120.0, |f, w| {
            let mut rng = random();
            sequenced(f, w, move |_| rng.random_range(0..8))
        }),
        bus("one source address in ten wrong", 120.0, |f, w| {
            let mut rng = random();
            readdressed(f, w, move |own| {
                if rng.random_ratio(1, 10) {
                    rng.random()
                } else {
                    own
                }
            })
        }),
        bus("all messages from another source address", 60.0, |f, w| {
            readdressed(f, w, |own| own ^ 0x40)
        }),
        bus(
            "duplicates with 11-bit identifiers",
            120.0,
            with_short_twins,
        ),
    ]
}

fn of_signals() -> Vec<Fault> {
    let signal = |name: &str, for_s, wrap: fn(Frames<'_>, Window) -> Frames<'_>| {
        wraps_frames(FaultKind::Signal, name, for_s, wrap)
    };
    let groups: [(&str, &'static [Signal]); 9] = [
        ("torque", TORQUE),
        ("friction torque", FRICTION),
        ("engine speed", ENGINE_SPEED),
        ("wheel speed", SPEED),
        ("both speeds", SPEEDS),
        ("gear", GEAR),
        ("all of the gearbox", GEARBOX),
        ("brakes", BRAKES),
        ("all signals", Signal::ALL),
    ];
    let mut faults = Vec::new();
    for (name, signals) in groups {
        for (code, value, for_s) in [
            ("not available", Value::NotAvailable, 5.0),
            ("error", Value::Error, 120.0),
        ] {
            faults.push(wraps_frames(
                FaultKind::Signal,
                format!("{name}: {code} for {for_s} s"),
                for_s,
                move |f, w| replaced(f, w, signals, value),
            ));
        }
    }
    faults.extend([
        signal("wheel speed stuck", 60.0, |f, w| stuck(f, w, SPEED)),
        signal("both speeds stuck", 60.0, |f, w| stuck(f, w, SPEEDS)),
        signal("torque stuck", 60.0, |f, w| stuck(f, w, TORQUE)),
        signal("engine speed stuck", 60.0, |f, w| stuck(f, w, ENGINE_SPEED)),
        signal("gear stuck a gear too low", 60.0, |f, w| {
            altered(f, w, GEAR, |_, gear| {
                if gear > 2.0 && gear.fract() == 0.0 {
                    gear - 1.0
                } else {
                    1.26 * gear
                }
            })
        }),
        signal("brake switch stuck on", 120.0, |f, w| {
            replaced(f, w, BRAKE_SWITCH, Value::Real(1.0))
        }),
        signal("shift stuck on", 120.0, |f, w| {
            replaced(f, w, SHIFT, Value::Real(1.0))
        }),
        signal(
            "one wheel speed in 20 wrong by up to 5 m/s",
            120.0,
            |f, w| {
                let mut rng = random();
                altered(f, w, SPEED, move |_, mps| {
                    let off = rng.random_range(-5.0..5.0);
                    if rng.random_ratio(1, 20) {
                        mps + off
                    } else {
                        mps
                    }
                })
            },
        ),
        signal("wheel speed drops to 0 every 10 s", 120.0, |f, w| {
            altered(f, w, SPEED, |s, mps| if s % 10.0 < 0.3 { 0.0 } else { mps })
        }),
        signal("one torque in 20 wrong by up to 50 %", 120.0, |f, w| {
            let mut rng = random();
            altered(f, w, TORQUE, move |_, percent| {
                let off = rng.random_range(-50.0_f32..50.0).round();
                if percent >= 1.0 && rng.random_ratio(1, 20) {
                    percent + off
                } else {
                    percent
                }
            })
        }),
        signal("speed 3 % high for 120 s", 120.0, |f, w| {
            altered(f, w, SPEEDS, |_, v| 1.03 * v)
        }),
        signal("speed 3 % high from the start", FOR_EVER_S, |f, w| {
            altered(f, w, SPEEDS, |_, v| 1.03 * v)
        })
        .from(0.0),
    ]);
    faults
}

/// Returns the faults of the GNSS receiver.
#[must_use]
pub fn of_the_receiver() -> Vec<Fault> {
    let gnss = |name, for_s, wrap: fn(Frames<'_>, Window) -> Frames<'_>| {
        wraps_frames(FaultKind::Receiver, name, for_s, wrap)
    };
    let kilometre_s = 1_000.0 / CRUISE_MPS;
    let ramp = |name, for_s: f64, metres: f32| {
        wraps_frames(FaultKind::Receiver, name, for_s, move |f, w| {
            altered(f, w, ALTITUDE, move |s, m| m + metres * (s / for_s) as f32)
        })
    };
    vec![
        gnss("no fix for 120 s", 120.0, |f, w| {
            replaced(f, w, FIX, Value::Real(0.0))
        }),
        gnss("no fix for 600 s", 600.0, |f, w| {
            replaced(f, w, FIX, Value::Real(0.0))
        }),
        gnss("no fix at all", FOR_EVER_S, |f, w| {
            replaced(f, w, FIX, Value::Real(0.0))
        })
        .from(0.0),
        gnss("no messages for 120 s", 120.0, |f, w| {
            lost(f, w, |timed| {
                pgn(&timed.frame).is_some_and(|pgn| pgn >= 129_000)
            })
        }),
        gnss("altitude not available for 120 s", 120.0, |f, w| {
            replaced(f, w, ALTITUDE, Value::NotAvailable)
        }),
        gnss("frozen for 120 s", 120.0, |f, w| stuck(f, w, POSITION)),
        gnss("altitude 25 m too high for 60 s", 60.0, |f, w| {
            altered(f, w, ALTITUDE, |_, m| m + 25.0)
        }),
        gnss("single altitudes 40 m too high", 120.0, |f, w| {
            let mut rng = random();
            altered(f, w, ALTITUDE, move |_, m| {
                if rng.random_ratio(1, 10) { m + 40.0 } else { m }
            })
        }),
        ramp("drifts up by 10 m in 1 km", kilometre_s, 10.0),
        ramp("drifts down by 10 m in 1 km", kilometre_s, -10.0),
        ramp("drifts up by 10 m in 5 km", 5.0 * kilometre_s, 10.0),
    ]
}

fn of_the_clock() -> Vec<Fault> {
    let clock = |name, wrap: fn(Frames<'_>, Window) -> Frames<'_>| {
        wraps_frames(FaultKind::Clock, name, 1.0, wrap)
    };
    let leap = |name, ahead_s: f64| Fault {
        ahead_s,
        ..wraps_frames(FaultKind::Clock, name, 1.0, move |f, w| {
            leaps(f, w, seconds(ahead_s))
        })
    };
    vec![
        Fault {
            ahead_s: -0.3,
            ..clock("set back by 0.3 s", |f, w| set_back(f, w, seconds(0.3)))
        },
        clock("set back by 1 h", |f, w| set_back(f, w, seconds(3600.0))),
        clock("counter of 32 bits wraps around", |f, w| wraps(f, w)),
        leap("jumps ahead by 60 s", 60.0),
        leap("jumps ahead by 1 h", 3600.0),
        clock("single frames one hour early", |f, w| {
            strays(f, w, 100, seconds(3600.0), false)
        }),
        clock("single frames one day late", |f, w| {
            strays(f, w, 100, seconds(86_400.0), true)
        }),
    ]
}

fn attacks() -> Vec<Fault> {
    let attack = |name, for_s, wrap: fn(&[TimedFrame], Window) -> Frames<'_>| {
        Fault::new(FaultKind::Attack, name, for_s, wrap)
    };
    let ago: fn() -> Duration = || seconds(20.0);
    let with = |name, for_s, times, address: fn(u8) -> u8| {
        Fault::new(FaultKind::Attack, name, for_s, move |recording, window| {
            let theirs = replayed(recording, window, ago(), times, address);
            both(true_frames(recording), out_of_step(theirs))
        })
    };
    vec![
        with("replay from another source address", 120.0, 1, |_| STRANGER),
        with(
            "replay from another source address, five times as fast",
            120.0,
            5,
            |_| STRANGER,
        ),
        attack(
            "sends before the true senders start",
            60.0,
            |recording, window| {
                let silent = window.start..window.start + seconds(5.0);
                let theirs = foretold(recording, window, seconds(120.0), STRANGER);
                both(lost(true_frames(recording), silent, |_| true), theirs)
            },
        )
        .from(0.0),
        attack(
            "sends while the true senders pause for 15 s",
            60.0,
            |recording, window| {
                let silent = window.start..window.start + seconds(15.0);
                let theirs = replayed(recording, window, seconds(20.0), 1, |_| STRANGER);
                both(
                    lost(true_frames(recording), silent, |_| true),
                    out_of_step(theirs),
                )
            },
        ),
        with("replay from the true source addresses", 60.0, 1, |own| own),
        with(
            "replay from the true source addresses, five times as fast",
            60.0,
            5,
            |own| own,
        ),
    ]
}
