//! Tables of a page.

/// A table: a header and rows of the same length.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Name of its file, without extension.
    pub name: String,
    /// Caption.
    pub caption: String,
    /// Names of the columns with their units.
    pub header: Vec<String>,
    /// Rows; numbers as text.
    pub rows: Vec<Vec<String>>,
    /// Whether the last column is words instead of numbers.
    pub has_words: bool,
    /// Whether it is folded until the reader opens it.
    pub is_folded: bool,
}

impl Table {
    /// Creates an empty table.
    pub fn new(name: impl Into<String>, caption: impl Into<String>, header: &[&str]) -> Self {
        Self {
            name: name.into(),
            caption: caption.into(),
            header: header.iter().map(|&name| name.to_owned()).collect(),
            rows: Vec::new(),
            has_words: false,
            is_folded: false,
        }
    }

    /// Returns the table with these rows.
    #[must_use]
    pub fn with_rows(mut self, rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        self.rows.extend(rows);
        self
    }

    /// Returns the table with words in its last column.
    #[must_use]
    pub const fn with_words(mut self) -> Self {
        self.has_words = true;
        self
    }

    /// Returns the table folded: its caption opens it.
    #[must_use]
    pub const fn folded(mut self) -> Self {
        self.is_folded = true;
        self
    }

    /// Returns the table as CSV.
    pub(super) fn to_csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for row in std::iter::once(&self.header).chain(&self.rows) {
            writer.write_record(row).expect("memory takes every row");
        }
        let bytes = writer.into_inner().expect("memory takes every row");
        String::from_utf8(bytes).expect("made of strings")
    }
}
