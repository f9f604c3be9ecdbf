//! A record of the last faults with the first cause, and counts of limits that acted without a fault.

use core::fmt;

use super::{Fault, ResetCause};
use crate::decimal::Fixed;
use crate::units::DEG_PER_RAD;

/// A fault and the state at its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultRecord {
    /// The fault.
    pub fault: Fault,
    /// Whether it occurred before the last reset.
    pub before_reset: bool,
    /// Time since boot, s.
    pub time_s: f32,
    /// Position by the encoder, rad.
    pub encoder_rad: f32,
    /// Position by the Hall sensor, rad.
    pub hall_rad: f32,
    /// Velocity, rad/s.
    pub velocity_rad_s: f32,
    /// Commanded torque, N m at the motor.
    pub torque_nm: f32,
    /// Motor current, A.
    pub current_a: f32,
    /// Duty of the bridge, -1 to 1.
    pub duty: f32,
}

/// Number of a flag bit beside the fault number.
const BEFORE_RESET: u32 = 8;

/// Number of words of a record in memory that survives a reset.
pub const WORDS_PER_RECORD: usize = 8;

impl FaultRecord {
    /// Converts the record to words.
    pub fn to_words(&self) -> [u32; WORDS_PER_RECORD] {
        [
            self.fault as u32 | u32::from(self.before_reset) << BEFORE_RESET,
            self.time_s.to_bits(),
            self.encoder_rad.to_bits(),
            self.hall_rad.to_bits(),
            self.velocity_rad_s.to_bits(),
            self.torque_nm.to_bits(),
            self.current_a.to_bits(),
            self.duty.to_bits(),
        ]
    }

    /// Converts words to a record. Returns `None` for words that [`Self::to_words`] cannot produce.
    pub fn from_words(words: [u32; WORDS_PER_RECORD]) -> Option<Self> {
        let [
            fault,
            time_s,
            encoder_rad,
            hall_rad,
            velocity_rad_s,
            torque_nm,
            current_a,
            duty,
        ] = words;
        Some(Self {
            fault: *Fault::ALL.get((fault & !(1 << BEFORE_RESET)) as usize)?,
            before_reset: fault >> BEFORE_RESET == 1,
            time_s: f32::from_bits(time_s),
            encoder_rad: f32::from_bits(encoder_rad),
            hall_rad: f32::from_bits(hall_rad),
            velocity_rad_s: f32::from_bits(velocity_rad_s),
            torque_nm: f32::from_bits(torque_nm),
            current_a: f32::from_bits(current_a),
            duty: f32::from_bits(duty),
        })
    }
}

impl fmt::Display for FaultRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.before_reset {
            f.write_str("before the reset, ")?;
        }
        write!(f, "{} s: {}", Fixed(self.time_s, 4), self.fault)?;
        write!(
            f,
            " (position {} deg, hall {} deg, {} deg/s",
            Fixed(self.encoder_rad * DEG_PER_RAD, 2),
            Fixed(self.hall_rad * DEG_PER_RAD, 2),
            Fixed(self.velocity_rad_s * DEG_PER_RAD, 0),
        )?;
        write!(
            f,
            ", torque {} mN m, current {} A, duty {})",
            Fixed(self.torque_nm * 1e3, 2),
            Fixed(self.current_a, 3),
            Fixed(self.duty, 3)
        )
    }
}

/// The last faults, oldest first. The first fault since the last clear is the cause and is always kept. A fault that is
/// reported again counts once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaultLog {
    records: [Option<FaultRecord>; Self::CAPACITY],
    length: usize,
    /// Index of the first fault since the last clear.
    first: usize,
    revision: u32,
    /// Cause of the last reset, if known.
    pub reset: Option<ResetCause>,
}

impl FaultLog {
    /// Largest number of faults that are kept.
    pub const CAPACITY: usize = 8;

    /// Adds `record`.
    pub fn push(&mut self, record: FaultRecord) {
        let since_clear = self
            .records
            .get(self.first..self.length)
            .unwrap_or_default();
        if since_clear
            .iter()
            .flatten()
            .any(|known| known.fault == record.fault)
        {
            return;
        }
        if self.length == Self::CAPACITY {
            if self.first == 0 {
                return;
            }
            self.records.rotate_left(1);
            self.length -= 1;
            self.first -= 1;
        }
        if let Some(place) = self.records.get_mut(self.length) {
            *place = Some(record);
            self.length += 1;
            self.revision = self.revision.wrapping_add(1);
        }
    }

    /// Marks the faults so far as cleared. The next fault is a first cause again.
    pub fn clear(&mut self) {
        self.first = self.length;
    }

    /// The faults, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &FaultRecord> {
        self.records.iter().take(self.length).flatten()
    }

    /// A number that changes with every fault.
    pub fn revision(&self) -> u32 {
        self.revision
    }

    /// Number of faults.
    pub fn len(&self) -> usize {
        self.length
    }

    /// Returns true if there are no faults.
    pub fn is_empty(&self) -> bool {
        self.length == 0
    }
}

/// A limit that acted, or a tolerated disturbance, without a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acted {
    /// A window of one millisecond at whose end the torque was limited.
    TorqueLimit,
    /// A window of one millisecond in which the duty was limited all the time.
    DutyLimit,
    /// A control period with a low pulse of nFAULT that was too short to count.
    BridgeGlitch,
    /// A control period in which the serial port detected noise but still received the byte.
    SerialNoise,
}

/// Number of times that each limit acted. The counts wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters([u32; 4]);

impl Counters {
    /// All counts, with their names.
    pub const NAMES: [(Acted, &'static str); 4] = [
        (Acted::TorqueLimit, "torque limited"),
        (Acted::DutyLimit, "duty limited"),
        (Acted::BridgeGlitch, "nFAULT glitch"),
        (Acted::SerialNoise, "serial noise"),
    ];

    /// Increments a count.
    #[inline]
    pub fn count(&mut self, acted: Acted) {
        if let Some(count) = self.0.get_mut(acted as usize) {
            *count = count.wrapping_add(1);
        }
    }

    /// The counts with this one replaced.
    pub fn with(mut self, acted: Acted, count: u32) -> Self {
        if let Some(place) = self.0.get_mut(acted as usize) {
            *place = count;
        }
        self
    }

    /// The count of `acted`.
    pub fn of(&self, acted: Acted) -> u32 {
        self.0.get(acted as usize).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(fault: Fault) -> FaultRecord {
        FaultRecord {
            fault,
            before_reset: fault == Fault::Bridge,
            time_s: 1.5,
            encoder_rad: 0.1,
            hall_rad: -0.1,
            velocity_rad_s: 2.0,
            torque_nm: 0.01,
            current_a: 0.2,
            duty: -0.5,
        }
    }

    #[test]
    fn the_first_cause_is_kept_however_many_faults_follow() {
        let mut log = FaultLog::default();
        for fault in Fault::ALL {
            log.push(record(fault));
            log.push(record(fault));
        }
        assert_eq!(log.len(), FaultLog::CAPACITY);
        assert_eq!(
            log.iter().next().map(|kept| kept.fault),
            Some(Fault::ALL[0])
        );
        log.clear();
        log.push(record(Fault::Bridge));
        assert_eq!(log.len(), FaultLog::CAPACITY);
        assert_eq!(
            log.iter().last().map(|kept| kept.fault),
            Some(Fault::Bridge)
        );
        assert_eq!(
            log.iter().next().map(|kept| kept.fault),
            Some(Fault::ALL[1])
        );
    }

    #[test]
    fn a_record_survives_conversion_to_words_and_invalid_words_are_refused() {
        for fault in Fault::ALL {
            let words = record(fault).to_words();
            assert_eq!(FaultRecord::from_words(words), Some(record(fault)));
        }
        assert_eq!(FaultRecord::from_words([u32::MAX; WORDS_PER_RECORD]), None);
    }
}
