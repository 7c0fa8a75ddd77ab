//! `roadgrade diagnose`.

mod accelerometer;
mod end_to_end;
mod measured;
mod selection;
