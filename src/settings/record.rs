//! Settings as bytes that later versions can still read: each setting has the hash of its name and its value.

use super::{FIELDS, Field, Settings};

/// Version of the format.
const VERSION: u8 = 1;

/// Number of bytes of a hash and of a value.
const WORD: usize = size_of::<u32>();

/// Number of bytes before the settings: the version and the number of settings.
const HEAD_BYTES: usize = 2;

/// Length of a record, bytes.
pub const RECORD_BYTES: usize = HEAD_BYTES + FIELDS.len() * 2 * WORD;

/// The content of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recalled {
    /// The settings. A setting that is not in the record has its default value.
    pub settings: Settings,
    /// Number of ignored values: of settings that no longer exist, or outside the present bounds.
    pub left_out: usize,
}

/// Encodes these settings as a record.
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

/// Decodes a record. Bytes after it are ignored. Returns `None` for an unknown version.
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

/// FNV-1a hash of a setting's name, which identifies it in a record.
fn hash(field: &Field) -> u32 {
    field.name.bytes().fold(0x811C_9DC5, |hash: u32, byte| {
        (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recorded_settings_are_recalled() {
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
    fn all_names_have_different_hashes() {
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
    fn a_record_of_another_version_is_recalled_as_far_as_it_matches() {
        let mut bytes = record(&Settings::default());
        // The first setting has an unknown name. The second has a value out of range.
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
