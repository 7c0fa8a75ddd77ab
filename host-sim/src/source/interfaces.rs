//! The interfaces that a log names.

use serde::Serialize;

/// Index of an interface in the order of its first frame.
pub(super) type InterfaceIndex = u8;

/// Most interfaces that are told apart; all others are one more.
const MOST: usize = 64;
/// Name of all others.
const OTHERS: &str = "others";
/// Maximum length of a name, bytes.
const MOST_NAME_BYTES: usize = 64;

/// One interface of a log.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct InterfaceCount {
    /// Its name. Channels with numbers, from 1, are `can0`, `can1` and so on, as python-can names
    /// them.
    pub name: String,
    /// Number of its frames.
    pub frames: u64,
    /// Number of those that are left out: another interface has the same message.
    pub duplicates: u64,
}

/// The names of the interfaces of a log.
#[derive(Debug, Default)]
pub(super) struct Interfaces {
    counts: Vec<InterfaceCount>,
    channels: Vec<(u32, InterfaceIndex)>,
    newest: InterfaceIndex,
}

impl Interfaces {
    /// Returns the index of the interface with this name.
    pub(super) fn named(&mut self, name: &[u8]) -> InterfaceIndex {
        let is_same = |count: &InterfaceCount| count.name.as_bytes() == name;
        if self
            .counts
            .get(usize::from(self.newest))
            .is_some_and(is_same)
        {
            return self.newest;
        }
        let name = name.get(..MOST_NAME_BYTES).unwrap_or(name);
        let name = String::from_utf8_lossy(name).into_owned();
        self.newest = self.index_of(name);
        self.newest
    }

    /// Returns the index of the channel with this number, from 1.
    pub(super) fn channel(&mut self, number: u32) -> InterfaceIndex {
        let known = self.channels.iter().find(|(known, _)| *known == number);
        if let Some((_, index)) = known {
            return *index;
        }
        let name = match number.checked_sub(1) {
            Some(number) => format!("can{number}"),
            None => "channel0".to_owned(),
        };
        let index = self.index_of(name);
        if self.channels.len() <= MOST {
            self.channels.push((number, index));
        }
        index
    }

    fn index_of(&mut self, name: String) -> InterfaceIndex {
        let position = |name: &str| self.counts.iter().position(|count| count.name == name);
        let (name, known) = match position(&name) {
            None if self.counts.len() >= MOST => (OTHERS.to_owned(), position(OTHERS)),
            known => (name, known),
        };
        let index = known.unwrap_or_else(|| {
            self.counts.push(InterfaceCount {
                name,
                ..InterfaceCount::default()
            });
            self.counts.len() - 1
        });
        index as InterfaceIndex
    }

    /// Returns the name of an interface.
    pub(super) fn name(&self, index: InterfaceIndex) -> &str {
        self.counts
            .get(usize::from(index))
            .map_or("", |count| &count.name)
    }

    /// Counts a frame of an interface.
    pub(super) fn count_frame(&mut self, index: InterfaceIndex) {
        if let Some(count) = self.counts.get_mut(usize::from(index)) {
            count.frames += 1;
        }
    }

    /// Counts a frame that is left out.
    pub(super) fn count_duplicate(&mut self, index: InterfaceIndex) {
        if let Some(count) = self.counts.get_mut(usize::from(index)) {
            count.duplicates += 1;
        }
    }

    /// Returns the interfaces that have frames.
    pub(super) fn counts(&self) -> impl Iterator<Item = &InterfaceCount> {
        self.counts.iter().filter(|count| count.frames > 0)
    }
}
