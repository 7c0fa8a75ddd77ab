//! `roadgrade identify` and `roadgrade map`: from logs to a vehicle file and a map.

mod drawn;
mod electric;
mod maps;
mod refused;
mod trucks;
mod vehicles;
