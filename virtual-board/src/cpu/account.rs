//! Counts instructions and cycles of each exception.

/// One completed run of an exception handler.
///
/// Instructions and cycles exclude those of exceptions that preempted the handler. Exception entry and return count as
/// cycles of the handler.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Activation {
    /// Exception number, 16 + the interrupt line.
    pub exception: u16,
    /// Cycle at which the exception became pending.
    pub pended: u64,
    /// Cycle at which the first instruction of the handler began.
    pub entered: u64,
    /// Cycle at which the handler had returned.
    pub left: u64,
    /// Instructions of the handler itself.
    pub instructions: u64,
    /// Cycles of the handler itself.
    pub cycles: u64,
}

/// Totals of one exception since power-on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Totals {
    /// Number of completed activations.
    pub count: u64,
    /// Instructions of the handler itself.
    pub instructions: u64,
    /// Cycles of the handler itself.
    pub cycles: u64,
    /// Largest number of instructions of one activation.
    pub most_instructions: u64,
    /// Largest number of cycles of one activation.
    pub most_cycles: u64,
    /// Longest time from pending to the first instruction, cycles.
    pub longest_wait: u64,
}

/// Cycles and instructions since power-on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Now {
    pub cycle: u64,
    pub instructions: u64,
}

/// The running handlers, and the totals of the completed ones.
#[derive(Debug, Clone, Default)]
pub(super) struct Account {
    open: Vec<Activation>,
    charged: Now,
    totals: Vec<Totals>,
    pub record: bool,
    pub completed: Vec<Activation>,
}

impl Account {
    /// Charges the elapsed cycles and instructions to the running handler.
    fn charge(&mut self, now: Now) {
        if let Some(top) = self.open.last_mut() {
            top.instructions += now.instructions - self.charged.instructions;
            top.cycles += now.cycle - self.charged.cycle;
        }
        self.charged = now;
    }

    /// The entry of a handler begins.
    pub fn open(&mut self, exception: u16, pended: u64, now: Now) {
        self.charge(now);
        self.open.push(Activation {
            exception,
            pended,
            entered: now.cycle,
            left: 0,
            instructions: 0,
            cycles: 0,
        });
    }

    /// A late exception takes over the entry that has begun.
    pub fn take_over(&mut self, exception: u16, pended: u64) {
        if let Some(top) = self.open.last_mut() {
            top.exception = exception;
            top.pended = pended;
        }
    }

    /// The first instruction of the handler begins.
    pub fn entered(&mut self, cycle: u64) {
        if let Some(top) = self.open.last_mut() {
            top.entered = cycle;
        }
    }

    /// The running handler has returned.
    pub fn close(&mut self, now: Now) {
        self.charge(now);
        let Some(mut done) = self.open.pop() else {
            return;
        };
        done.left = now.cycle;
        let number = usize::from(done.exception);
        if self.totals.len() <= number {
            self.totals.resize(number + 1, Totals::default());
        }
        let totals = &mut self.totals[number];
        totals.count += 1;
        totals.instructions += done.instructions;
        totals.cycles += done.cycles;
        totals.most_instructions = totals.most_instructions.max(done.instructions);
        totals.most_cycles = totals.most_cycles.max(done.cycles);
        totals.longest_wait = totals.longest_wait.max(done.entered - done.pended);
        if self.record {
            self.completed.push(done);
        }
    }

    /// A reset ends all handlers without their return.
    pub fn reset(&mut self, now: Now) {
        self.charge(now);
        self.open.clear();
    }

    pub fn totals(&self, exception: u16) -> Totals {
        self.totals
            .get(usize::from(exception))
            .copied()
            .unwrap_or_default()
    }
}
