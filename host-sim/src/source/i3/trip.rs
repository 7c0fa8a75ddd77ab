//! A trip, and what its reading left out.

/// A tenth of a second of a trip; `None` is missing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TripRow {
    /// Time since the trip's start, s.
    pub time_s: f64,
    /// Speed, m/s.
    pub speed_mps: Option<f64>,
    /// Torque of the motor, Nm; negative where it recuperates.
    pub motor_torque_nm: Option<f64>,
    /// Reading of the longitudinal accelerometer, m/s²: motion and gravity.
    pub acceleration_mps2: Option<f64>,
    /// Elevation, m: where it was measured, in a trip that was read; everywhere, in a file.
    pub altitude_m: Option<f64>,
    /// Ambient temperature, °C.
    pub ambient_celsius: Option<f64>,
}

/// A whole trip. Its rows have no interpolated gaps, and altitudes only where they were measured.
#[derive(Clone, Debug)]
pub struct Trip {
    pub(super) name: String,
    pub(super) rows: Vec<TripRow>,
    pub(super) notes: Vec<String>,
}

impl Trip {
    /// Returns its name, that of the file without endings.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns its rows, in order of time.
    #[must_use]
    pub fn rows(&self) -> &[TripRow] {
        &self.rows
    }

    /// Returns what was missing in the file or left out, a sentence each.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the driven distance, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        let speed = |row: &TripRow| row.speed_mps.unwrap_or(0.0);
        let pairs = self.rows.windows(2);
        pairs
            .map(|two| 0.5 * (speed(&two[0]) + speed(&two[1])) * (two[1].time_s - two[0].time_s))
            .sum()
    }

    /// Returns the mean ambient temperature, °C; `None` if there is none.
    #[must_use]
    pub fn ambient_celsius(&self) -> Option<f64> {
        let mut sum = 0.0;
        let mut count = 0_u32;
        for celsius in self.rows.iter().filter_map(|row| row.ambient_celsius) {
            sum += celsius;
            count += 1;
        }
        (count > 0).then(|| sum / f64::from(count))
    }
}
