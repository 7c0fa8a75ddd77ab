//! Two stacks in the memory of one.

use heapless::Deque;

/// Two stacks back to back: one is filled while the other one, which was filled before, is emptied.
/// As long as it is emptied at least as fast, there is room.
#[derive(Clone, Debug)]
pub(super) struct TwoStacks<T, const N: usize> {
    /// The newest items of the two stacks are at the two ends.
    items: Deque<T, N>,
    /// Number of items of the stack that is emptied.
    left: usize,
    fills_back: bool,
}

impl<T, const N: usize> TwoStacks<T, N> {
    /// Creates two empty stacks.
    pub const fn new() -> Self {
        Self {
            items: Deque::new(),
            left: 0,
            fills_back: true,
        }
    }

    /// Returns the number of items of the stack that is filled.
    pub const fn filled(&self) -> usize {
        self.items.len().saturating_sub(self.left)
    }

    /// Returns the number of items of the stack that is emptied.
    pub const fn left(&self) -> usize {
        self.left
    }

    /// Puts an item on the stack that is filled. Returns false if there is no room.
    #[inline(never)] // Else the item is written out twice, for either end.
    pub fn push(&mut self, item: T) -> bool {
        let pushed = if self.fills_back {
            self.items.push_back(item)
        } else {
            self.items.push_front(item)
        };
        pushed.is_ok()
    }

    /// Returns the newest item of the stack that is emptied.
    pub fn last(&self) -> Option<&T> {
        if self.left == 0 {
            None
        } else if self.fills_back {
            self.items.front()
        } else {
            self.items.back()
        }
    }

    /// Takes the newest item off the stack that is emptied.
    pub fn drop_last(&mut self) {
        if self.left == 0 {
            return;
        }
        self.left -= 1;
        if self.fills_back {
            self.items.pop_front();
        } else {
            self.items.pop_back();
        }
    }

    /// Swaps the stacks, if one of them is empty: the other one is to be emptied from now on.
    pub fn turn(&mut self) {
        if self.left == 0 {
            self.left = self.items.len();
            self.fills_back = !self.fills_back;
        }
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
