//! minikalman. Macros give its buffers their sizes, so the filter is made by a macro, too.

use super::Real;
use super::model::{FilterMeter, LinearModel};
use minikalman::prelude::*;
use minikalman::regular::{RegularKalmanBuilder, RegularObservationBuilder};

macro_rules! minikalman {
    ($name:ident, $states:expr) => {
        /// Measures a filter of this many states.
        pub fn $name(meter: &mut impl FilterMeter) {
            const N: usize = $states;
            let model = LinearModel::<N>::new();
            impl_buffer_A!(mut transition, N, Real, 0.0);
            impl_buffer_x!(mut state, N, Real, 0.0);
            impl_buffer_P!(mut covariance, N, Real, 0.0);
            impl_buffer_Q_direct!(mut step_noise, N, Real, 0.0);
            impl_buffer_temp_x!(mut temporary_state, N, Real, 0.0);
            impl_buffer_temp_P!(mut temporary_covariance, N, Real, 0.0);
            impl_buffer_z!(mut z, 2, Real, 0.0);
            impl_buffer_H!(mut measured, 2, N, Real, 0.0);
            impl_buffer_R!(mut noise, 2, Real, 0.0);
            impl_buffer_y!(mut y, 2, Real, 0.0);
            impl_buffer_S!(mut s, 2, Real, 0.0);
            impl_buffer_K!(mut k, N, 2, Real, 0.0);
            impl_buffer_temp_S_inv!(mut s_inverse, 2, Real, 0.0);
            impl_buffer_temp_HP!(mut hp, 2, N, Real, 0.0);
            impl_buffer_temp_PHt!(mut pht, N, 2, Real, 0.0);
            impl_buffer_temp_KHP!(mut khp, N, Real, 0.0);
            fill(&mut transition, &model.transition);
            fill(&mut covariance, &model.covariance);
            fill(&mut step_noise, &model.step_noise);
            fill(&mut measured, &model.measured);
            fill(&mut noise, &model.noise);
            let mut filter = RegularKalmanBuilder::new::<N, Real>(
                transition,
                state,
                covariance,
                step_noise,
                temporary_state,
                temporary_covariance,
            );
            let mut measurement = RegularObservationBuilder::new::<N, 2, Real>(
                measured, z, noise, y, s, k, s_inverse, hp, pht, khp,
            );
            let bytes = size_of_val(&filter) + size_of_val(&measurement);
            meter.measure::<N>(bytes, |both| {
                filter.predict();
                measurement.measurement_vector_mut().apply(|vector| {
                    vector[0] = both[0];
                    vector[1] = both[1];
                });
                filter.correct(&mut measurement);
                let state = filter.state_vector();
                core::array::from_fn(|i| state[i])
            });
        }
    };
}

minikalman!(minikalman_3, 3);
minikalman!(minikalman_5, 5);
minikalman!(minikalman_8, 8);

/// Fills a matrix from its rows.
fn fill<const R: usize, const C: usize>(
    matrix: &mut impl minikalman::prelude::MatrixMut<R, C, Real>,
    rows: &[[Real; C]; R],
) {
    for (i, row) in rows.iter().enumerate() {
        for (j, element) in row.iter().enumerate() {
            matrix.set_at(i, j, *element);
        }
    }
}
