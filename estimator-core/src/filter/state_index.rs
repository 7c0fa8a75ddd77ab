//! The states of the filter, and what is indexed by them.
//!
//! To add a state, write its line in the list below and its answer in
//! [`StateIndex::survives_gap`]. The compiler then names what else it needs: its prior
//! (`prior.rs`) and its process noise (`process_noise.rs`). How it moves is in `dynamics.rs`, what
//! measurements see of it in `measurement.rs`; a state that neither mentions stays constant and
//! unseen.

use crate::scalar::Scalar;
use core::ops::{Index, IndexMut};
use nalgebra::SVector;

/// Declares the states: the names of the enum's variants and of [`PerState`]'s fields. The `$`
/// before the list is handed on to the macro that this one defines.
macro_rules! states {
    ($dollar:tt $($(#[$about:meta])* $variant:ident, $field:ident;)*) => {
        /// A state of the filter. Vectors and matrices are indexed by it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        pub enum StateIndex {
            $($(#[$about])* $variant,)*
        }

        impl StateIndex {
            /// Every state, in the order of vectors and matrices.
            pub const ALL: [Self; [$(stringify!($variant)),*].len()] = [$(Self::$variant,)*];
        }

        /// One value for each state. A state without a value does not compile.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct PerState<T> {
            $($(#[$about])* pub $field: T,)*
        }

        impl<T> PerState<T> {
            /// Returns the values in the order of [`StateIndex::ALL`].
            #[inline(always)]
            pub fn into_array(self) -> [T; STATES] {
                [$(self.$field,)*]
            }
        }

        /// Expands `$statement!(index)` for each state in turn, so that the compiler knows every
        /// index.
        macro_rules! for_each_state {
            ($dollar statement:ident) => {
                $($dollar statement!({ StateIndex::$variant as usize });)*
            };
        }
    };
}

states! {
    $
    /// Kinetic energy per kilogram, e = v²/2, m²/s².
    KineticEnergy, kinetic_energy;
    /// Altitude z above [`State::origin_m`](super::State::origin_m), m.
    Altitude, altitude;
    /// Slope s that the vehicle model reads at its nominal scale: sine of the slope angle, %. The
    /// slope of the road is this, less bias and wind, plus the scale error times the net traction
    /// ([`State::net_traction`](super::State::net_traction)).
    Slope, slope;
    /// Change r of [`StateIndex::Slope`] along the road, % per m.
    SlopeRate, slope_rate;
    /// Bias b: slope that the vehicle model reads too high for long, %. Its causes are tyres, shape
    /// and wrong parameters.
    Bias, bias;
    /// Wind w: slope that it reads too high for some kilometres, %. Its causes are wind and what
    /// else varies as fast.
    Wind, wind;
    /// Scale error κ: true over modelled traction per kilogram, less one.
    Scale, scale;
    /// Coloured error g of the GNSS altitude, m.
    GnssError, gnss_error;
}

pub(crate) use for_each_state;

/// Number of states.
pub const STATES: usize = StateIndex::ALL.len();

impl StateIndex {
    /// Returns whether what is known of the state outlasts a gap in the traffic.
    #[inline(always)]
    #[must_use]
    pub const fn survives_gap(self) -> bool {
        match self {
            Self::KineticEnergy | Self::Altitude | Self::Slope | Self::SlopeRate => false,
            Self::Bias | Self::Wind | Self::Scale | Self::GnssError => true,
        }
    }
}

/// A vector of the filter's size: means, gains, rows of a covariance, adjoints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateVector<S>(pub(crate) [S; STATES]);

impl<S: Scalar> StateVector<S> {
    /// The zero vector.
    pub const ZERO: Self = Self([S::ZERO; STATES]);

    /// Returns the elements in the order of [`StateIndex::ALL`].
    #[must_use]
    pub const fn as_array(&self) -> &[S; STATES] {
        &self.0
    }

    /// Returns the vector in nalgebra's type.
    #[must_use]
    pub fn to_nalgebra(&self) -> SVector<S, STATES>
    where
        S: nalgebra::Scalar,
    {
        SVector::from(self.0)
    }

    /// Returns the scalar product with another vector.
    #[inline(never)] // Long: every product is written out, in a dozen places of the smoother.
    #[must_use]
    pub(crate) fn dot(&self, other: &Self) -> S {
        S::dot(&self.0, &other.0)
    }

    /// Sets the states to zero that a gap ends.
    #[inline(always)]
    pub(crate) fn clear_after_gap(&mut self) {
        for (state, element) in StateIndex::ALL.iter().zip(&mut self.0) {
            if !state.survives_gap() {
                *element = S::ZERO;
            }
        }
    }
}

impl<S> Index<StateIndex> for StateVector<S> {
    type Output = S;

    #[inline(always)]
    fn index(&self, state: StateIndex) -> &S {
        &self.0[state as usize]
    }
}

impl<S> IndexMut<StateIndex> for StateVector<S> {
    #[inline(always)]
    fn index_mut(&mut self, state: StateIndex) -> &mut S {
        &mut self.0[state as usize]
    }
}
