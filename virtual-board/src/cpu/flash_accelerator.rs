//! Wait times of the flash: the adaptive accelerator of an STM32F4 (reference manual RM0090, embedded flash interface).
//!
//! Flash is read in lines of 128 bits. A read takes the wait states set in FLASH_ACR. The instruction cache keeps 64 lines,
//! the data cache 8. The least recently used line is replaced. With prefetch, the next line is read while the present one
//! executes. The manual does not define associativity and arbitration. The model assumes fully associative caches, and no
//! conflict between instruction and data reads.

use super::FlashTiming;

const NO_LINE: u32 = u32::MAX;

/// State of the accelerator.
#[derive(Debug, Clone)]
pub struct FlashAccelerator {
    instructions: Cache,
    data: Cache,
    prefetched: u32,
    prefetched_at: u64,
}

impl Default for FlashAccelerator {
    fn default() -> Self {
        Self {
            instructions: Cache::new(64),
            data: Cache::new(8),
            prefetched: NO_LINE,
            prefetched_at: 0,
        }
    }
}

impl FlashAccelerator {
    /// Core cycles of waiting for the fetch of `line` (address / 16) at `cycle`.
    pub fn fetch(&mut self, line: u32, cycle: u64, timing: FlashTiming) -> u32 {
        let wait_states = u32::from(timing.wait_states);
        if wait_states == 0 {
            return 0;
        }
        let wait = if timing.instruction_cache && self.instructions.holds(line, cycle) {
            0
        } else if line == self.prefetched {
            self.prefetched_at.saturating_sub(cycle) as u32
        } else {
            if timing.instruction_cache {
                self.instructions.keep(line, cycle);
            }
            wait_states
        };
        if timing.prefetch && self.prefetched != line + 1 {
            self.prefetched = line + 1;
            self.prefetched_at = cycle + u64::from(wait + wait_states) + 1;
        }
        wait
    }

    /// Core cycles of waiting for data of `line` at `cycle`.
    pub fn read(&mut self, line: u32, cycle: u64, timing: FlashTiming) -> u32 {
        let wait_states = u32::from(timing.wait_states);
        if wait_states == 0 || timing.data_cache && self.data.holds(line, cycle) {
            return 0;
        }
        if timing.data_cache {
            self.data.keep(line, cycle);
        }
        wait_states
    }
}

/// A cache that replaces the least recently used line.
#[derive(Debug, Clone)]
struct Cache {
    /// Index in `kept` of each flash line, or `NO_PLACE`.
    place: Vec<u8>,
    kept: Vec<(u32, u64)>,
    capacity: usize,
}

const NO_PLACE: u8 = u8::MAX;

impl Cache {
    fn new(capacity: usize) -> Self {
        Self {
            place: Vec::new(),
            kept: Vec::with_capacity(capacity),
            capacity,
        }
    }

    #[inline]
    fn holds(&mut self, line: u32, cycle: u64) -> bool {
        let place = self.place.get(index(line)).copied().unwrap_or(NO_PLACE);
        match self.kept.get_mut(usize::from(place)) {
            Some((_, used)) => {
                *used = cycle;
                true
            }
            None => false,
        }
    }

    fn keep(&mut self, line: u32, cycle: u64) {
        let oldest = if self.kept.len() < self.capacity {
            self.kept.push((line, cycle));
            self.kept.len() - 1
        } else {
            let oldest = (0..self.kept.len())
                .min_by_key(|&place| self.kept[place].1)
                .unwrap_or(0);
            let (gone, _) = std::mem::replace(&mut self.kept[oldest], (line, cycle));
            self.place[index(gone)] = NO_PLACE;
            oldest
        };
        if self.place.len() <= index(line) {
            self.place.resize(index(line) + 1, NO_PLACE);
        }
        self.place[index(line)] = oldest as u8;
    }
}

/// Number of a line within one megabyte of flash.
fn index(line: u32) -> usize {
    (line & 0xFFFF) as usize
}
