//! A memory of faults, first cause first, and counts of limits that merely act.

use core::fmt;

use super::{Fault, ResetCause};
use crate::decimal::Fixed;
use crate::units::DEG_PER_RAD;

/// A fault, and what was there at its moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaultRecord {
    /// Which.
    pub fault: Fault,
    /// Whether it was before the last reset.
    pub before_reset: bool,
    /// When, s since boot.
    pub time_s: f32,
    /// Position by the encoder, rad.
    pub encoder_rad: f32,
    /// Position by the Hall sensor, rad.
    pub hall_rad: f32,
    /// Velocity, rad/s.
    pub velocity_rad_s: f32,
    /// Torque wanted, N m at the motor.
    pub torque_nm: f32,
    /// Motor current, A.
    pub current_a: f32,
    /// Share of the supply on the motor, -1 to 1.
    pub duty: f32,
}

/// Bit beside the fault's number.
const BEFORE_RESET: u32 = 8;

/// Words that a record takes in a memory that outlives a reset.
pub const WORDS_PER_RECORD: usize = 8;

impl FaultRecord {
    /// As words.
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

    /// From words; `None` for those that [`Self::to_words`] does not make.
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

/// The last faults, oldest first. Between two clears the first one, which is the cause, always stays; one that is
/// reported again counts once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaultLog {
    records: [Option<FaultRecord>; Self::CAPACITY],
    length: usize,
    /// Place of the first fault since the last clear.
    first: usize,
    revision: u32,
    /// Why the board began anew, where that is known.
    pub reset: Option<ResetCause>,
}

impl FaultLog {
    /// Most faults that are kept.
    pub const CAPACITY: usize = 8;

    /// Keeps `record`.
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

    /// The faults so far are dealt with; the next one is a cause of its own.
    pub fn clear(&mut self) {
        self.first = self.length;
    }

    /// Oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &FaultRecord> {
        self.records.iter().take(self.length).flatten()
    }

    /// Changes with every fault.
    pub fn revision(&self) -> u32 {
        self.revision
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.length
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.length == 0
    }
}

/// A limit that acted, or a disturbance that was overcome, without a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acted {
    /// A millisecond at whose end the torque was limited.
    TorqueLimit,
    /// A millisecond in which the duty was limited all the time.
    DutyLimit,
    /// A control period with a glitch of nFAULT that was too short to count.
    BridgeGlitch,
    /// A control period in which the serial port heard noise on a byte that it understood.
    SerialNoise,
}

/// How often each limit acted; wraps.
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

    /// Counts once more.
    #[inline]
    pub fn count(&mut self, acted: Acted) {
        if let Some(count) = self.0.get_mut(acted as usize) {
            *count = count.wrapping_add(1);
        }
    }

    /// With this count instead.
    pub fn with(mut self, acted: Acted, count: u32) -> Self {
        if let Some(place) = self.0.get_mut(acted as usize) {
            *place = count;
        }
        self
    }

    /// How often.
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
    fn the_first_cause_stays_however_many_follow() {
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
    fn a_record_outlives_its_words_and_no_other_words_make_one() {
        for fault in Fault::ALL {
            let words = record(fault).to_words();
            assert_eq!(FaultRecord::from_words(words), Some(record(fault)));
        }
        assert_eq!(FaultRecord::from_words([u32::MAX; WORDS_PER_RECORD]), None);
    }
}
