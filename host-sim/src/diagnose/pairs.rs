//! Pairs of effects that together explain what neither explains alone.

use super::case::CandidateFit;
use super::rivals::{ADOPTED, CONTRADICTED, SelectionStep, is_asked_for};
use super::selection::Selector;

/// Number of pairs, the best by a quick look, that are fitted in full.
const FITTED: usize = 6;

/// Returns the best pair that the evidence asks for, each given the other; none if there is no
/// such pair. `cases` are those of each candidate alone, beside the effects adopted.
pub(super) fn best(
    selector: &Selector<'_>,
    steps: &[SelectionStep],
    cases: &[CandidateFit],
) -> Vec<SelectionStep> {
    let pairs = cases.len() * cases.len().saturating_sub(1) / 2;
    let price = 2.0 * (pairs.max(1) as f64).ln();
    quick_look(selector, steps, cases)
        .into_iter()
        .take(FITTED)
        .filter_map(|(one, other)| fitted(selector, steps, one, other))
        .filter(|(joint, _)| joint - price >= ADOPTED)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or_else(Vec::new, |(_, pair)| pair)
}

/// Returns the pairs whose joint evidence with the choices that each takes alone is more than what
/// both have alone, the best first.
fn quick_look<'c>(
    selector: &Selector<'_>,
    steps: &[SelectionStep],
    cases: &'c [CandidateFit],
) -> Vec<(&'c CandidateFit, &'c CandidateFit)> {
    let menu = selector.menu;
    let is_simple = |case: &&CandidateFit| !case.choice.is_cycle();
    let typical = |case: &CandidateFit| menu.candidates[case.candidate].typical;
    let basis = super::selection::basis(steps);
    let mut found = Vec::new();
    for (index, one) in cases.iter().enumerate().filter(|(_, case)| is_simple(case)) {
        let with_one = basis.with(&one.choice.amounts, typical(one));
        for other in cases[index + 1..].iter().filter(is_simple) {
            let both = with_one.with(&other.choice.amounts, typical(other));
            if let Some(joint) = selector.regression.bayes(&both, 1.0) {
                found.push((joint, (one, other)));
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().map(|(_, pair)| pair).collect()
}

/// Returns the joint evidence of a pair, each with the choice that is best given the other, and its
/// steps; `None` if one of them is not asked for.
fn fitted(
    selector: &Selector<'_>,
    steps: &[SelectionStep],
    one: &CandidateFit,
    other: &CandidateFit,
) -> Option<(f64, Vec<SelectionStep>)> {
    let beside = |case: &CandidateFit, candidate: usize| {
        let mut steps = steps.to_vec();
        steps.push(SelectionStep {
            adopted: case.clone(),
            group: Vec::new(),
        });
        let ground = selector.ground(&steps)?;
        selector.case(&ground, candidate)
    };
    let second = beside(one, other.candidate)?;
    let first = beside(&second, one.candidate)?;
    let second = beside(&first, other.candidate)?;
    let asked = |case: &CandidateFit| is_asked_for(case, selector.menu);
    // Alone beside what is adopted, with the width of its prior as in the pair.
    let joint = (one.evidence + second.evidence).min(other.evidence + first.evidence);
    let held_out = one.held_out + second.held_out;
    (asked(&first) && asked(&second) && held_out > CONTRADICTED).then(|| {
        let step = |adopted: CandidateFit| SelectionStep {
            group: Vec::new(),
            adopted,
        };
        (joint, vec![step(first), step(second)])
    })
}
