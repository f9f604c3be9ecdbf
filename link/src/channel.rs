//! The quantities that the board can send.

use core::fmt;

use serde::{Deserialize, Serialize};

/// A quantity of the control loop. All but the two means are the values at the beginning of their row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Channel {
    /// Reference with the test signal on it: rad in position mode, N m at the motor in torque mode.
    Setpoint,
    /// Position by the encoder, unfiltered, rad at the paddle.
    Encoder,
    /// Position by the Hall sensor, unfiltered, rad at the paddle.
    Hall,
    /// Velocity of the paddle by the controller's estimate, rad/s.
    Velocity,
    /// Torque that the controller asks for, N m at the motor: its mean from this row to the next.
    Torque,
    /// Motor current, A.
    Current,
    /// Share of the supply on the motor, -1 to 1: its mean from this row to the next.
    Duty,
    /// What the controller does: 0 off, 1 idle, 2 torque, 3 position.
    Mode,
    /// The latched fault: 0 for none, else its number in the firmware's list, from 1.
    Fault,
}

impl Channel {
    /// All channels, in the order in which a row has them.
    pub const ALL: [Self; 9] = [
        Self::Setpoint,
        Self::Encoder,
        Self::Hall,
        Self::Velocity,
        Self::Torque,
        Self::Current,
        Self::Duty,
        Self::Mode,
        Self::Fault,
    ];

    /// As the console and a file's columns call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Setpoint => "setpoint",
            Self::Encoder => "encoder",
            Self::Hall => "hall",
            Self::Velocity => "velocity",
            Self::Torque => "torque",
            Self::Current => "current",
            Self::Duty => "duty",
            Self::Mode => "mode",
            Self::Fault => "fault",
        }
    }

    /// Unit of its values; empty for none.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Setpoint => "rad or N m",
            Self::Encoder | Self::Hall => "rad",
            Self::Velocity => "rad/s",
            Self::Torque => "N m",
            Self::Current => "A",
            Self::Duty | Self::Mode | Self::Fault => "",
        }
    }

    /// The channel of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|channel| channel.name() == name)
    }
}

/// A set of channels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Channels(u16);

impl Channels {
    /// No channel.
    pub const NONE: Self = Self(0);
    /// All channels.
    pub const ALL: Self = Self((1 << Channel::ALL.len()) - 1);

    /// These and one more.
    #[must_use]
    pub const fn with(self, channel: Channel) -> Self {
        Self(self.0 | 1 << channel as u16)
    }

    /// Whether it is among them.
    pub const fn has(self, channel: Channel) -> bool {
        self.0 >> channel as u16 & 1 == 1
    }

    /// In the order of [`Channel::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Channel> {
        Channel::ALL
            .into_iter()
            .filter(move |channel| self.has(*channel))
    }

    /// How many there are.
    pub const fn len(self) -> usize {
        (self.0 & Self::ALL.0).count_ones() as usize
    }

    /// Whether there is none.
    pub const fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// The channels that a text names, with commas between them: `encoder,torque`, or `all`.
    ///
    /// # Errors
    /// [`ChannelsError`] for a name that no channel has.
    pub fn parse(text: &str) -> Result<Self, ChannelsError> {
        if text == "all" {
            return Ok(Self::ALL);
        }
        text.split(',').try_fold(Self::NONE, |channels, name| {
            Channel::named(name)
                .map(|channel| channels.with(channel))
                .ok_or(ChannelsError)
        })
    }
}

impl fmt::Display for Channels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, channel) in self.iter().enumerate() {
            let comma = if index > 0 { "," } else { "" };
            write!(f, "{comma}{}", channel.name())?;
        }
        Ok(())
    }
}

/// A name that no channel has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChannelsError;

impl fmt::Display for ChannelsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "no such channel: there are all, or of {} some with commas between them",
            Channels::ALL
        )
    }
}

impl core::error::Error for ChannelsError {}
