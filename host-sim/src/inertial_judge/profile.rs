//! Distance and climb of a drive, from speed and acceleration.

/// Standard gravity, m/s².
pub const GRAVITY_MPS2: f64 = 9.806_65;
/// Longest step between two samples, s. What happens in a longer one is not known.
const LONGEST_STEP_S: f64 = 1.0;

/// The state at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    /// Time of the log, s.
    pub time_s: f64,
    /// Distance driven since the first sample, m; over a break, what the speeds at its ends tell.
    pub distance_m: f64,
    /// Climb since the first sample, m, as the accelerometer shows it; not defined over a break.
    pub climb_m: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Acceleration as read, m/s².
    pub acceleration_mps2: f64,
    /// Number of breaks before this point.
    pub breaks: u32,
}

/// A drive as speed and accelerometer show it, in order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InertialProfile {
    points: Vec<ProfilePoint>,
    speed_resolution_mps: f64,
}

impl InertialProfile {
    /// Integrates samples with a time (s), a speed (m/s) and an acceleration (m/s²) each.
    ///
    /// Samples that are not finite, go backwards in time, or reverse are left out; where more than
    /// a second is missing, the profile has a break.
    #[must_use]
    pub fn new(times_s: &[f64], speeds_mps: &[f64], accelerations_mps2: &[f64]) -> Self {
        let mut profile = Self {
            points: Vec::with_capacity(times_s.len()),
            speed_resolution_mps: f64::INFINITY,
        };
        for ((&time_s, &speed_mps), &acceleration_mps2) in
            times_s.iter().zip(speeds_mps).zip(accelerations_mps2)
        {
            let is_usable = time_s.is_finite() && speed_mps >= 0.0 && speed_mps.is_finite();
            if is_usable && acceleration_mps2.is_finite() {
                profile.push(time_s, speed_mps, acceleration_mps2);
            }
        }
        profile
    }

    fn push(&mut self, time_s: f64, speed_mps: f64, acceleration_mps2: f64) {
        let mut point = ProfilePoint {
            time_s,
            distance_m: 0.0,
            climb_m: 0.0,
            speed_mps,
            acceleration_mps2,
            breaks: 0,
        };
        if let Some(last) = self.points.last() {
            let step_s = time_s - last.time_s;
            if step_s <= 0.0 {
                return;
            }
            let work =
                0.5 * (last.acceleration_mps2 * last.speed_mps + acceleration_mps2 * speed_mps);
            let kinetic = 0.5 * (speed_mps.powi(2) - last.speed_mps.powi(2));
            point.distance_m = last.distance_m + 0.5 * (last.speed_mps + speed_mps) * step_s;
            point.climb_m = last.climb_m + (work * step_s - kinetic) / GRAVITY_MPS2;
            point.breaks = last.breaks + u32::from(step_s > LONGEST_STEP_S);
            let change_mps = (speed_mps - last.speed_mps).abs();
            if change_mps > f64::EPSILON.sqrt() {
                self.speed_resolution_mps = self.speed_resolution_mps.min(change_mps);
            }
        }
        self.points.push(point);
    }

    /// Returns the points, in order of time.
    #[must_use]
    pub fn points(&self) -> &[ProfilePoint] {
        &self.points
    }

    /// Returns the smallest change of the speed, m/s; 0 if it never changes.
    #[must_use]
    pub fn speed_resolution_mps(&self) -> f64 {
        if self.speed_resolution_mps.is_finite() {
            self.speed_resolution_mps
        } else {
            0.0
        }
    }

    /// Returns the state where this distance is first reached; `None` outside the drive and in a break.
    #[must_use]
    pub fn at_distance(&self, distance_m: f64) -> Option<ProfilePoint> {
        self.between(|point| point.distance_m, distance_m)
    }

    /// Returns the state at this time; `None` outside the drive and in a break.
    #[must_use]
    pub fn at_time(&self, time_s: f64) -> Option<ProfilePoint> {
        self.between(|point| point.time_s, time_s)
    }

    /// Interpolates where a growing quantity first reaches a value.
    fn between(&self, of: impl Fn(&ProfilePoint) -> f64, value: f64) -> Option<ProfilePoint> {
        let after = self.points.partition_point(|point| of(point) < value);
        let b = self.points.get(after)?;
        let Some(a) = after.checked_sub(1).and_then(|k| self.points.get(k)) else {
            return (of(b) == value).then_some(*b);
        };
        if of(b) == value {
            return Some(*b);
        }
        if a.breaks != b.breaks {
            return None;
        }
        let part = (value - of(a)) / (of(b) - of(a));
        let mix = |of: fn(&ProfilePoint) -> f64| of(a) + part * (of(b) - of(a));
        Some(ProfilePoint {
            time_s: mix(|p| p.time_s),
            distance_m: mix(|p| p.distance_m),
            climb_m: mix(|p| p.climb_m),
            speed_mps: mix(|p| p.speed_mps),
            acceleration_mps2: mix(|p| p.acceleration_mps2),
            breaks: b.breaks,
        })
    }
}
