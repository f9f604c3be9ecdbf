//! The torque of drives from window to window, remembered for those that were asked for last.

use host_sim::drive::Drive;
use host_sim::plant::Course;
use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The torque in one window, of a drive whose ratio is ±1.
#[derive(Debug)]
pub(crate) struct WindowTorque {
    pub(super) restart_s: f64,
    pub(super) samples: Range<usize>,
    /// One step, from the last sample before.
    pub lead: Course,
    /// From the restart on, to each sample.
    pub steps: Course,
}

/// The torque profiles of a series under the drives that were asked for last: most of what is tried leaves the drive as it is.
#[derive(Debug, Default)]
pub(crate) struct TorqueProfiles(Mutex<Vec<(Drive, Stretches)>>);

/// Of some windows that follow each other.
pub(super) type Stretch = Box<[WindowTorque]>;

/// Each as it is first asked for.
pub(super) type Stretches = Arc<[OnceLock<Stretch>]>;

/// Drives that are remembered, of series that are not longer than what models are fitted to.
const MOST_DRIVES: usize = 4;

impl Clone for TorqueProfiles {
    /// Of what may be changed nothing is known.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl TorqueProfiles {
    /// Those under a drive, with room for so many stretches.
    pub(super) fn under(&self, drive: &Drive, stretches: usize) -> Stretches {
        // What a thread that has panicked leaves is whole.
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kept
            .iter()
            .position(|(d, s)| d == drive && s.len() == stretches);
        let entry = match known {
            Some(place) => kept.remove(place),
            None => (
                drive.clone(),
                (0..stretches).map(|_| OnceLock::new()).collect(),
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
