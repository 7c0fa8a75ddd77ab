//! What is assumed where a drive begins, and where it goes on after a gap.

use super::cell_input::CellInput;
use super::noise::CellNoise;
use super::state::{Record, State};
use super::state_index::StateIndex::{
    self, Altitude, Bias, KineticEnergy, Retarder, Scale, Slope, SlopeRate, TyreSlip, Wind,
};
use crate::scalar::Scalar;
use crate::tuning::Numbers;

impl<S: Scalar> State<S> {
    /// Returns the state before the first cell of a drive. `cold_tyres_percent` is the sigma of what
    /// cold tyres add to the resistance. The states that a gap ends are zero: the first cell sets them.
    #[must_use]
    pub fn at_start(numbers: &Numbers, cell: &CellInput, cold_tyres_percent: f32) -> Self {
        let square = |sigma: f32| S::from_f32(sigma * sigma);
        let mut state = Self::ZERO;
        let cold = cold_tyres_percent * cold_tyres_percent;
        for (index, variance) in [
            (Bias, S::from_f32(cell.bias_variance + cold)),
            (Wind, S::from_f32(cell.wind_variance)),
            (Scale, square(numbers.prior_scale)),
            (StateIndex::SlowGnssError, square(numbers.slow_gnss_noise_m)),
            (StateIndex::FastGnssError, square(numbers.fast_gnss_noise_m)),
            (TyreSlip, square(numbers.prior_tyre_slip)),
            (Retarder, square(numbers.prior_retarder)),
        ] {
            state.covariance.add(index, index, variance);
        }
        state
    }

    /// Moves into the first cell of a drive or the first one behind a gap, and leaves its record: speed,
    /// slope and altitude start anew, the slow states stay. `road_level` is the learned over the assumed
    /// variance of the road.
    pub fn start(
        &mut self,
        numbers: &Numbers,
        cell: &CellInput,
        noise: &CellNoise<S>,
        road_level: f32,
        gate: Option<S>,
        record: &mut Record<S>,
    ) {
        record.net_traction_before = self.net_traction;
        let altitude = self.mean[Altitude as usize];
        for index in StateIndex::ENDED_BY_GAP {
            self.mean[index as usize] = S::ZERO;
            self.covariance.clear(index);
        }
        // Who has slept may have been loaded.
        self.covariance.add(Scale, Scale, noise.load);
        let energy = if cell.energy.is_some() {
            cell.energy.value
        } else {
            0.5 * cell.speed_mps * cell.speed_mps
        };
        let energy_sigma = Scalar::max(1.0, cell.speed_mps);
        let square = |sigma: f32| S::from_f32(sigma * sigma);
        self.mean[KineticEnergy as usize] = S::from_f32(energy);
        self.mean[Altitude as usize] = if cell.altitude.is_some() {
            S::from_f32(cell.altitude.value)
        } else {
            altitude
        };
        // The slope that is read contains bias and wind.
        self.mean[Slope as usize] = self.mean[Bias as usize] + self.mean[Wind as usize];
        let p = &mut self.covariance;
        p.add(KineticEnergy, KineticEnergy, square(energy_sigma));
        p.add(Altitude, Altitude, square(numbers.switched_gnss_noise_m));
        p.add(Slope, Slope, square(numbers.prior_slope_percent));
        p.shear(Slope, Bias, S::ONE);
        p.shear(Slope, Wind, S::ONE);
        let rate = square(numbers.slope_rate_noise) * S::from_f32(road_level);
        p.add(SlopeRate, SlopeRate, rate);
        self.net_traction = S::from_f32(cell.net_traction_percent);
        self.retarder = S::from_f32(cell.retarder_percent);
        let energy = self.mean[KineticEnergy as usize];
        self.observe(cell, noise, energy, gate, record);
    }
}
