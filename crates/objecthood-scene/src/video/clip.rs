//! What happens in a video.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, choices};

/// A kind of videos.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Clip {
    /// Nothing moves but the camera.
    Static,
    /// A table with nothing on it.
    Empty,
    /// A hand picks a thing up, carries it and places it elsewhere.
    Pick,
    /// One of two boxes that stand flush is pushed along the other.
    PushFlush,
    /// What hid the middle of a long thing is taken away.
    Occluder,
    /// A ball is thrown onto the table and bounces.
    Throw,
    /// A hand lifts a thing and lets it fall.
    Drop,
    /// A ball rolls over the table, and sometimes off it.
    Roll,
    /// Two things that look alike are carried past each other.
    Twins,
    /// Boxes are put on each other.
    Stack,
    /// A stack is taken apart.
    Unstack,
    /// The lid of a box is opened.
    Lid,
    /// A drawer is pulled out.
    Drawer,
    /// A bowl is moved with what lies in it.
    Bowl,
    /// A thing is put into a bowl.
    PutIn,
    /// A cup is emptied onto the table.
    Pour,
    /// A hand sweeps small things together.
    Sweep,
    /// Two hands do different things at the same time.
    TwoAgents,
    /// A soft toy of two balls is moved.
    SoftToy,
    /// Someone walks by behind the table.
    Walker,
}

impl Clip {
    /// Every kind there is.
    pub const ALL: [Self; 20] = [
        Self::Static,
        Self::Empty,
        Self::Pick,
        Self::PushFlush,
        Self::Occluder,
        Self::Throw,
        Self::Drop,
        Self::Roll,
        Self::Twins,
        Self::Stack,
        Self::Unstack,
        Self::Lid,
        Self::Drawer,
        Self::Bowl,
        Self::PutIn,
        Self::Pour,
        Self::Sweep,
        Self::TwoAgents,
        Self::SoftToy,
        Self::Walker,
    ];

    /// Its name, as [`FromStr`] reads it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Static => "static",
            Self::Empty => "empty",
            Self::Pick => "pick",
            Self::PushFlush => "push-flush",
            Self::Occluder => "occluder",
            Self::Throw => "throw",
            Self::Drop => "drop",
            Self::Roll => "roll",
            Self::Twins => "twins",
            Self::Stack => "stack",
            Self::Unstack => "unstack",
            Self::Lid => "lid",
            Self::Drawer => "drawer",
            Self::Bowl => "bowl",
            Self::PutIn => "put-in",
            Self::Pour => "pour",
            Self::Sweep => "sweep",
            Self::TwoAgents => "two-agents",
            Self::SoftToy => "soft-toy",
            Self::Walker => "walker",
        }
    }
}

impl fmt::Display for Clip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Clip {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::ALL
            .into_iter()
            .find(|clip| clip.name() == name)
            .ok_or_else(|| Error::UnknownClip { name: name.to_owned(), known: choices(Self::ALL) })
    }
}
