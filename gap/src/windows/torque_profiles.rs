//! Keeps the torque profiles of the drives that were requested last.

use host_sim::drive::Drive;
use host_sim::plant::TorqueProfile;
use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The torque profile in one window of a drive whose ratio is ±1.
#[derive(Debug)]
pub(crate) struct WindowTorque {
    pub(super) restart_s: f64,
    pub(super) samples: Range<usize>,
    /// The step from the last sample before the window to the restart.
    pub lead: TorqueProfile,
    /// The steps from the restart to each sample.
    pub steps: TorqueProfile,
}

/// The torque profiles of a series for the drives that were requested last. Most candidate models leave the drive unchanged.
#[derive(Debug, Default)]
pub(crate) struct TorqueProfiles(Mutex<Vec<(Drive, Blocks)>>);

/// The torque profiles of consecutive windows.
pub(super) type Block = Box<[WindowTorque]>;

/// The blocks of a series, each computed at its first request.
pub(super) type Blocks = Arc<[OnceLock<Block>]>;

/// Number of drives whose profiles are kept.
const MOST_DRIVES: usize = 4;

impl Clone for TorqueProfiles {
    /// A clone is empty because the inputs of the cloned series may be changed.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl TorqueProfiles {
    /// The profiles for a drive, with room for `blocks` blocks.
    pub(super) fn under(&self, drive: &Drive, blocks: usize) -> Blocks {
        // The list stays consistent even if a thread panicked while it held the lock.
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kept
            .iter()
            .position(|(d, s)| d == drive && s.len() == blocks);
        let entry = match known {
            Some(index) => kept.remove(index),
            None => (
                drive.clone(),
                (0..blocks).map(|_| OnceLock::new()).collect(),
            ),
        };
        let found = entry.1.clone();
        kept.push(entry);
        if kept.len() > MOST_DRIVES {
            kept.remove(0);
        }
        found
    }
}
