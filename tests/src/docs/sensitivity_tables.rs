//! What numbers and mechanisms of the estimator are worth, as committed.

use super::pipe_table::pipe_table;
use crate::sensitivity::{mechanisms, numbers};
use host_sim::error::Result;

/// What was not measured.
const NONE: &str = "—";

/// Returns what gives the cost of a number by its key: of smoothed, lagged and live errors, and of NEES.
pub fn costs() -> Result<impl Fn(&str) -> String> {
    let rows = numbers::committed()?;
    Ok(move |key: &str| {
        let row = rows.iter().find(|row| row.key == key);
        row.map_or(NONE.to_owned(), |row| row.worse().line())
    })
}

/// Makes the table of mechanisms, with the changes where each is off.
pub fn without_mechanisms() -> Result<Option<String>> {
    let committed = mechanisms::committed()?;
    let rows = mechanisms::MECHANISMS.iter().map(|mechanism| {
        let row = committed.iter().find(|row| row.is_of(mechanism));
        let words = row.map(|row| row.change().words());
        let [smoothed, lagged, live, nees] =
            words.unwrap_or_else(|| std::array::from_fn(|_| NONE.to_owned()));
        let settings = mechanism.settings().replace("; ", "`, `");
        let name = mechanism.name.to_owned();
        [name, format!("`{settings}`"), smoothed, lagged, live, nees]
    });
    let header = [
        "without",
        "set",
        "smoothed, %",
        "lagged, %",
        "live, %",
        "NEES, %",
    ];
    Ok(Some(pipe_table(header, rows)))
}
