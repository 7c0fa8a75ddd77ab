//! Words for what disagrees.

use estimator_core::Disagreement;

/// Words for each kind of disagreement, in the order of [`Disagreement::kinds`].
pub const WORDS: [&str; Disagreement::KINDS] = [
    "climb by GNSS against climb by the forces",
    "a descent by GNSS without the speed that it should give: a brake that no signal reports",
    "torque against acceleration or climb, or not from the engine",
    "wheel speed against engine speed, or from two senders",
    "reported gear against engine and wheel speed",
];

/// Returns the words for what disagrees.
pub fn words_of(disagreement: Disagreement) -> Vec<&'static str> {
    let kinds = WORDS.into_iter().zip(disagreement.kinds());
    kinds
        .filter_map(|(words, is_present)| is_present.then_some(words))
        .collect()
}
