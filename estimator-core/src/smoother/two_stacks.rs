//! Two stacks in the memory of one.

/// Two stacks in one array, one from each end: one is filled while the other one, which was filled
/// before, is emptied. As long as it is emptied at least as fast, there is room.
#[derive(Clone, Debug)]
pub(super) struct TwoStacks<T, const N: usize> {
    slots: [Option<T>; N],
    /// Number of items of the stack that is filled.
    filled: usize,
    /// Number of items of the stack that is emptied.
    left: usize,
    fills_from_end: bool,
}

impl<T: Copy, const N: usize> TwoStacks<T, N> {
    /// Creates two empty stacks.
    pub const fn new() -> Self {
        Self {
            slots: [const { None }; N],
            filled: 0,
            left: 0,
            fills_from_end: false,
        }
    }

    /// Returns the number of items of the stack that is filled.
    pub const fn filled(&self) -> usize {
        self.filled
    }

    /// Returns the number of items of the stack that is emptied.
    pub const fn left(&self) -> usize {
        self.left
    }

    /// Puts an item on the stack that is filled. Returns false if there is no room.
    pub fn push(&mut self, item: T) -> bool {
        if self.filled + self.left >= N {
            return false;
        }
        let at = Self::place(self.filled, self.fills_from_end);
        if let Some(slot) = self.slots.get_mut(at) {
            *slot = Some(item);
        }
        self.filled += 1;
        true
    }

    /// Returns the newest item of the stack that is emptied.
    pub fn last(&self) -> Option<&T> {
        let newest = self.left.checked_sub(1)?;
        let at = Self::place(newest, !self.fills_from_end);
        self.slots.get(at)?.as_ref()
    }

    /// Takes the newest item off the stack that is emptied.
    pub fn drop_last(&mut self) {
        self.left = self.left.saturating_sub(1);
    }

    /// Swaps the stacks, if one of them is empty: the other one is to be emptied from now on.
    pub fn turn(&mut self) {
        if self.left == 0 {
            self.left = core::mem::take(&mut self.filled);
            self.fills_from_end = !self.fills_from_end;
        }
    }

    /// Returns the place of the `n`-th item from an end.
    const fn place(n: usize, from_end: bool) -> usize {
        if from_end { N - 1 - n } else { n }
    }
}

#[cfg(test)]
mod tests {
    use super::TwoStacks;

    #[test]
    fn one_is_filled_while_the_other_one_is_emptied() {
        let mut stacks = TwoStacks::<u32, 4>::new();
        let mut next = 0;
        for _ in 0..3 {
            let first = next;
            for _ in 0..4 {
                stacks.drop_last();
                assert!(stacks.push(next));
                next += 1;
            }
            assert!(!stacks.push(99));
            stacks.turn();
            assert_eq!((stacks.filled(), stacks.left()), (0, 4));
            assert_eq!(stacks.last(), Some(&(first + 3)));
        }
    }

    #[test]
    fn a_part_of_a_stack_is_emptied_from_its_newest_item() {
        let mut stacks = TwoStacks::<u32, 4>::new();
        for item in [1, 2, 3] {
            stacks.push(item);
        }
        stacks.turn();
        stacks.push(4);
        for item in [3, 2, 1] {
            assert_eq!(stacks.last(), Some(&item));
            stacks.drop_last();
        }
        // The other one is not emptied before it is its turn.
        assert_eq!((stacks.filled(), stacks.left()), (1, 0));
        stacks.turn();
        assert_eq!(stacks.last(), Some(&4));
    }
}
