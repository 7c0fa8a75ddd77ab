//! The filter with inferred variances: against dense matrices, against numerical derivatives of its
//! likelihood, and on drives whose variances are known.

mod cells;
mod dense;
mod drives;
mod likelihood;
mod measurements;
mod window;
