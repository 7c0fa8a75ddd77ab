//! minikalman: its buffers have their sizes from macros, so this is one as well.

/// Reports a minikalman filter of this many states.
#[macro_export]
macro_rules! minikalman {
    ($states:expr) => {{
        use minikalman::prelude::*;
        use minikalman::regular::{RegularKalmanBuilder, RegularObservationBuilder};
        use minikalman::*;

        const N: usize = $states;
        let model = $crate::Model::<N>::new();
        impl_buffer_A!(mut transition, N, f32, 0.0);
        impl_buffer_x!(mut state, N, f32, 0.0);
        impl_buffer_P!(mut covariance, N, f32, 0.0);
        impl_buffer_Q_direct!(mut step_noise, N, f32, 0.0);
        impl_buffer_temp_x!(mut temporary_state, N, f32, 0.0);
        impl_buffer_temp_P!(mut temporary_covariance, N, f32, 0.0);
        impl_buffer_z!(mut z, 2, f32, 0.0);
        impl_buffer_H!(mut measured, 2, N, f32, 0.0);
        impl_buffer_R!(mut noise, 2, f32, 0.0);
        impl_buffer_y!(mut y, 2, f32, 0.0);
        impl_buffer_S!(mut s, 2, f32, 0.0);
        impl_buffer_K!(mut k, N, 2, f32, 0.0);
        impl_buffer_temp_S_inv!(mut s_inverse, 2, f32, 0.0);
        impl_buffer_temp_HP!(mut hp, 2, N, f32, 0.0);
        impl_buffer_temp_PHt!(mut pht, N, 2, f32, 0.0);
        impl_buffer_temp_KHP!(mut khp, N, f32, 0.0);
        $crate::minikalman_filter::fill(&mut transition, &model.transition);
        $crate::minikalman_filter::fill(&mut covariance, &model.covariance);
        $crate::minikalman_filter::fill(&mut step_noise, &model.step_noise);
        $crate::minikalman_filter::fill(&mut measured, &model.measured);
        $crate::minikalman_filter::fill(&mut noise, &model.noise);
        let mut filter = RegularKalmanBuilder::new::<N, f32>(
            transition,
            state,
            covariance,
            step_noise,
            temporary_state,
            temporary_covariance,
        );
        let mut measurement = RegularObservationBuilder::new::<N, 2, f32>(
            measured, z, noise, y, s, k, s_inverse, hp, pht, khp,
        );
        let bytes = size_of_val(&filter) + size_of_val(&measurement);
        $crate::report::<N>(bytes, |both| {
            filter.predict();
            measurement.measurement_vector_mut().apply(|vector| {
                vector[0] = both[0];
                vector[1] = both[1];
            });
            filter.correct(&mut measurement);
            let state = filter.state_vector();
            core::array::from_fn(|i| state[i])
        });
    }};
}

/// Fills a matrix from its rows.
pub fn fill<const R: usize, const C: usize>(
    matrix: &mut impl minikalman::prelude::MatrixMut<R, C, f32>,
    rows: &[[f32; C]; R],
) {
    for (i, row) in rows.iter().enumerate() {
        for (j, element) in row.iter().enumerate() {
            matrix.set_at(i, j, *element);
        }
    }
}
