//! Where the force of a column comes from.

use super::dependence::BasisFunction;
use super::drive::{LoggedDrive, RoadPlace};
use super::evidence::ForceColumn;
use estimator_core::VehicleParameters;
use estimator_core::effect::{Effect, ParameterValues};
use estimator_core::vehicle::GRAVITY;

/// The source of a column's force.
#[derive(Clone, Copy, Debug)]
pub(super) enum ColumnKind {
    /// An effect with these parameters.
    Effect(&'static Effect, ParameterValues),
    /// The same, on one drive only.
    OnDrive(&'static Effect, ParameterValues, usize),
    /// The weight on a piece of road of this length, m, in one direction or both.
    Piece(usize, f64, Option<bool>),
    /// No force: the unknown error of a sensor.
    SensorError,
    /// A thousandth of the weight times a function of a signal.
    Basis(BasisFunction),
}

impl ColumnKind {
    /// Returns the force in each cell of the drive of this number, N.
    pub(super) fn force(
        &self,
        vehicle: &VehicleParameters,
        number: usize,
        drive: &LoggedDrive,
        places: Option<&[Option<RoadPlace>]>,
    ) -> ForceColumn {
        let samples = &drive.samples;
        match self {
            Self::OnDrive(_, _, other) if *other != number => vec![0.0; samples.len()],
            Self::Effect(effect, details) | Self::OnDrive(effect, details, _) => samples
                .iter()
                .map(|sample| effect.derivative_n(vehicle, sample, details, 0.0))
                .collect(),
            Self::Piece(piece, piece_m, way) => samples
                .iter()
                .enumerate()
                .map(|(k, sample)| {
                    let place = places.and_then(|places| places[k]);
                    let here = place.is_some_and(|p| {
                        (p.at_m / piece_m) as usize == *piece
                            && way.is_none_or(|forward| p.forward == forward)
                    });
                    let weight_n = sample.forces.mass_kg * GRAVITY;
                    if here { weight_n } else { 0.0 }
                })
                .collect(),
            Self::SensorError => vec![0.0; samples.len()],
            Self::Basis(basis) => basis.column(drive),
        }
    }
}
