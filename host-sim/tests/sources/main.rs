//! Sources: recordings of buses, signal tables, and what is on a bus.

mod can_frame;
mod candump;
mod inspect;
mod signal_table;
