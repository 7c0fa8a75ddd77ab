//! Tables for a terminal, in aligned Markdown.

use comfy_table::{CellAlignment, Table, presets};

/// Returns a table whose first `left` columns are left-aligned (text); the others are
/// right-aligned (numbers).
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
