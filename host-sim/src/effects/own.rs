//! User-defined effects, which are added while the program runs.

use super::kind::PLAIN;
use super::{Channel, KINDS, Kind, Parameter};
use crate::plant::TorqueLaw;
use std::sync::{PoisonError, RwLock};

static OWN: RwLock<Vec<&'static Kind>> = RwLock::new(Vec::new());

/// Definition of a user-defined effect.
#[derive(Debug)]
pub struct OwnKind {
    /// Its name.
    pub name: String,
    /// Description in one sentence.
    pub about: String,
    /// Its equation.
    pub equation: String,
    /// Its parameters, in the order in which the law takes them.
    pub parameters: Vec<Parameter>,
    /// Its torque.
    pub law: Box<dyn TorqueLaw>,
}

/// An effect with this name exists.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("an effect is called `{0}` already; give yours another name")]
pub struct NameTaken(pub String);

/// Adds an effect until the program ends.
///
/// # Errors
///
/// [`NameTaken`].
pub fn add(own: OwnKind) -> Result<&'static Kind, NameTaken> {
    let mut all = OWN.write().unwrap_or_else(PoisonError::into_inner);
    let mut taken = KINDS.iter().chain(all.iter());
    if taken.any(|kind| kind.name == own.name) {
        return Err(NameTaken(own.name));
    }
    let kind: &'static Kind = Box::leak(Box::new(Kind {
        name: own.name.leak(),
        channel: Channel::Mechanics,
        about: own.about.leak(),
        equation: own.equation.leak(),
        parameters: own.parameters.leak(),
        law: Some(Box::leak(own.law)),
        ..PLAIN
    }));
    all.push(kind);
    Ok(kind)
}

/// Finds the added effect called `name`.
pub(super) fn find(name: &str) -> Option<&'static Kind> {
    let all = OWN.read().unwrap_or_else(PoisonError::into_inner);
    all.iter().copied().find(|kind| kind.name == name)
}
