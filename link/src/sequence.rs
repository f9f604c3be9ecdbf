//! Counts lost frames.

/// Follows the frame numbers and counts the missing ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sequence {
    next: Option<u16>,
    lost: u64,
}

impl Sequence {
    /// Processes the number of a received frame. Returns how many frames were lost before it. A repeated or late frame looks
    /// like the loss of almost all 65,536.
    pub fn follow(&mut self, number: u16) -> u16 {
        let lost = self.next.map_or(0, |next| number.wrapping_sub(next));
        self.next = Some(number.wrapping_add(1));
        self.lost += u64::from(lost);
        lost
    }

    /// Number of frames lost so far.
    pub const fn lost(&self) -> u64 {
        self.lost
    }
}
