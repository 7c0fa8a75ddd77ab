//! The modified method: corrections of mass and bias against a GPS-heavy estimate, and a second
//! estimate with less weight on GPS (thesis section 8.1).

use super::drive::{G, MeasuredDrive, Profile, STEP_M};
use super::original::{self, NoiseSigmas};
use super::pointwise;
use crate::numeric::robust_line::{RobustLine, fit};

/// Length over which errors are averaged before a line is fitted, m.
pub const SEGMENT_M: f64 = 3_000.0;

/// Result of the method.
#[derive(Clone, Debug)]
pub struct Modified {
    /// The second estimate.
    pub profile: Profile,
    /// Model error against GPS-heavy grade; `None` with too few segments.
    pub mass_line: Option<RobustLine>,
    /// Whether the slope passed the 2-sigma rule and the mass was corrected by 1 + slope.
    pub mass_corrected: bool,
    /// Model error in % against distance in m, after the mass correction.
    pub bias_line: Option<RobustLine>,
}

/// Runs the whole procedure.
#[must_use]
pub fn estimate(drive: &MeasuredDrive) -> Modified {
    estimate_with(drive, &NoiseSigmas::GPS_HEAVY, &NoiseSigmas::GPS_LIGHT)
}

/// Runs the procedure with other noise in the first and the second estimate.
#[must_use]
pub fn estimate_with(drive: &MeasuredDrive, first: &NoiseSigmas, second: &NoiseSigmas) -> Modified {
    let gps_heavy = original::estimate(drive, first).grade_percent;
    let mut corrected = drive.clone();

    // e_m = α_p − α_G as a line in α_G (eq. 10), and m_c = m (1 + k) (eq. 11).
    let segments = segments(drive, &pointwise::grade_percent(drive), &gps_heavy);
    let mass_line = fit(segments.iter().map(|s| (s.grade, s.error)));
    let mass_corrected = mass_line.is_some_and(|line| line.slope.abs() > 2.0 * line.slope_sigma);
    if let (true, Some(line)) = (mass_corrected, mass_line) {
        corrected.mass_kg *= 1.0 + line.slope;
    }

    // e = α'_p − α_G as a line in the distance (eq. 12), corrected through the torque.
    let segments = self::segments(
        &corrected,
        &pointwise::grade_percent(&corrected),
        &gps_heavy,
    );
    let bias_line = fit(segments.iter().map(|s| (s.distance, s.error)));
    if let Some(line) = bias_line {
        let weight = corrected.mass_kg * G;
        for (k, point) in corrected.points.iter_mut().enumerate() {
            point.traction_n -= weight * 0.01 * line.at(k as f64 * STEP_M);
        }
    }
    Modified {
        profile: original::estimate(&corrected, second),
        mass_line,
        mass_corrected,
        bias_line,
    }
}

/// Means over a segment.
#[derive(Clone, Copy, Debug)]
struct GradeSegment {
    /// Distance from the start of the drive to its middle, m.
    distance: f64,
    /// GPS-heavy grade, %.
    grade: f64,
    /// Pointwise less GPS-heavy grade, %.
    error: f64,
}

/// Returns means over the points where the vehicle model is valid. The thesis does not say that it
/// leaves the others out. But braking over a tenth of a segment makes the pointwise grade several
/// tenths of a percent too high, always downhill, and would change the slope of the line.
fn segments(drive: &MeasuredDrive, pointwise: &[f64], gps_heavy: &[f64]) -> Vec<GradeSegment> {
    let length = (SEGMENT_M / STEP_M) as usize;
    let segments = drive.points.len() / length;
    (0..segments)
        .filter_map(|segment| {
            let cells = segment * length..(segment + 1) * length;
            let valid: Vec<usize> = cells.filter(|&k| drive.points[k].is_valid()).collect();
            if valid.len() < length / 2 {
                return None;
            }
            let mean =
                |values: &[f64]| valid.iter().map(|&k| values[k]).sum::<f64>() / valid.len() as f64;
            Some(GradeSegment {
                distance: (segment as f64 + 0.5) * SEGMENT_M,
                grade: mean(gps_heavy),
                error: mean(pointwise) - mean(gps_heavy),
            })
        })
        .collect()
}
