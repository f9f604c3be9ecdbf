//! Where the time goes: instructions and cycles of each exception.

/// One completed run of an exception handler.
///
/// Instructions and cycles are the handler's own, without those of exceptions that preempted it. Entry and exit count
/// as cycles of the handler.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Activation {
    /// Exception number, 16 + the interrupt line.
    pub exception: u16,
    /// Cycle at which it became pending.
    pub pended: u64,
    /// Cycle at which its first instruction began.
    pub entered: u64,
    /// Cycle at which it had returned.
    pub left: u64,
    /// Instructions of its own.
    pub instructions: u64,
    /// Cycles of its own.
    pub cycles: u64,
}

/// What one exception has taken so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Totals {
    /// Completed activations.
    pub count: u64,
    /// Instructions of their own.
    pub instructions: u64,
    /// Cycles of their own.
    pub cycles: u64,
    /// Most instructions of one activation.
    pub most_instructions: u64,
    /// Most cycles of one activation.
    pub most_cycles: u64,
    /// Longest time from pending to the first instruction, cycles.
    pub longest_wait: u64,
}
