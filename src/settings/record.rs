//! Settings as bytes that a later version still understands: of each its name, as a hash, and its value.

use super::{FIELDS, Field, Settings};

/// Version of the format.
const VERSION: u8 = 1;

/// Bytes of a hash and of a value.
const WORD: usize = size_of::<u32>();

/// Bytes in front of the settings: the version, and how many settings follow.
const HEAD_BYTES: usize = 2;

/// Length of a record, bytes.
pub const RECORD_BYTES: usize = HEAD_BYTES + FIELDS.len() * 2 * WORD;

/// What a record holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recalled {
    /// The settings; one that the record does not have is as by default.
    pub settings: Settings,
    /// How many values were left out: settings that there are no more, or values that they may not have any more.
    pub left_out: usize,
}

/// The record of these settings.
pub fn record(settings: &Settings) -> [u8; RECORD_BYTES] {
    let mut bytes = [0; RECORD_BYTES];
    let (head, pairs) = bytes.split_at_mut(HEAD_BYTES);
    head.copy_from_slice(&[VERSION, FIELDS.len() as u8]);
    for (pair, field) in pairs.chunks_exact_mut(2 * WORD).zip(FIELDS) {
        let (name, value) = pair.split_at_mut(WORD);
        name.copy_from_slice(&hash(field).to_le_bytes());
        value.copy_from_slice(&field.read(settings).to_bits().to_le_bytes());
    }
    bytes
}

/// The settings of a record, whatever follows it; `None` if it is of a version that is not known.
pub fn recall(bytes: &[u8]) -> Option<Recalled> {
    let [VERSION, count, pairs @ ..] = bytes else {
        return None;
    };
    let mut settings = Settings::default();
    let mut left_out = 0;
    for pair in pairs.chunks_exact(2 * WORD).take(usize::from(*count)) {
        let (name, value) = pair.split_at(WORD);
        let value = f32::from_bits(word(value));
        let field = FIELDS.iter().find(|field| hash(field) == word(name));
        if field.is_none_or(|field| field.write(&mut settings, value).is_err()) {
            left_out += 1;
        }
    }
    Some(Recalled { settings, left_out })
}

fn word(bytes: &[u8]) -> u32 {
    u32::from_le_bytes(bytes.try_into().unwrap_or_default())
}

/// FNV-1a of a setting's name, which the record goes by.
fn hash(field: &Field) -> u32 {
    field.name.bytes().fold(0x811C_9DC5, |hash: u32, byte| {
        (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_recorded_is_recalled() {
        let mut settings = Settings::default();
        settings.set("kp", "0.0123").unwrap();
        settings.set("estimate.sensor", "hall").unwrap();
        let recalled = recall(&record(&settings)).unwrap();
        assert_eq!(
            recalled,
            Recalled {
                settings,
                left_out: 0
            }
        );
    }

    #[test]
    fn names_have_hashes_of_their_own() {
        for (place, field) in FIELDS.iter().enumerate() {
            assert!(
                FIELDS[..place]
                    .iter()
                    .all(|other| hash(other) != hash(field)),
                "{}",
                field.name
            );
        }
    }

    #[test]
    fn what_another_version_stored_is_taken_as_far_as_it_goes() {
        let mut bytes = record(&Settings::default());
        // The first setting has another name, the second a value that it may not have.
        bytes[1] = 3;
        bytes[2] ^= 1;
        bytes[14..18].copy_from_slice(&(-1.0_f32).to_bits().to_le_bytes());
        let recalled = recall(&bytes).unwrap();
        assert_eq!(recalled.settings, Settings::default());
        assert_eq!(recalled.left_out, 2);
        assert_eq!(recall(&[9; RECORD_BYTES]), None, "a version of the future");
        assert_eq!(recall(&[]), None);
    }
}
