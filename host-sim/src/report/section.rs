//! Sections of a page, and notes to its reader.

use super::figure::Figure;
use super::table::Table;

/// A section of a page. It shows its parts in the order of the fields.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Heading.
    pub heading: String,
    /// Text; a paragraph each.
    pub words: Vec<String>,
    /// Notes that must not be overlooked.
    pub notes: Vec<Note>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Figures.
    pub figures: Vec<Figure>,
}

/// A note that stands out from the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Whether something is wrong, or only good to know.
    pub is_warning: bool,
    /// What there is to know.
    pub message: String,
    /// What to do about it; may be empty.
    pub advice: String,
}

impl Note {
    /// Creates a note of something that is good to know.
    pub fn info(message: impl Into<String>) -> Self {
        Self {
            is_warning: false,
            message: message.into(),
            advice: String::new(),
        }
    }

    /// Creates a note of something wrong, with what to do about it.
    pub fn warning(message: impl Into<String>, advice: impl Into<String>) -> Self {
        Self {
            is_warning: true,
            message: message.into(),
            advice: advice.into(),
        }
    }
}

impl Section {
    /// Creates a section without content.
    pub fn new(heading: impl Into<String>) -> Self {
        Self {
            heading: heading.into(),
            ..Self::default()
        }
    }

    /// Returns the section with one more paragraph.
    #[must_use]
    pub fn paragraph(mut self, words: impl Into<String>) -> Self {
        self.words.push(words.into());
        self
    }

    /// Returns the section with one more note.
    #[must_use]
    pub fn note(mut self, note: Note) -> Self {
        self.notes.push(note);
        self
    }

    /// Returns the section with one more table.
    #[must_use]
    pub fn table(mut self, table: Table) -> Self {
        self.tables.push(table);
        self
    }

    /// Returns the section with one more figure.
    #[must_use]
    pub fn figure(mut self, figure: Figure) -> Self {
        self.figures.push(figure);
        self
    }
}
