//! Tables in Markdown.

/// Returns a table with a row for each of `rows`. A `|` in a cell is escaped, since it would begin
/// the next cell.
pub fn pipe_table<const N: usize>(
    header: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> String {
    let line = |cells: &[String; N]| {
        let cells = cells.each_ref().map(|cell| cell.replace('|', "\\|"));
        format!("| {} |\n", cells.join(" | "))
    };
    let mut table = line(&header.map(str::to_owned));
    table += &format!("|{}\n", "---|".repeat(N));
    table.extend(rows.into_iter().map(|row| line(&row)));
    table
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
