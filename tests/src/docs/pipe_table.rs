//! Tables in Markdown.

/// Returns a table with a row for each of `rows`. A `|` in a cell is escaped, since it would begin
/// the next cell.
pub fn pipe_table<const N: usize>(
    header: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> String {
    let rows: Vec<[String; N]> = rows.into_iter().collect();
    table_as_it_is(&header, &rows)
}

/// Returns a table of rows that are as wide as the header.
pub fn table_as_it_is(header: &[impl AsRef<str>], rows: &[impl AsRef<[String]>]) -> String {
    let mut table = line(header);
    table += &format!("|{}\n", "---|".repeat(header.len()));
    table.extend(rows.iter().map(|row| line(row.as_ref())));
    table
}

fn line(cells: &[impl AsRef<str>]) -> String {
    let cells: Vec<String> = cells
        .iter()
        .map(|cell| cell.as_ref().replace('|', "\\|"))
        .collect();
    format!("| {} |\n", cells.join(" | "))
}

/// Returns a whole number with a comma for each three digits: 63,688.
pub fn with_commas(number: u32) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_in_groups_of_three() {
        let numbers = [0, 999, 1_000, 63_688, 1_234_567].map(with_commas);
        assert_eq!(numbers, ["0", "999", "1,000", "63,688", "1,234,567"]);
    }

    #[test]
    fn cells_do_not_end_at_a_bar() {
        let table = pipe_table(["a", "b"], [["x|y".to_owned(), "z".to_owned()]]);
        assert_eq!(table, "| a | b |\n|---|---|\n| x\\|y | z |\n");
    }
}
