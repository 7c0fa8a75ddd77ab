//! Text of XML files.

use std::fmt::{self, Display, Formatter, Write};

/// A text as the value of an attribute.
pub(in crate::map::io) struct Attribute<'t>(pub(in crate::map::io) &'t str);

impl Display for Attribute<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.0.chars().try_for_each(|character| match character {
            '&' => f.write_str("&amp;"),
            '<' => f.write_str("&lt;"),
            '>' => f.write_str("&gt;"),
            '"' => f.write_str("&quot;"),
            '\'' => f.write_str("&apos;"),
            // XML 1.0 has no other control characters.
            control if control.is_control() => write!(f, "&#xFFFD;"),
            other => f.write_char(other),
        })
    }
}
