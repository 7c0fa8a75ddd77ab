//! `roadgrade diagnose`.

mod end_to_end;
mod measured;
