//! The road memory: what it learns, and what it keeps whatever happens to its flash.

mod as_map;
mod change_indicator;
mod damage;
mod flash;
mod journey;
mod learning;
mod made_pages;
mod odd_drives;
mod power;
mod room;
mod tracks;
