//! The grade Kalman filter: a linear filter in the distance domain.
//!
//! One step is one cell. With e = v²/2 as the speed state and the sine of the slope as the grade
//! state, the force balance (thesis eq. 9), climb and every measurement are linear, so no
//! Jacobian is approximated and no division by a small speed arises. The transition is a few
//! shears, each measurement a scalar.
//!
//! * [`state`]: which states there are, and an estimate read from them;
//! * [`covariance`]: a packed symmetric matrix and what a filter does to one;
//! * [`motion`]: how the states move over a cell; [`transition`]: that, with the noise, in numbers
//!   of the vehicle;
//! * [`update`]: one scalar measurement;
//! * [`step`]: the filter, which a sample moves over one cell;
//! * `gate`: which altitudes to believe; `climb`: theirs against the model's; `learned`: how noisy
//!   the sensors are;
//! * `doubt`: what is not sure of adopted effects;
//! * [`prior`]: what is believed where a drive begins; `far_scale`: a vehicle far from that;
//! * [`record`]: what a step leaves for smoothing;
//! * [`backward`]: the smoothing recursion over them.

pub mod backward;
mod climb;
pub mod covariance;
mod doubt;
mod far_scale;
mod gate;
mod learned;
pub mod motion;
pub mod prior;
pub mod record;
pub mod state;
pub mod step;
pub mod transition;
pub mod update;

pub use backward::{Backward, Passage};
pub use covariance::Covariance;
pub use doubt::Felt;
pub use gate::AltitudeEvent;
pub use learned::SensorNoise;
pub use prior::SlowStates;
pub use record::{Moved, Record, Trace};
pub use state::{Look, Quantity, STATES, State};
pub use step::Filter;
