//! The creation of an estimator, on a host by value, on a controller in the memory that it stays in.

use super::{CellEstimator, Estimator};
use crate::context::Context;
use crate::intake::Intake;
use crate::model::Model;
use crate::persistent_state::{PersistentState, PersistentStateError, fingerprint};
use crate::sampler::Sampler;
use crate::scalar::Scalar;
use crate::tuning::Tuning;
use crate::vehicle::{ParameterError, Traction, VehicleParameters};
use core::mem::MaybeUninit;

impl<S: Scalar> Estimator<S> {
    /// Creates an estimator for a vehicle. The model is made of its parameters alone, or of its
    /// parameters and adopted effects ([`Model`]).
    ///
    /// The estimator takes some 96 kB, or 35 kB without the feature `window`. Where the stack is small,
    /// use [`new_in`](Self::new_in).
    ///
    /// # Errors
    /// The first parameter that no vehicle can have.
    #[allow(
        clippy::needless_pass_by_value,
        reason = "most callers have no further use for it"
    )]
    pub fn new(model: impl Into<Model>, tuning: Tuning) -> Result<Self, ParameterError> {
        let model = model.into();
        model.check()?;
        let mut estimator = Self::of(&tuning);
        estimator.drive_as(&model);
        Ok(estimator)
    }

    /// Creates an estimator in the memory that it stays in, for example a static one. Some 13 kB
    /// of it pass over the stack.
    ///
    /// ```
    /// use core::mem::MaybeUninit;
    /// use estimator_core::{Estimator, Traction, Tuning, VehicleParameters};
    /// # let vehicle = VehicleParameters {
    /// #     mass_kg: 19_000.0,
    /// #     drag_area_m2: 5.2,
    /// #     rolling_resistance: 0.008,
    /// #     wheel_radius_m: 0.48,
    /// #     wheel_inertia_kgm2: 60.0,
    /// #     traction: Traction::Force,
    /// # };
    /// // In an image: `static PLACE: StaticCell<Estimator<f32>>`, and `PLACE.uninit()`.
    /// let mut place = MaybeUninit::<Estimator<f32>>::uninit();
    /// let estimator = Estimator::new_in(&mut place, &vehicle.into(), &Tuning::default())?;
    /// assert!(estimator.live().is_none());
    /// # Ok::<(), estimator_core::ParameterError>(())
    /// ```
    ///
    /// # Errors
    /// The first parameter that no vehicle can have.
    pub fn new_in<'a>(
        place: &'a mut MaybeUninit<Self>,
        model: &Model,
        tuning: &Tuning,
    ) -> Result<&'a mut Self, ParameterError> {
        model.check()?;
        let estimator = Self::write(place, tuning);
        estimator.drive_as(model);
        Ok(estimator)
    }

    /// Creates an estimator that starts with what an earlier drive left.
    ///
    /// # Errors
    /// [`PersistentStateError::Parameter`] for a parameter that no vehicle can have,
    /// [`PersistentStateError::Vehicle`] if the drive was that of another vehicle, or was estimated
    /// with other parameters.
    pub fn restore(
        model: impl Into<Model>,
        tuning: Tuning,
        state: &PersistentState,
    ) -> Result<Self, PersistentStateError> {
        let mut estimator = Self::new(model, tuning)?;
        estimator.resume(state)?;
        Ok(estimator)
    }

    /// Starts with what an earlier drive left. To be called before the first input.
    ///
    /// # Errors
    /// [`PersistentStateError::Vehicle`] if the drive was that of another vehicle, or was estimated
    /// with other parameters. The estimator is unchanged then.
    pub fn resume(&mut self, state: &PersistentState) -> Result<(), PersistentStateError> {
        state.check_model(self.model())?;
        self.chain.resume(&self.context, state);
        self.sampler.resume(state.delays());
        Ok(())
    }

    #[inline(never)] // So that its stack and that of drive_as() are not in use at once.
    fn write<'a>(place: &'a mut MaybeUninit<Self>, tuning: &Tuning) -> &'a mut Self {
        place.write(Self::of(tuning))
    }

    /// Creates the estimator without a vehicle.
    #[inline(always)] // So that each field is written where it stays.
    fn of(tuning: &Tuning) -> Self {
        let no_vehicle = VehicleParameters {
            mass_kg: 0.0,
            drag_area_m2: 0.0,
            rolling_resistance: 0.0,
            wheel_radius_m: 0.0,
            wheel_inertia_kgm2: 0.0,
            traction: Traction::Force,
        };
        Self {
            context: Context::of(no_vehicle.into(), tuning.clone()),
            fingerprint: 0,
            intake: Intake::new(tuning),
            sampler: Sampler::new(),
            chain: CellEstimator::new(),
            sample: None,
        }
    }

    /// Sets the vehicle.
    #[inline(never)] // As write().
    fn drive_as(&mut self, model: &Model) {
        self.context.model = model.clone();
        self.fingerprint = fingerprint(model);
    }
}
