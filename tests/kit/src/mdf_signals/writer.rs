//! The blocks of a file with signals.

use super::{MASTER, MdfChannel, MdfConversion, MdfGroup, MdfReference};
use crate::mdf::{MdfBlocks, Writer};

/// Flag of a group whose times are those of another one.
const REMOTE_MASTER: u16 = 1 << 3;

impl MdfGroup {
    pub(super) fn size(&self) -> usize {
        self.records[0].1.len()
    }
}

impl Writer {
    pub(super) fn data_group(
        &mut self,
        next: u64,
        group: u64,
        id_bytes: u8,
        bytes: &[u8],
        blocks: MdfBlocks,
        columns: usize,
    ) -> u64 {
        let data = [id_bytes, 0, 0, 0, 0, 0, 0, 0];
        let dg = self.block(b"##DG", &[next, group, 0, 0], &data);
        let at = self.data(b"##DT", bytes, blocks, columns);
        if blocks == MdfBlocks::Unfinished {
            self.leave_open(at);
        }
        self.link(dg, 2, at);
        dg
    }

    pub(super) fn group(&mut self, group: &MdfGroup, next: u64, id: u64) -> u64 {
        let mut channel = 0;
        for of in group.channels.iter().rev() {
            channel = self.signal(of, channel);
        }
        let data_bytes = group.size() as u32 - group.invalidation_bytes;
        let sizes = [data_bytes, group.invalidation_bytes];
        self.group_block(group, [next, channel, 0], id, 0, sizes)
    }

    fn group_block(
        &mut self,
        group: &MdfGroup,
        [next, channel, master]: [u64; 3],
        id: u64,
        flags: u16,
        sizes: [u32; 2],
    ) -> u64 {
        let name = self.text_or_none(group.name);
        let source = self.text_or_none(group.source);
        let source = match source {
            0 => 0,
            name => self.block(b"##SI", &[name, 0, 0], &[0; 8]),
        };
        let mut data = vec![0; 32];
        data[..8].copy_from_slice(&id.to_le_bytes());
        data[8..16].copy_from_slice(&(group.records.len() as u64).to_le_bytes());
        data[16..18].copy_from_slice(&flags.to_le_bytes());
        data[24..28].copy_from_slice(&sizes[0].to_le_bytes());
        data[28..].copy_from_slice(&sizes[1].to_le_bytes());
        let mut links = vec![next, channel, name, source, 0, 0];
        links.extend((master != 0).then_some(master));
        self.block(b"##CG", &links, &data)
    }

    fn text_or_none(&mut self, text: &str) -> u64 {
        match text {
            "" => 0,
            xml if xml.starts_with('<') => {
                self.block(b"##MD", &[], &[xml.as_bytes(), &[0]].concat())
            }
            text => self.text(text),
        }
    }

    fn signal(&mut self, channel: &MdfChannel, next: u64) -> u64 {
        let name = self.text(&channel.name);
        let unit = self.text_or_none(channel.unit);
        let conversion = channel.conversion.as_ref();
        let conversion = conversion.map_or(0, |conversion| self.conversion(conversion));
        let mut data = vec![channel.kind, channel.sync, channel.data_type, channel.bit];
        let flags = channel.invalid_bit.map_or(0_u32, |_| 2);
        for number in [
            channel.byte,
            channel.bits,
            flags,
            channel.invalid_bit.unwrap_or(0),
        ] {
            data.extend(number.to_le_bytes());
        }
        data.resize(72, 0);
        self.block(b"##CN", &[next, 0, name, 0, conversion, 0, unit, 0], &data)
    }

    fn conversion(&mut self, conversion: &MdfConversion) -> u64 {
        let unit = self.text_or_none(conversion.unit);
        let mut links = vec![0, unit, 0, 0];
        for reference in &conversion.references {
            links.push(match reference {
                MdfReference::None => 0,
                MdfReference::Text(text) => self.text(text),
                MdfReference::Conversion(inner) => self.conversion(inner),
            });
        }
        let mut data = vec![conversion.kind, 0, 0, 0];
        data.extend((conversion.references.len() as u16).to_le_bytes());
        data.extend((conversion.numbers.len() as u16).to_le_bytes());
        data.extend([0; 16]);
        data.extend(conversion.numbers.iter().flat_map(|n| n.to_le_bytes()));
        self.block(b"##CC", &links, &data)
    }

    /// Writes a group as columns: first the one with the times.
    pub(super) fn columns(&mut self, next: u64, group: &MdfGroup, blocks: MdfBlocks) -> u64 {
        let (times, others): (Vec<_>, Vec<_>) = group
            .channels
            .iter()
            .partition(|channel| channel.kind == MASTER);
        let (mut dg, mut master) = (next, 0);
        for channel in times.into_iter().chain(others) {
            let bytes = channel.bits / 8;
            let alone = MdfChannel {
                byte: 0,
                invalid_bit: channel.invalid_bit.map(|_| 0),
                ..channel.clone()
            };
            let cn = self.signal(&alone, 0);
            let marks = u32::from(channel.invalid_bit.is_some());
            let flags = if master == 0 { 0 } else { REMOTE_MASTER };
            let cg = self.group_block(group, [0, cn, master], 0, flags, [bytes, marks]);
            if master == 0 {
                master = cg;
            }
            let at = channel.byte as usize..(channel.byte + bytes) as usize;
            let values: Vec<&[u8]> = group.records.iter().map(|(_, r)| &r[at.clone()]).collect();
            let link = self.list_of_column(group, channel, &values, blocks);
            dg = self.block(b"##DG", &[dg, cg, link, 0], &[0; 8]);
        }
        dg
    }

    /// Writes the values of a column in three blocks, with their marks. A block without marks has none.
    fn list_of_column(
        &mut self,
        group: &MdfGroup,
        channel: &MdfChannel,
        values: &[&[u8]],
        blocks: MdfBlocks,
    ) -> u64 {
        let count = values.len() / 3 + 1;
        let (mut data, mut marks) = (Vec::new(), Vec::new());
        for (k, part) in values.chunks(count).enumerate() {
            let bytes = part.concat();
            data.push(match blocks {
                MdfBlocks::Plain | MdfBlocks::Unfinished | MdfBlocks::List => {
                    self.block(b"##DV", &[], &bytes)
                }
                _ => self.packed(b"##DV", &bytes, blocks, part[0].len()),
            });
            let Some(bit) = channel.invalid_bit else {
                continue;
            };
            let place = group.size() - group.invalidation_bytes as usize + bit as usize / 8;
            let records = group.records.iter().skip(k * count).take(part.len());
            let bits: Vec<u8> = records
                .map(|(_, record)| record[place] >> (bit % 8) & 1)
                .collect();
            marks.push(if bits.contains(&1) {
                self.block(b"##DI", &[], &bits)
            } else {
                0
            });
        }
        let number = data.len() as u32;
        let flags = 1 | if marks.is_empty() { 0 } else { 1_u32 << 31 };
        let links = [vec![0], data, marks].concat();
        let head = [&flags.to_le_bytes()[..], &number.to_le_bytes()].concat();
        let head = [&head[..], &(count as u64).to_le_bytes()].concat();
        self.block(b"##LD", &links, &head)
    }
}
