//! The road memory: what it learns, and what it keeps whatever happens to its flash.

mod damage;
mod flash;
mod learning;
mod power;
mod room;
mod tracks;
