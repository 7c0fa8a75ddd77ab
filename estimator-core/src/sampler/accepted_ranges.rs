//! The ranges of readings that are accepted. Readings outside them are treated as not available.

use core::ops::{Range, RangeInclusive};

/// Speeds of road vehicles, m/s.
pub(super) const SPEEDS_MPS: RangeInclusive<f32> = 0.0..=70.0;
/// Altitudes of roads, m.
pub(super) const ALTITUDES_M: Range<f32> = -1_000.0..10_000.0;
/// Yaw rates of road vehicles, rad/s.
pub(super) const YAW_RATES_RADPS: RangeInclusive<f32> = -2.0..=2.0;
/// Longitudinal accelerations of road vehicles on any slope, m/s².
pub(super) const ACCELERATIONS_MPS2: RangeInclusive<f32> = -20.0..=20.0;
/// Vertical speeds of road vehicles, m/s.
pub(super) const VERTICAL_SPEEDS_MPS: RangeInclusive<f32> = -20.0..=20.0;
/// Pitches of a body on any road, with the tilt of its sensor, °.
pub(super) const PITCHES_DEG: RangeInclusive<f32> = -45.0..=45.0;
/// Courses over ground, °.
pub(super) const COURSES_DEG: RangeInclusive<f32> = 0.0..=360.0;
/// Reference torques of engines (SPN 544), Nm.
pub(super) const REFERENCE_TORQUES_NM: RangeInclusive<f32> = 10.0..=10_000.0;
/// Moments of inertia of engines (SPN 1794), kg m².
pub(super) const ENGINE_INERTIAS_KGM2: RangeInclusive<f32> = 0.01..=50.0;
/// Fan drive, %.
pub(super) const FANS_PERCENT: RangeInclusive<f32> = 0.0..=100.0;
