//! Pages: one file each, valid, without anything from elsewhere, and with the data of their tables.

mod assets;
mod charts;
mod demo;
mod parsed;
mod parts;
mod study;
