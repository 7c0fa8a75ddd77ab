//! The grade Kalman filter whose variances are inferred ([`inference`](crate::inference)).
//!
//! It is linear, in the distance domain, one step a cell. F is a handful of shears, each measurement
//! a scalar.
//!
//! | file | content |
//! |---|---|
//! | [`state_index`], [`covariance`] | the states; a symmetric matrix over them |
//! | [`dynamics`], [`noise`] | F; the directions in which noise enters |
//! | [`cell_input`], [`vehicle_cells`] | what is known of a cell; how a sample becomes one |
//! | [`measurement`] | the update with each measurement, and what it left |
//! | [`state`], [`prior`] | the forward step: predict, observe; where a drive or a part of it begins |
//! | `body_sensor`, `late_traction` | accelerometer and pitch beside the force balance; a force that is late |
//! | `low_pass`, `receiver_low_pass` | a low-pass; that of a receiver that smooths its altitudes |
//! | `slow_states` | what belongs to the vehicle, and is kept between drives |
//! | `effect_uncertainty`, `gross_mass` | force and uncertainty of adopted effects; the mass that follows from the scale |
//! | `response` | how the filter answers a part of the model that is missing |
//! | [`adjoint`] | the backward step: smoothed quantities, and the scores of the noises |

pub mod adjoint;
mod body_sensor;
pub mod cell_input;
pub mod covariance;
mod doubt_behind;
pub mod dynamics;
mod effect_uncertainty;
mod gross_mass;
mod late_traction;
mod low_pass;
pub mod measurement;
pub mod noise;
pub mod prior;
mod receiver_low_pass;
mod response;
mod slow_states;
pub mod state;
pub mod state_index;
pub mod vehicle_cells;

pub use adjoint::{Adjoint, Disturbances};
pub use cell_input::{CellInput, Marks, Reading};
pub use covariance::{Covariance, StateVector};
pub use doubt_behind::DoubtBehind;
pub use dynamics::Dynamics;
pub use effect_uncertainty::{EffectContribution, EffectUncertainty};
pub use gross_mass::ModelMass;
pub use measurement::{Measurand, Measurement, Update};
pub use noise::{CellNoise, NOISES, Noise, Score};
pub use slow_states::{SlowState, SlowStates, initial_state};
pub use state::{Moments, Quantity, Record, State};
pub use state_index::{STATES, StateIndex};
pub use vehicle_cells::VehicleCells;
