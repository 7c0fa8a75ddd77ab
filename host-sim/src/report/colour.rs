//! Colours that differ in print and for the colour-blind (Okabe and Ito).

pub use plotters::style::RGBColor;

/// Truth or reference.
pub const BLACK: RGBColor = RGBColor(0x22, 0x22, 0x22);
/// Main estimate.
pub const BLUE: RGBColor = RGBColor(0x00, 0x72, 0xb2);
/// Compared estimate.
pub const ORANGE: RGBColor = RGBColor(0xd5, 0x5e, 0x00);
/// Third series.
pub const GREEN: RGBColor = RGBColor(0x00, 0x9e, 0x73);
/// Fourth series.
pub const PURPLE: RGBColor = RGBColor(0xcc, 0x79, 0xa7);
/// Background.
pub const GREY: RGBColor = RGBColor(0x99, 0x99, 0x99);
/// Colours of the runs, in order.
pub const CYCLE: [RGBColor; 5] = [BLUE, ORANGE, GREEN, PURPLE, GREY];

/// From downhill over level to uphill.
pub const GRADES: [RGBColor; 7] = [
    RGBColor(0x08, 0x45, 0x94),
    RGBColor(0x42, 0x92, 0xc6),
    RGBColor(0x9e, 0xca, 0xe1),
    RGBColor(0xb0, 0xb0, 0xb0),
    RGBColor(0xfd, 0xae, 0x6b),
    RGBColor(0xe6, 0x55, 0x0d),
    RGBColor(0x8c, 0x2d, 0x04),
];
/// From small to large amounts.
pub const AMOUNTS: [RGBColor; 4] = [
    RGBColor(0x00, 0x44, 0x7c),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0xb3, 0x3c, 0x00),
];

/// Colours of this module that are too dark for a dark page, and what stands for them there.
const ON_DARK: [(RGBColor, RGBColor); 9] = [
    (BLACK, RGBColor(0xe8, 0xe8, 0xe8)),
    (BLUE, RGBColor(0x4f, 0xb3, 0xf0)),
    (ORANGE, RGBColor(0xff, 0x8a, 0x3c)),
    (GREEN, RGBColor(0x2f, 0xcf, 0x9f)),
    (PURPLE, RGBColor(0xe3, 0x9c, 0xc4)),
    (GRADES[0], RGBColor(0x3b, 0x7d, 0xe0)),
    (GRADES[6], RGBColor(0xc8, 0x4a, 0x2a)),
    (AMOUNTS[0], RGBColor(0x2f, 0x7f, 0xc4)),
    (AMOUNTS[3], RGBColor(0xd9, 0x5a, 0x2b)),
];

/// Returns the colour as `#rrggbb` for light and for dark pages.
#[must_use]
pub fn for_both_themes(colour: RGBColor) -> [String; 2] {
    let stands_for = ON_DARK.iter().find(|(light, _)| *light == colour);
    let on_dark = stands_for.map_or(colour, |(_, dark)| *dark);
    [colour, on_dark].map(|RGBColor(r, g, b)| format!("#{r:02x}{g:02x}{b:02x}"))
}
