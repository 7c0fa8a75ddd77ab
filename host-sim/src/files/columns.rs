//! The columns of tables, with the range of each. What a program reads from a table is checked
//! against these ranges, CSV and Parquet alike, so that neither a damaged digit nor a huge number
//! reaches a map.

use super::flaw::Flaw;

/// A column of a table with the range of its numbers.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Name in the header.
    pub name: &'static str,
    least: f64,
    most: f64,
    expected: &'static str,
}

impl Column {
    /// Returns true if a number is one of this column.
    #[inline]
    #[must_use]
    pub fn holds(&self, value: f64) -> bool {
        (value >= self.least) & (value <= self.most)
    }

    /// Checks a number of this column.
    ///
    /// # Errors
    /// Names the column, the number and the range.
    pub fn check(&self, value: f64) -> Result<(), Flaw> {
        if self.holds(value) {
            return Ok(());
        }
        Err(self.flaw(value))
    }

    /// Returns a flag of this column.
    ///
    /// # Errors
    /// Names the column, the number and what was expected.
    pub fn flag(&self, value: f64) -> Result<u8, Flaw> {
        match value {
            0.0 => Ok(0),
            1.0 => Ok(1),
            _ => Err(self.flaw(value)),
        }
    }

    fn flaw(&self, value: f64) -> Flaw {
        Flaw {
            problem: format!("{} is {value}", self.name),
            expected: self.expected,
        }
    }
}

/// Declares columns: name, least and greatest number, unit.
macro_rules! columns {
    ($($(#[$doc:meta])* $constant:ident = $name:literal, $least:literal, $most:literal, $unit:literal;)*) => {
        $(
            $(#[$doc])*
            pub const $constant: Column = Column {
                name: $name,
                least: $least,
                most: $most,
                expected: concat!("a finite number from ", $least, " to ", $most, $unit),
            };
        )*
    };
}

/// Declares a flag.
const fn flag(name: &'static str) -> Column {
    Column {
        name,
        least: 0.0,
        most: 1.0,
        expected: "0 or 1",
    }
}

/// The vehicle model holds.
pub const VALID: Column = flag("valid");
/// Nothing disagrees, as far as the whole run tells.
pub const CONSISTENT: Column = flag("consistent");
/// Nothing disagrees, as it was known after the lag.
pub const LAGGED_CONSISTENT: Column = flag("lagged_consistent");
/// Nothing disagrees, as it was known at the time.
pub const LIVE_CONSISTENT: Column = flag("live_consistent");

/// Latitude.
pub const LATITUDE_DEG: Column = Column {
    name: "latitude_deg",
    least: -90.0,
    most: 90.0,
    expected: "degrees within -90 and 90",
};
/// Longitude.
pub const LONGITUDE_DEG: Column = Column {
    name: "longitude_deg",
    least: -180.0,
    most: 180.0,
    expected: "degrees within -180 and 180",
};

columns! {
    /// Time of a log or since its first frame.
    TIME_S = "time_s", -4e9, 4e9, " s";
    /// Distance along a road or a way.
    DISTANCE_M = "distance_m", -1e7, 1e7, " m";
    /// Distance driven in a run: 40 million cells.
    DRIVEN_M = "distance_m", -1e8, 1e8, " m";
    /// Altitude, with room for the errors of a drifting receiver.
    ALTITUDE_M = "altitude_m", -20000.0, 20000.0, " m";
    /// Standard deviation of an altitude; not zero, which would have infinite weight.
    ALTITUDE_SIGMA_M = "altitude_sigma_m", 1e-6, 1e6, " m";
    /// Grade: 1000 % is 84 degrees.
    GRADE_PERCENT = "grade_percent", -1000.0, 1000.0, " %";
    /// Standard deviation of a grade; not zero.
    GRADE_SIGMA_PERCENT = "grade_sigma_percent", 1e-9, 1e6, " %";
    /// Grade after a fixed lag.
    LAGGED_GRADE_PERCENT = "lagged_grade_percent", -1000.0, 1000.0, " %";
    /// Its standard deviation.
    LAGGED_GRADE_SIGMA_PERCENT = "lagged_grade_sigma_percent", 1e-9, 1e6, " %";
    /// Causal grade.
    LIVE_GRADE_PERCENT = "live_grade_percent", -1000.0, 1000.0, " %";
    /// Its standard deviation.
    LIVE_GRADE_SIGMA_PERCENT = "live_grade_sigma_percent", 1e-9, 1e6, " %";
    /// Grade of a map at the place of the vehicle.
    MAP_GRADE_PERCENT = "map_grade_percent", -1000.0, 1000.0, " %";
    /// Its standard deviation.
    MAP_GRADE_SIGMA_PERCENT = "map_grade_sigma_percent", 1e-9, 1e6, " %";
    /// Speed. Smoothing may give a small negative one at a stop.
    SPEED_MPS = "speed_mps", -100.0, 200.0, " m/s";
    /// Bias of the vehicle model as grade.
    BIAS_PERCENT = "bias_percent", -1000.0, 1000.0, " %";
    /// True over modelled traction.
    SCALE = "scale", -1000.0, 1000.0, "";
    /// Gross mass.
    MASS_KG = "mass_kg", 0.0, 1e6, " kg";
    /// Its standard deviation; not zero.
    MASS_SIGMA_KG = "mass_sigma_kg", 1e-6, 1e6, " kg";
    /// Sum of the weights of a cell: runs over variances of 1e-10 %² and more.
    WEIGHT = "weight", -1e20, 1e20, " 1/%²";
    /// Sum of the squares of these weights.
    WEIGHT_SQUARE = "weight_square", -1e40, 1e40, " 1/%⁴";
    /// Weighted sum of grades.
    GRADE_SUM = "grade_sum", -1e23, 1e23, " 1/%";
    /// Weighted sum of squares of grades.
    GRADE_SQUARE_SUM = "grade_square_sum", -1e26, 1e26, "";
    /// Sum of the weights of altitudes.
    ALTITUDE_WEIGHT = "altitude_weight", -1e22, 1e22, " 1/m²";
    /// Weighted sum of altitudes.
    ALTITUDE_SUM = "altitude_sum", -1e27, 1e27, " 1/m";
}
