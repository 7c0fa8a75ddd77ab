//! The contenders, in the precision of the enclosing module.

use super::dense::{adskalman, kfilter, multicalc, plain_nalgebra};
use super::minikalman_filter::{minikalman_3, minikalman_5, minikalman_8};
use super::model::FilterMeter;
use super::ours::ours;
use crate::Contender;

/// Returns all filters. Peers of one size do the same work.
#[must_use]
pub fn contenders<M: FilterMeter>() -> Vec<Contender<M>> {
    let mut all = Vec::new();
    let mut add = |name, states, measure| {
        all.push(Contender {
            name,
            states,
            measure,
        });
    };
    add("ours", 8, |meter| ours(meter));
    add("nalgebra, by hand", 8, |meter| plain_nalgebra::<8>(meter));
    add("kfilter", 8, |meter| kfilter::<8>(meter));
    add("multicalc", 8, |meter| multicalc::<8>(meter));
    add("minikalman", 8, |meter| minikalman_8(meter));
    add("adskalman", 8, |meter| adskalman::<8>(meter));
    add("nalgebra, by hand", 5, |meter| plain_nalgebra::<5>(meter));
    add("kfilter", 5, |meter| kfilter::<5>(meter));
    add("multicalc", 5, |meter| multicalc::<5>(meter));
    add("minikalman", 5, |meter| minikalman_5(meter));
    add("adskalman", 5, |meter| adskalman::<5>(meter));
    add("nalgebra, by hand", 3, |meter| plain_nalgebra::<3>(meter));
    add("kfilter", 3, |meter| kfilter::<3>(meter));
    add("multicalc", 3, |meter| multicalc::<3>(meter));
    add("minikalman", 3, |meter| minikalman_3(meter));
    add("adskalman", 3, |meter| adskalman::<3>(meter));
    all
}
