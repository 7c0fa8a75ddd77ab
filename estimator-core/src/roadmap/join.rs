//! A place where one way can be left for another.

/// A place where one way can be left for another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Join {
    /// Cell of the way at which it is left.
    pub at_cell: i32,
    /// Offset of the way that is entered.
    pub to_way: u32,
    /// Cell at which it is entered.
    pub to_cell: i32,
    /// Offset of the first block that ends at or behind this cell.
    pub to_block: u32,
}
