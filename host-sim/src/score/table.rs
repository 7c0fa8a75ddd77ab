//! The error table, as text and as JSON.

use super::score_row::ScoreRow;
use crate::terminal::table::text_table;
use comfy_table::Table;

/// Names of the columns of the error table.
pub const HEADER: [&str; 10] = [
    "run",
    "estimate",
    "cells",
    "RMSE %",
    "RMSE valid %",
    "bias %",
    "NEES",
    "to oracle",
    "marked %",
    "NEES unmarked",
];

/// Returns the rows as text, one entry for each of [`HEADER`].
pub fn text(rows: &[ScoreRow]) -> Vec<Vec<String>> {
    rows.iter()
        .map(|row| {
            let if_known = |value: Option<f64>, decimals| {
                value.map_or_else(|| "-".into(), |value| format!("{value:.decimals$}"))
            };
            vec![
                row.run.clone(),
                row.estimate.into(),
                row.cells.to_string(),
                format!("{:.4}", row.rmse_percent),
                if_known(row.rmse_valid_percent, 4),
                format!("{:+.4}", row.bias_percent),
                format!("{:.2}", row.nees),
                if_known(row.oracle_ratio, 2),
                if_known(row.marked_percent, 1),
                if_known(row.nees_unmarked, 2),
            ]
        })
        .collect()
}

/// Returns the rows as an aligned table.
pub fn table(rows: &[ScoreRow]) -> Table {
    text_table(&HEADER, &text(rows), 2)
}

/// Returns the rows as a JSON array.
pub fn json(rows: &[ScoreRow]) -> String {
    let rows: Vec<ScoreRow> = rows.iter().map(ScoreRow::rounded).collect();
    serde_json::json!(rows).to_string()
}
