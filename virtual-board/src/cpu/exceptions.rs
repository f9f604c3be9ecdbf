//! State of the exceptions: enabled, pending, active, and their order of priority.

/// Number of the non-maskable interrupt.
pub const NMI: u16 = 2;
/// Number of HardFault.
pub const HARD_FAULT: u16 = 3;
/// Number of MemManage.
pub const MEM_MANAGE: u16 = 4;
/// Number of BusFault.
pub const BUS_FAULT: u16 = 5;
/// Number of UsageFault.
pub const USAGE_FAULT: u16 = 6;
/// Number of SVCall.
pub const SVCALL: u16 = 11;
/// Number of DebugMonitor.
pub const DEBUG_MONITOR: u16 = 12;
/// Number of PendSV.
pub const PENDSV: u16 = 14;
/// Number of SysTick.
pub const SYSTICK: u16 = 15;
/// Number of interrupt line 0.
pub const INTERRUPT_0: u16 = 16;

/// Number of exception numbers: 16 of the core and 240 interrupt lines.
pub const COUNT: usize = 256;

/// Execution priority while nothing is active or masked.
pub const THREAD_PRIORITY: i16 = 256;

/// Priority bits that the STM32F4 implements.
const PRIORITY_BITS: u8 = 0xF0;

/// A set of exception numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Set([u64; COUNT / 64]);

impl Set {
    pub fn contains(&self, number: u16) -> bool {
        self.0
            .get(usize::from(number >> 6))
            .is_some_and(|word| word >> (number & 63) & 1 == 1)
    }

    pub fn set(&mut self, number: u16, member: bool) {
        if let Some(word) = self.0.get_mut(usize::from(number >> 6)) {
            *word = *word & !(1 << (number & 63)) | u64::from(member) << (number & 63);
        }
    }

    pub fn len(&self) -> u32 {
        self.0.iter().map(|word| word.count_ones()).sum()
    }

    /// The numbers in both sets, in ascending order.
    pub fn common(&self, other: &Self) -> impl Iterator<Item = u16> {
        let both: [u64; COUNT / 64] = std::array::from_fn(|i| self.0[i] & other.0[i]);
        (0..).zip(both).flat_map(|(i, mut word)| {
            std::iter::from_fn(move || {
                let lowest = word.trailing_zeros() as u16;
                word &= word.wrapping_sub(1);
                (lowest < 64).then_some(i * 64 + lowest)
            })
        })
    }

    /// 32 members of the set from `first`, a multiple of 16, as bits.
    pub fn word(&self, first: u16) -> u32 {
        (0..32)
            .filter(|i| first + i < COUNT as u16 && self.contains(first + i))
            .fold(0, |word, i| word | 1 << i)
    }
}

/// The state of all exceptions.
#[derive(Debug, Clone)]
pub struct Exceptions {
    pub enabled: Set,
    pub pending: Set,
    pub active: Set,
    priorities: [u8; COUNT],
    pended_at: [u64; COUNT],
    /// AIRCR.PRIGROUP.
    pub group: u8,
}

impl Default for Exceptions {
    fn default() -> Self {
        let mut enabled = Set::default();
        for number in 1..INTERRUPT_0 {
            enabled.set(number, true);
        }
        Self {
            enabled,
            pending: Set::default(),
            active: Set::default(),
            priorities: [0; COUNT],
            pended_at: [0; COUNT],
            group: 0,
        }
    }
}

impl Exceptions {
    /// Makes an exception pending at `cycle`. If it is pending already, the earlier cycle is kept.
    pub fn pend(&mut self, number: u16, cycle: u64) {
        if !self.pending.contains(number) {
            self.pended_at[usize::from(number)] = cycle;
            self.pending.set(number, true);
        }
    }

    /// Cycle at which it last became pending.
    pub fn pended_at(&self, number: u16) -> u64 {
        self.pended_at[usize::from(number)]
    }

    /// Priority register of an exception.
    pub fn priority_byte(&self, number: u16) -> u8 {
        self.priorities[usize::from(number)]
    }

    /// Sets the priority register of an exception. Bits that are not implemented are ignored.
    pub fn set_priority_byte(&mut self, number: u16, priority: u8) {
        self.priorities[usize::from(number)] = priority & PRIORITY_BITS;
    }

    /// The part of a priority that decides on preemption.
    pub fn group_priority(&self, priority: u8) -> i16 {
        (u16::from(priority) >> (self.group + 1) << (self.group + 1)) as i16
    }

    /// Priority of an exception for preemption. A lower number is more urgent.
    pub fn priority(&self, number: u16) -> i16 {
        match number {
            NMI => -2,
            HARD_FAULT => -1,
            _ => self.group_priority(self.priority_byte(number)),
        }
    }

    /// The most urgent pending exception, with its priority for preemption.
    pub fn next(&self) -> Option<(u16, i16)> {
        let first = self
            .pending
            .common(&self.enabled)
            .min_by_key(|&number| match number {
                NMI => -2,
                HARD_FAULT => -1,
                _ => i16::from(self.priority_byte(number)),
            })?;
        Some((first, self.priority(first)))
    }

    /// Priority of the most urgent active exception.
    pub fn active_priority(&self) -> i16 {
        self.active
            .common(&self.active)
            .map(|number| self.priority(number))
            .min()
            .unwrap_or(THREAD_PRIORITY)
    }
}
