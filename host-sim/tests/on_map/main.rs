//! The map on the vehicle: its place on the map, the live grade with the map, and the grade ahead.

mod drives;
mod live;
mod measured_road;
mod memory;
mod network_drives;
mod parts;
mod places;
