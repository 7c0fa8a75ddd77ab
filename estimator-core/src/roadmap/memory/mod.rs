//! The road memory: the vehicle learns the roads that it drives.
//!
//! [`RoadMemory`] puts each finished cell in its place. A road that is driven for the first time
//! becomes a way. A known one gets better with each drive. The next time, its grade is there before
//! the vehicle is. The memory lies in flash ([`MappedFlash`]), in pages of one sector each. A page
//! that changes is written to a free sector, at most once a minute; the older copy counts until the
//! new one is whole. `docs/road-memory.md` specifies the form.
//!
//! Data flow in one direction: a finished cell goes to the place that [`RoadMemory::advance`] found
//! for it, there into a block, with it into a page in RAM, and with that into flash. No call does more
//! than a share of that: finished cells wait for their turn while a block or a page is read or written.

mod address;
mod block_writer;
mod finished;
mod flash;
mod fusion;
mod history;
mod learner;
mod memory_counters;
mod new_way;
mod on_way;
mod page;
mod page_buffer;
mod pages;
mod parked;
mod road_memory;
mod sectors;
mod store;
mod view;
mod work_block;

pub use address::PageKey;
pub use flash::{FEWEST_SECTORS, MOST_SECTORS, MappedFlash, SECTOR_BYTES};
pub use memory_counters::MemoryCounters;
pub use page::{MAGIC, Page, PageHeader, StoredJoin, VERSION};
pub use road_memory::{MemoryGrade, RoadMemory};
pub use sectors::{Sector, SectorTable};
pub use store::{MemoryError, Opened};
pub use view::{MemoryView, StoredWay};
