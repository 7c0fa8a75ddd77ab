//! The groups of a file.

use super::catalog::{Catalog, DataGroup, Group, Time};
use super::channel_scan::Found;
use super::scan::Scan;
use crate::error::{Error, Result};
use crate::source::damage::DamageCheck;
use crate::source::mdf::group::GroupHead;
use crate::source::mdf::mdf_file::{Block, MdfFile};
use crate::source::mdf::records::Size;
use std::collections::BTreeMap;

/// Blocks of columns: HL may stand in front of the list.
const MOST_HEADS: usize = 2;

/// Reads the groups of a file. A damaged block costs those behind it in its chain.
///
/// # Errors
/// Returns an error of the disk or of the header, and what `damage` does not allow.
pub(super) fn read(file: &mut MdfFile, damage: &mut DamageCheck) -> Result<Catalog> {
    let header = file.header()?;
    let mut catalog = Catalog {
        origin_us: file.origin_us(&header)?,
        ..Catalog::default()
    };
    let mut scan = Scan::new(file, damage);
    let mut next = header.link(0);
    while let Some(block) = scan.block(next, b"##DG")? {
        scan.data_group(&block, &mut catalog)?;
        next = block.link(0);
    }
    catalog.link_times();
    Ok(catalog)
}

impl Scan<'_> {
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
        let mut found = Found::new(head, is_columns);
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
