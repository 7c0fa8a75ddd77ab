//! The tables `[effects.NAME]` of a vehicle file.

use estimator_core::effect::{self, CATALOGUE};
use estimator_core::{AdoptedEffect, AdoptedEffects, Effect};
use std::collections::BTreeMap;

/// Effect tables by name, then by key.
pub(super) type Tables = BTreeMap<String, BTreeMap<String, f32>>;

const AMOUNT: &str = "amount";
const AMOUNT_SIGMA: &str = "amount_sigma";

/// Creates the effects of these tables. The core checks their values.
///
/// # Errors
/// Returns an error that names each unknown effect, unknown key and missing key.
pub(super) fn from_tables(tables: &Tables) -> Result<AdoptedEffects, String> {
    let mut effects = AdoptedEffects::default();
    for (name, table) in tables {
        let effect = effect::named(name).ok_or_else(|| {
            let names = CATALOGUE.map(|effect| effect.name).join(", ");
            format!("effects.{name}: unknown effect; expected one of {names}")
        })?;
        effects
            .adopt(adopted(effect, table)?)
            .map_err(|_| format!("effects.{name}: too many effects"))?;
    }
    Ok(effects)
}

fn adopted(
    effect: &'static Effect,
    table: &BTreeMap<String, f32>,
) -> Result<AdoptedEffect, String> {
    let name = effect.name;
    let required = |key: &str| {
        let value = table.get(key).copied();
        value.ok_or_else(|| format!("effects.{name}.{key}: missing"))
    };
    let mut adopted = AdoptedEffect::new(effect, required(AMOUNT)?, required(AMOUNT_SIGMA)?);
    for (key, value) in table {
        if ![AMOUNT, AMOUNT_SIGMA].contains(&key.as_str()) && !adopted.set(key, *value) {
            let parameters = effect.parameters.iter().map(|parameter| parameter.key);
            let keys: Vec<_> = [AMOUNT, AMOUNT_SIGMA]
                .into_iter()
                .chain(parameters)
                .collect();
            let keys = keys.join(", ");
            return Err(format!(
                "effects.{name}.{key}: unknown key; expected one of {keys}"
            ));
        }
    }
    Ok(adopted)
}

/// Returns the tables of these effects.
pub(super) fn to_tables(effects: &AdoptedEffects) -> Tables {
    let table = |adopted: &AdoptedEffect| {
        let amount = [
            (AMOUNT, adopted.amount),
            (AMOUNT_SIGMA, adopted.amount_sigma),
        ];
        let numbers = amount.into_iter().chain(adopted.given_parameters());
        numbers
            .map(|(key, value)| (key.to_owned(), value))
            .collect()
    };
    effects
        .iter()
        .map(|adopted| (adopted.effect.name.to_owned(), table(adopted)))
        .collect()
}
