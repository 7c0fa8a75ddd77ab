//! Tables for a terminal: aligned, and Markdown when pasted elsewhere.

use comfy_table::{CellAlignment, Table, presets};

/// A table whose first `left` columns hold words, the others numbers.
#[must_use]
pub fn text_table<S: AsRef<str>>(header: &[S], rows: &[Vec<String>], left: usize) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::ASCII_MARKDOWN)
        .set_header(header.iter().map(AsRef::as_ref));
    for row in rows {
        table.add_row(row);
    }
    for column in left..header.len() {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}
