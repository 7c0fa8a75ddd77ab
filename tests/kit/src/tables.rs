//! Tables that the program wrote.

use std::collections::BTreeMap;
use std::path::Path;

/// Returns the columns of a CSV file as text, by name.
///
/// # Panics
/// Panics if the file is not a table.
#[must_use]
pub fn columns(path: &Path) -> BTreeMap<String, Vec<String>> {
    let mut reader = csv::Reader::from_path(path).expect("a table");
    let names = reader.headers().expect("a header").clone();
    let mut columns: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for record in reader.records() {
        for (name, field) in names.iter().zip(&record.expect("a row")) {
            columns
                .entry(name.to_owned())
                .or_default()
                .push(field.to_owned());
        }
    }
    columns
}
