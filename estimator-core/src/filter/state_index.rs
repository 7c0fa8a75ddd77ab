//! The states of the filter. Vectors and matrices are indexed by them.

/// A state of the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StateIndex {
    /// Kinetic energy per kilogram, e = v²/2, m²/s².
    KineticEnergy,
    /// Altitude z above the first fix, m.
    Altitude,
    /// Slope s that the vehicle model reads at its nominal scale: sine of the slope angle, %.
    Slope,
    /// Change r of the slope along the road, % per m.
    SlopeRate,
    /// Bias b: slope that the model reads too high for long, %.
    Bias,
    /// Wind w: slope that it reads too high for some kilometres, %.
    Wind,
    /// Scale error κ: true over modelled traction per kilogram, less one.
    Scale,
    /// Slow error g₁ of the GNSS altitude, m.
    SlowGnssError,
    /// Fast error g₂ of the GNSS altitude, m.
    FastGnssError,
    /// Doubtful force u: slope that the model reads too high where its force is in doubt, %. It is
    /// zero elsewhere.
    DoubtfulForce,
    /// Slip c of the driven tyres: fraction by which they turn faster, over traction per weight.
    TyreSlip,
    /// Error ρ of the retarder's factor: true over modelled force, less one.
    Retarder,
}

/// Number of states.
pub const STATES: usize = 12;

impl StateIndex {
    /// Every state, in the order of vectors and matrices.
    pub const ALL: [Self; STATES] = [
        Self::KineticEnergy,
        Self::Altitude,
        Self::Slope,
        Self::SlopeRate,
        Self::Bias,
        Self::Wind,
        Self::Scale,
        Self::SlowGnssError,
        Self::FastGnssError,
        Self::DoubtfulForce,
        Self::TyreSlip,
        Self::Retarder,
    ];

    /// States of which nothing is left after a gap in the traffic.
    pub const ENDED_BY_GAP: [Self; 5] = [
        Self::KineticEnergy,
        Self::Altitude,
        Self::Slope,
        Self::SlopeRate,
        Self::DoubtfulForce,
    ];
}
