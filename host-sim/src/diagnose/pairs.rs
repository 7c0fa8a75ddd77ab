//! Pairs of effects that together explain what neither explains alone.

use super::case::CandidateFit;
use super::fitter::Fitter;
use super::rivals::{ADOPTED, CONTRADICTED, SEPARATED, is_asked_for};

/// Number of pairs, the best by a quick look, that are fitted in full.
const FITTED: usize = 6;

/// Two candidates, each fitted beside the other.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    /// Their cases, each given the other.
    pub(super) cases: [CandidateFit; 2],
    /// The case of the first one without the other.
    alone: CandidateFit,
}

impl Pair {
    /// Returns the scatter of the case that scatters more.
    pub(super) fn scatter(&self) -> f64 {
        self.cases[1].scatter.max(self.alone.scatter)
    }

    /// Returns the joint evidence for a common scatter.
    pub(super) fn evidence_at(&self, scatter: f64) -> f64 {
        self.alone.evidence_at(scatter) + self.cases[1].evidence_at(scatter)
    }
}

/// What a pair is to one candidate that is adopted.
pub(super) enum Instead {
    /// It is much better.
    Better,
    /// The drives cannot separate them.
    AsGood,
    /// It is worse.
    Worse,
}

impl Pair {
    /// Returns what the pair is to one candidate, of so many.
    pub(super) fn instead_of(&self, own: &CandidateFit, candidates: usize) -> Instead {
        let scatter = self.scatter().max(own.scatter);
        let more = self.evidence_at(scatter) - own.evidence_at(scatter);
        // Of so many candidates there are so many times more pairs.
        let price = 2.0 * (0.5 * (candidates as f64 - 1.0)).max(1.0).ln();
        if more - price >= ADOPTED {
            Instead::Better
        } else if more >= -SEPARATED {
            Instead::AsGood
        } else {
            Instead::Worse
        }
    }
}

/// Returns the best pair that the evidence asks for, each given the other; none if there is no
/// such pair. `cases` are those of each candidate alone, beside the adopted ones.
pub(super) fn best(
    fitter: &Fitter<'_>,
    adopted: &[&CandidateFit],
    cases: &[CandidateFit],
) -> Option<Pair> {
    let count = cases.len() * cases.len().saturating_sub(1) / 2;
    let price = 2.0 * (count.max(1) as f64).ln();
    let joint = |pair: &Pair| pair.evidence_at(pair.scatter());
    fitted(fitter, adopted, cases)
        .into_iter()
        .filter(|pair| joint(pair) - price >= ADOPTED)
        .max_by(|a, b| joint(a).total_cmp(&joint(b)))
}

/// Returns the most likely pairs of which each is asked for, given the other.
pub(super) fn fitted(
    fitter: &Fitter<'_>,
    adopted: &[&CandidateFit],
    cases: &[CandidateFit],
) -> Vec<Pair> {
    quick_look(fitter, adopted, cases)
        .into_iter()
        .take(FITTED)
        .filter_map(|(one, other)| fit(fitter, adopted, one, other))
        .collect()
}

/// Returns all pairs by their joint evidence, the best first, with the choices that each takes
/// alone.
fn quick_look<'c>(
    fitter: &Fitter<'_>,
    adopted: &[&CandidateFit],
    cases: &'c [CandidateFit],
) -> Vec<(&'c CandidateFit, &'c CandidateFit)> {
    let typical = |case: &CandidateFit| fitter.menu.candidates[case.candidate].typical;
    let is_simple = |case: &&CandidateFit| !case.choice.is_cycle();
    let basis = fitter.basis(adopted);
    let simple: Vec<&CandidateFit> = cases.iter().filter(is_simple).collect();
    let mut found = Vec::new();
    for (index, one) in simple.iter().enumerate() {
        let with_one = basis.with(&one.choice.amounts, typical(one));
        for other in &simple[index + 1..] {
            let both = with_one.with(&other.choice.amounts, typical(other));
            if let Some(joint) = fitter.regression.bayes(&both, 1.0) {
                found.push((joint, (*one, *other)));
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().map(|(_, pair)| pair).collect()
}

/// Fits a pair, each with the choice that is best given the other; `None` if one of them is not
/// asked for then.
fn fit(
    fitter: &Fitter<'_>,
    adopted: &[&CandidateFit],
    one: &CandidateFit,
    other: &CandidateFit,
) -> Option<Pair> {
    let beside = |case: &CandidateFit, candidate: usize| {
        let mut adopted = adopted.to_vec();
        adopted.push(case);
        fitter.case(&adopted, candidate)
    };
    let second = beside(one, other.candidate)?;
    let first = beside(&second, one.candidate)?;
    let second = beside(&first, other.candidate)?;
    let held_out = one.held_out + second.held_out;
    let asked = |case: &CandidateFit| is_asked_for(case, fitter.menu);
    (asked(&first) && asked(&second) && held_out > CONTRADICTED).then(|| Pair {
        alone: one.clone(),
        cases: [first, second],
    })
}
