//! Effects: each by itself, and on a drive.

mod on_a_drive;
mod single;
