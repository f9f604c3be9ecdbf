//! The quantities that the board can send.

use core::fmt;

use serde::{Deserialize, Serialize};

/// A quantity of the control loop. Torque and duty are means over the row. All others are values at its beginning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Channel {
    /// Setpoint including the excitation: rad in position mode, N m at the motor in torque mode.
    Setpoint,
    /// Unfiltered position of the encoder, rad at the paddle.
    Encoder,
    /// Unfiltered position of the Hall sensor, rad at the paddle.
    Hall,
    /// Estimated velocity of the paddle, rad/s.
    Velocity,
    /// Commanded torque, N m at the motor: mean from this row to the next.
    Torque,
    /// Motor current, A.
    Current,
    /// Duty of the bridge, -1 to 1: mean from this row to the next.
    Duty,
    /// Mode of the controller: 0 off, 1 idle, 2 torque, 3 position.
    Mode,
    /// The latched fault: 0 for none, otherwise its number in the firmware's list, from 1.
    Fault,
}

impl Channel {
    /// All channels in the order of a row.
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

    /// Its name in the console and in columns of files.
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

    /// Unit of its values. Empty if there is none.
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

    /// Finds the channel with this name.
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

    /// The set with one more channel.
    #[must_use]
    pub const fn with(self, channel: Channel) -> Self {
        Self(self.0 | 1 << channel as u16)
    }

    /// Returns true if the set contains the channel.
    pub const fn has(self, channel: Channel) -> bool {
        self.0 >> channel as u16 & 1 == 1
    }

    /// The channels in the order of [`Channel::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Channel> {
        Channel::ALL
            .into_iter()
            .filter(move |channel| self.has(*channel))
    }

    /// Number of channels.
    pub const fn len(self) -> usize {
        (self.0 & Self::ALL.0).count_ones() as usize
    }

    /// Returns true if the set is empty.
    pub const fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Parses names of channels separated by commas: `encoder,torque`, or `all`.
    ///
    /// # Errors
    ///
    /// [`ChannelsError`] for an unknown name.
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

/// An unknown channel name.
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
