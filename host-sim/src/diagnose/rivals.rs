//! Which candidate is adopted, and which ones the drives cannot separate from it.

use super::candidates::Menu;
use super::case::CandidateFit;
use estimator_core::effect::search_of;
use std::cmp::Ordering;

/// An effect is adopted from this evidence on: twice the logarithm of its odds against no effect,
/// corrected for the number of candidates.
pub const ADOPTED: f64 = 3.0;
/// Candidates whose evidence is within this of the best cannot be separated from it: 20 to 1.
pub(super) const SEPARATED: f64 = 6.0;
/// A parameter of the base model is preferred if other candidates are better by at most this.
const PREFERENCE: f64 = 2.0;
/// Smallest gain on the drives held out, twice the log likelihood, of what they do not contradict.
pub(super) const CONTRADICTED: f64 = -1.0;

/// One step of the selection: the adopted candidate and its rivals.
#[derive(Clone, Debug)]
pub struct SelectionStep {
    /// The adopted candidate.
    pub adopted: CandidateFit,
    /// Other candidates that the data cannot separate from it.
    pub group: Vec<CandidateFit>,
    /// Pairs of others that the data cannot separate from it.
    pub pairs: Vec<[usize; 2]>,
}

impl From<CandidateFit> for SelectionStep {
    /// Creates a step without rivals.
    fn from(adopted: CandidateFit) -> Self {
        Self {
            adopted,
            group: Vec::new(),
            pairs: Vec::new(),
        }
    }
}

impl SelectionStep {
    /// Exchanges the adopted candidate for another of the group.
    pub(super) fn lead(&mut self, candidate: usize) {
        let same = |case: &CandidateFit| case.candidate == candidate;
        if let Some(index) = self.group.iter().position(same) {
            std::mem::swap(&mut self.adopted, &mut self.group[index]);
        }
    }
}

/// Returns what a choice among the candidates of a menu costs, as twice a logarithm.
pub(super) fn price(menu: &Menu) -> f64 {
    2.0 * (menu.candidates.len() as f64).ln()
}

/// Returns whether the evidence of a case is enough to adopt it.
pub(super) fn is_asked_for(case: &CandidateFit, menu: &Menu) -> bool {
    case.evidence - price(menu) >= ADOPTED && case.held_out > CONTRADICTED && case.is_possible(menu)
}

/// Returns the step that the cases justify, if any.
pub(super) fn step(cases: &[CandidateFit], menu: &Menu) -> Option<SelectionStep> {
    let asked = |case: &&CandidateFit| is_asked_for(case, menu);
    let best = cases
        .iter()
        .filter(asked)
        .max_by(by(|case| case.evidence_at(1.0)))?;
    let rivals: Vec<&CandidateFit> = cases
        .iter()
        .filter(|case| is_rival(case, best) && case.is_possible(menu))
        .collect();
    // Among candidates that the fitted drives cannot separate, the drives held out decide. If they
    // do not either, a parameter of the base model comes first.
    let scatter = rivals.iter().map(|case| case.scatter).fold(1.0, f64::max);
    let merit = |case: &CandidateFit| {
        let effect = menu.candidates[case.candidate].effect;
        let is_base = effect
            .and_then(search_of)
            .is_some_and(|search| search.is_base_parameter);
        case.evidence_at(scatter) + case.held_out + if is_base { PREFERENCE } else { 0.0 }
    };
    let adopted = *rivals
        .iter()
        .filter(|case| asked(case))
        .max_by(|a, b| merit(a).total_cmp(&merit(b)))?;
    Some(SelectionStep {
        adopted: adopted.clone(),
        group: rivals
            .iter()
            .filter(|case| case.candidate != adopted.candidate)
            .map(|&case| case.clone())
            .collect(),
        pairs: Vec::new(),
    })
}

/// Returns the candidates that the drives cannot separate from an adopted one.
pub(super) fn group(
    adopted: &CandidateFit,
    cases: &[CandidateFit],
    menu: &Menu,
) -> Vec<CandidateFit> {
    let others = cases
        .iter()
        .filter(|case| case.candidate != adopted.candidate);
    others
        .filter(|case| is_rival(case, adopted) && case.is_possible(menu))
        .cloned()
        .collect()
}

/// Returns whether the drives cannot separate a case from the best one: its evidence is close to
/// the best, or its gain without the prior is.
fn is_rival(case: &CandidateFit, best: &CandidateFit) -> bool {
    let scatter = best.scatter.max(case.scatter);
    let is_usual = |amount: &f64| amount.abs() <= 1.5 * case.width;
    let fits_as_well = best.evidence_at(scatter) - case.evidence_at(scatter) <= SEPARATED
        || (best.gain_at(scatter) - case.gain_at(scatter) <= SEPARATED
            && case.amounts.len() <= best.amounts.len()
            && case.amounts.iter().all(is_usual));
    // A case that is less likely than no effect is no rival.
    fits_as_well && case.evidence > 0.0
}

fn by(value: impl Fn(&CandidateFit) -> f64) -> impl Fn(&&CandidateFit, &&CandidateFit) -> Ordering {
    move |a, b| value(a).total_cmp(&value(b))
}
