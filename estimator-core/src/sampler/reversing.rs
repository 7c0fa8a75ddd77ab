//! Reversing: wheel speeds have no sign, so other signals must show the direction.
//!
//! A reported reverse gear shows it. Where no gear is reported, the course does: a vehicle changes
//! its direction only at a stop, and then its course over ground turns round within metres. Until
//! then the cells since the stop wait, and there are none of them if the vehicle reverses.

use crate::time::Instant;
use crate::tuning::Tuning;

/// The direction of motion.
#[derive(Clone, Debug, Default)]
pub(super) struct Reversing {
    is_reversing: bool,
    /// Heading of the vehicle: its course while it drives forward, °.
    heading_deg: Option<f32>,
    /// Time of the last standstill, while the direction since then is not known.
    stood: Option<Instant>,
    /// Whether cells since then wait for a course.
    waits: bool,
}

/// What shows the direction at a speed reading.
#[derive(Clone, Copy, Debug)]
pub(super) struct DirectionSignals {
    /// Wheel speed, m/s.
    pub speed_mps: f32,
    /// Reported gear; negative in reverse.
    pub gear: Option<f32>,
    /// Course over ground, °, with the time of its reading.
    pub course: Option<(f32, Instant)>,
}

impl Reversing {
    /// Returns whether the vehicle reverses.
    pub(super) const fn is_on(&self) -> bool {
        self.is_reversing
    }

    /// Returns whether the vehicle moves since a stop and its course will show which way. `gear` is
    /// the reported one, which would have shown it.
    pub(super) fn waits_for_course(&self, gear: Option<f32>) -> bool {
        self.waits && gear.is_none() && self.stood.is_some() && self.heading_deg.is_some()
    }

    /// Gives up waiting until the next stop.
    pub(super) const fn give_up(&mut self) {
        self.waits = false;
    }

    /// Follows the direction at a speed reading. Returns whether the vehicle reverses.
    pub(super) fn follow(
        &mut self,
        tuning: &Tuning,
        now: Instant,
        signals: &DirectionSignals,
    ) -> bool {
        if signals.speed_mps < tuning.detection.standing_mps {
            self.stood = Some(now);
            self.waits = true;
        }
        match signals.gear {
            Some(gear) if gear < -0.5 => self.is_reversing = true,
            Some(gear) if gear > 0.5 => self.is_reversing = false,
            // Neutral: the vehicle rolls on.
            Some(_) => {}
            None => self.follow_course(tuning, signals),
        }
        self.keep_heading(tuning, signals);
        self.is_reversing
    }

    fn follow_course(&mut self, tuning: &Tuning, signals: &DirectionSignals) {
        let detection = &tuning.detection;
        if self.is_reversing && signals.speed_mps > detection.launch_mps {
            // It turned round where courses were bad.
            self.is_reversing = false;
            self.heading_deg = None;
        }
        let (Some(stood), Some(heading_deg), Some((course_deg, taken))) =
            (self.stood, self.heading_deg, signals.course)
        else {
            return;
        };
        // A course from before the stop, or of a vehicle that hardly moves, shows nothing.
        let is_new = taken > stood + tuning.hold_times.gnss_latency;
        if !is_new || signals.speed_mps < detection.reverse_course_mps {
            return;
        }
        let turned = turned_deg(heading_deg, course_deg);
        if turned > detection.reverse_turned_deg {
            self.is_reversing = true;
        } else if turned < 180.0 - detection.reverse_turned_deg {
            self.is_reversing = false;
        }
        self.stood = None;
    }

    /// Keeps the heading where the course is good.
    fn keep_heading(&mut self, tuning: &Tuning, signals: &DirectionSignals) {
        if let Some((course_deg, _)) = signals.course
            && signals.speed_mps >= tuning.detection.slow_mps
            && (self.stood.is_none() || signals.gear.is_some())
        {
            let heading_deg = if self.is_reversing {
                course_deg + 180.0
            } else {
                course_deg
            };
            self.heading_deg = Some(heading_deg);
        }
        if self.heading_deg.is_none() {
            self.stood = None;
        }
    }
}

/// Returns the angle between two directions that differ by less than two turns, from 0 to 180 °.
fn turned_deg(a_deg: f32, b_deg: f32) -> f32 {
    let apart = (a_deg - b_deg).abs();
    // Not `%`: the library's function takes a kilobyte of flash.
    let turned = if apart < 360.0 { apart } else { apart - 360.0 };
    if turned > 180.0 {
        360.0 - turned
    } else {
        turned
    }
}
