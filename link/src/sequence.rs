//! Counts of frames that never came.

/// Follows the numbers of the frames, and counts those that are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sequence {
    next: Option<u16>,
    lost: u64,
}

impl Sequence {
    /// A frame of this number has come. Returns how many were lost right before it: one that comes again, or late, looks
    /// like the loss of nearly all.
    pub fn follow(&mut self, number: u16) -> u16 {
        let lost = self.next.map_or(0, |next| number.wrapping_sub(next));
        self.next = Some(number.wrapping_add(1));
        self.lost += u64::from(lost);
        lost
    }

    /// Frames lost so far.
    pub const fn lost(&self) -> u64 {
        self.lost
    }
}
