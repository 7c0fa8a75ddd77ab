//! The groups of a file and their channels.

use super::channel::{Channel, Problem};
use super::text::text;
use crate::error::{Error, Result};
use crate::source::damage::DamageCheck;
use crate::source::mdf::conversion::Conversions;
use crate::source::mdf::field::{Clock, Invalid};
use crate::source::mdf::group::GroupHead;
use crate::source::mdf::mdf_file::{Block, HEADER_BYTES, MdfFile};
use crate::source::mdf::records::Size;
use std::collections::{BTreeMap, HashSet};

/// Blocks of columns: HL may stand in front of the list.
const MOST_HEADS: usize = 2;

/// What a file has.
#[derive(Default)]
pub(super) struct Catalog {
    pub data_groups: Vec<DataGroup>,
    pub groups: Vec<Group>,
    /// True if there are frames of a bus.
    pub has_frames: bool,
    /// Start of the measurement, µs since the Unix epoch.
    pub origin_us: Option<u64>,
}

/// A data group: groups whose records stand in the same data.
#[derive(Clone, Debug)]
pub(super) struct DataGroup {
    pub link: u64,
    pub id_bytes: usize,
    /// By the number of the group.
    pub sizes: BTreeMap<u64, Size>,
    /// True if invalidation bits have blocks of their own (DV, LD; MDF 4.2).
    pub is_columns: bool,
}

/// A channel group.
pub(super) struct Group {
    /// Where its block is.
    pub at: u64,
    /// From 1, in the order of the file.
    pub number: usize,
    pub data_group: usize,
    pub head: GroupHead,
    /// Names of what recorded it: those of the group first.
    pub names: Vec<String>,
    pub time: Time,
    pub channels: Vec<Channel>,
}

/// The time of the records of a group.
#[derive(Clone, Debug)]
pub(super) enum Time {
    Clock(Clock),
    /// That of the records of another group: where its block is.
    OfBlock(u64),
    /// The same: its place among the groups.
    Remote(usize),
    /// There is none; why.
    None(String),
}

impl Catalog {
    /// Reads the groups of a file. A damaged block costs those behind it in its chain.
    ///
    /// # Errors
    /// Returns an error of the disk or of the header, and what `damage` does not allow.
    pub(super) fn read(file: &mut MdfFile, damage: &mut DamageCheck) -> Result<Self> {
        let header = file.header()?;
        let mut catalog = Self {
            origin_us: file.origin_us(&header)?,
            ..Self::default()
        };
        let mut scan = Scan {
            file,
            damage,
            seen: HashSet::new(),
            conversions: Conversions::default(),
            channels: 0,
        };
        let mut next = header.link(0);
        while let Some(block) = scan.block(next, b"##DG")? {
            scan.data_group(&block, &mut catalog)?;
            next = block.link(0);
        }
        catalog.link_times();
        Ok(catalog)
    }

    /// Returns the number of channels that have numbers with a time.
    pub(super) fn signal_count(&self) -> usize {
        let groups = self.groups.iter();
        let with_time = groups.filter(|group| !matches!(group.time, Time::None(_)));
        let channels = with_time.flat_map(|group| &group.channels);
        channels
            .filter(|channel| !matches!(channel.problem, Some(Problem::NoSignal(_))))
            .count()
    }

    /// Finds the groups whose times others use.
    fn link_times(&mut self) {
        let places: BTreeMap<u64, usize> = self
            .groups
            .iter()
            .enumerate()
            .filter(|(_, group)| matches!(group.time, Time::Clock(_)))
            .map(|(place, group)| (group.at, place))
            .collect();
        for group in &mut self.groups {
            if let Time::OfBlock(at) = group.time {
                group.time = match places.get(&at) {
                    Some(place) => Time::Remote(*place),
                    None => Time::None("the group with its times is not there".to_owned()),
                };
            }
        }
    }
}

/// The reading of the blocks.
pub(super) struct Scan<'a> {
    pub file: &'a mut MdfFile,
    pub damage: &'a mut DamageCheck,
    seen: HashSet<u64>,
    pub conversions: Conversions,
    pub channels: usize,
}

impl Scan<'_> {
    /// Reads a block of a chain; `None` where the chain ends, or is damaged.
    pub(super) fn block(&mut self, at: u64, id: &[u8; 4]) -> Result<Option<Block>> {
        if at == 0 {
            return Ok(None);
        }
        if !self.seen.insert(at) {
            let problem = self.file.error("a circle of links", "each block once");
            self.damage.block(problem, HEADER_BYTES)?;
            return Ok(None);
        }
        let block = self.file.described(at, id);
        self.unless_damaged(block)
    }

    /// Leaves out what is damaged.
    pub(super) fn unless_damaged<T>(&mut self, read: Result<T>) -> Result<Option<T>> {
        match read {
            Ok(read) => Ok(Some(read)),
            Err(problem @ Error::Io { .. }) => Err(problem),
            Err(problem) => {
                self.damage.block(problem, HEADER_BYTES)?;
                Ok(None)
            }
        }
    }

    fn data_group(&mut self, block: &Block, catalog: &mut Catalog) -> Result<()> {
        let id_bytes = self.file.data(block)?.first().copied().unwrap_or(0);
        let link = block.link(2);
        let is_columns = self.is_columns(link)?;
        let mut sizes = BTreeMap::new();
        let mut next = block.link(1);
        while let Some(group) = self.block(next, b"##CG")? {
            next = group.link(0);
            let head = GroupHead::read(self.file, &group);
            let Some(head) = self.unless_damaged(head)? else {
                continue;
            };
            let size = match head.size() {
                Size::Fixed(_) if is_columns => Size::Fixed(head.data_bytes as usize),
                size => size,
            };
            sizes.insert(head.id, size);
            if size != Size::Variable {
                let read = self.group(&group, head, is_columns, catalog)?;
                catalog.groups.push(read);
            }
        }
        catalog.data_groups.push(DataGroup {
            link,
            id_bytes: id_bytes.into(),
            sizes,
            is_columns,
        });
        Ok(())
    }

    fn group(
        &mut self,
        block: &Block,
        head: GroupHead,
        is_columns: bool,
        catalog: &mut Catalog,
    ) -> Result<Group> {
        let mut names = vec![self.text(block.link(2))?];
        let source = block.link(3);
        if source != 0
            && let Some(source) = {
                let source = self.file.described(source, b"##SI");
                self.unless_damaged(source)?
            }
        {
            names.push(self.text(source.link(0))?);
            names.push(self.text(source.link(1))?);
        }
        names.retain(|name| !name.is_empty());
        let mut found = super::channel_scan::Found::new(head, is_columns);
        self.channels(block.link(1), &mut found, 0)?;
        catalog.has_frames |= found.has_frames && matches!(found.time, Time::Clock(_));
        if head.has_remote_master() {
            found.time = Time::OfBlock(block.link(6));
        }
        Ok(Group {
            at: block.at,
            number: catalog.groups.len() + 1,
            data_group: catalog.data_groups.len(),
            head,
            names,
            time: found.time,
            channels: found.channels,
        })
    }

    /// Reads a name or a unit; empty if it is damaged.
    pub(super) fn text(&mut self, link: u64) -> Result<String> {
        let read = text(self.file, link);
        Ok(self.unless_damaged(read)?.unwrap_or_default())
    }

    /// Returns true for the data of columns.
    fn is_columns(&mut self, link: u64) -> Result<bool> {
        let mut at = link;
        for _ in 0..MOST_HEADS {
            let block = match self.file.block(at) {
                Ok(block) => block,
                Err(problem @ Error::Io { .. }) => return Err(problem),
                // The reader of the data tells it.
                Err(_) => return Ok(false),
            };
            match &block.id {
                b"##HL" => at = block.link(0),
                b"##DZ" => return Ok(self.file.data(&block)?.starts_with(b"DV")),
                id => return Ok(matches!(id, b"##DV" | b"##LD")),
            }
        }
        Ok(false)
    }
}

impl Group {
    /// Returns its name, for tables and messages.
    pub(super) fn label(&self) -> String {
        let name = self.names.first().cloned();
        name.unwrap_or_else(|| self.numbered())
    }

    /// Returns a name that no other group has.
    pub(super) fn numbered(&self) -> String {
        format!("group {}", self.number)
    }

    /// Returns whether this is one of its names.
    pub(super) fn is_named(&self, name: &str) -> bool {
        self.names.iter().any(|own| own == name) || self.numbered() == name
    }
}

/// Returns the marks of a channel, in the record or in bytes of their own.
pub(super) fn invalid_of(data: &[u8], head: &GroupHead, is_columns: bool) -> Invalid {
    let mut invalid = Invalid::default();
    let data_bytes = if is_columns {
        0
    } else {
        head.data_bytes as usize
    };
    invalid.note(data, data_bytes);
    invalid
}
