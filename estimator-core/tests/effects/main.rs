//! Effects: their catalogue, each by itself, and on a drive.

mod catalogue;
mod on_a_drive;
mod single;
