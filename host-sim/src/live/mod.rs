//! The estimator on a live bus, and the replay of a log on an interface.

mod listening;
pub mod panel;
mod publisher;
mod rate;
pub mod replay;
mod road_picture;
pub mod road_view;
mod saved_memory;
mod session;
mod show;
pub mod status_timing;
mod stop_flag;
pub mod view;

pub use listening::{EndedDrive, ListenRequest, Listening};
pub use publisher::Publisher;
pub use session::{Reaction, Session};
pub use show::Show;
pub use stop_flag::stop_flag;
