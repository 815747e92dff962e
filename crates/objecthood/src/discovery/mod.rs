//! The result for one frame. These types depend on no stage, so every stage can use them.

pub(crate) mod ids;
pub(crate) mod join;
pub(crate) mod object;
pub(crate) mod parts;
pub(crate) mod support_graph;
pub(crate) mod up;

use std::fmt;

pub use self::ids::{NodeId, ObjectId};
pub use self::join::{Continuation, Join, JoinEvidence, JoinedPart, RimCircle};
pub use self::object::{Object, OrientedBox};
pub use self::parts::ObjectnessParts;
pub use self::support_graph::{NodeKind, SupportEdge, SupportGraph, SupportKind, SupportNode};
pub use self::up::{Up, UpSource};
pub use crate::estimates::Estimates;
pub use crate::noise::Noise;
pub use crate::planes::StructurePlane;
pub use crate::plausibility::Doubt;
pub use crate::raster::PixelBox;
use crate::raster::Raster;
use crate::surface::bands::Bands;

/// Everything found in one frame.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Discovery {
    /// The object of every pixel: 0 = none, else the number of an [`ObjectId`].
    pub labels: Raster<u16>,
    /// The objects; object k has index k - 1.
    pub objects: Vec<Object>,
    /// The direction against gravity.
    pub up: Up,
    /// Large planes of the scene: the table, the floor. In `paper` at most the dominant one.
    pub structure_planes: Vec<StructurePlane>,
    /// The structure plane of every pixel: 0 = none, k = the plane with index k - 1.
    pub structure: Raster<u16>,
    /// The support graph: which region stands on which.
    pub support: SupportGraph,
    /// What this frame, and those before it that were handed on, tell of the sensor and of gravity: the noise by which `context` set
    /// its tolerances, and up. `None` in `paper`.
    pub estimates: Option<Estimates>,
    /// Notices to the user about this result.
    pub notices: Vec<Notice>,
}

impl Discovery {
    /// A discovery with these objects and nothing else: no structure, no support, up as the camera is held. For tests of programs
    /// that read discoveries; the fields can be changed.
    pub fn new(objects: Vec<Object>, labels: Raster<u16>) -> Self {
        Self {
            objects,
            structure: labels.map(|_| 0),
            labels,
            up: Up { direction: [0.0, -1.0, 0.0], source: UpSource::Camera },
            structure_planes: Vec::new(),
            support: SupportGraph::default(),
            estimates: None,
            notices: Vec::new(),
        }
    }

    /// The discovery, with what is doubtful about its frame.
    pub(crate) fn with_doubts(mut self, doubts: &[Doubt]) -> Self {
        self.notices.extend(doubts.iter().map(|&doubt| Notice::Doubt(doubt)));
        self
    }
}

/// A surface on which things stand that faces away from up by more than this (degrees) tells that the sign of gravity is exchanged: a camera that
/// looks down by up to 60 degrees, whose gravity is given as if it were level.
const EXCHANGED_DEG: f32 = 120.0;

/// What to do about a wrong ground. A tilt and a roll of 0 are the defaults and tell nothing.
const HOW_HELD: &str = "say how the camera is held: --gravity 0,1,0 if it is level, --set gravity.tilt_deg=30 if it looks down by 30 degrees, \
                        --set gravity.roll_deg=.. if it is turned, or --gravity X,Y,Z if that was measured";

/// A notice: something that the user should know about a result. It is no error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Notice {
    /// No plane can be the ground, so up is the camera's own, by its tilt and roll.
    NoPlane,
    /// The frame has no colour, so depth alone decides.
    NoColor,
    /// The ground shows that the camera is turned about its optical axis.
    Turned {
        /// By this much clockwise (degrees): 90, 180 or 270.
        degrees: u16,
    },
    /// It is not clear which surface is the ground: another has half as many votes, or only the camera's attitude speaks for it.
    GroundInDoubt {
        /// Distance of the camera from the plane that was taken (m).
        distance_m: f32,
        /// Angle by which the camera looks down on it (degrees): 0 at the horizon, 90 straight down.
        tilt_deg: f32,
        /// Share of the pixels with depth that lie on it.
        share: f32,
    },
    /// No surface faces the measured direction up, so there is no ground.
    GravityMissed {
        /// Angle between that direction and the normal of the surface on which most stands (degrees).
        angle_deg: f32,
    },
    /// Along a border of the image nothing is measured, as registering depth to a colour image leaves it. What reaches there is cut.
    EmptyBands(Bands),
    /// Depth has a grid of small holes, as registering it to a larger colour image leaves. They were bridged.
    HoleGrid {
        /// Share of the pixels.
        share: f32,
    },
    /// Edges were smeared over several pixels, and were made steps again.
    Smeared {
        /// Share of the pixels with depth that lay on smeared edges.
        share: f32,
    },
    /// Something about the frame cannot be: its camera, its unit, or how its images lie.
    Doubt(Doubt),
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPlane => f.write_str(
                "no plane can be the ground: up is taken from the camera, whose tilt and roll are those of gravity.tilt_deg and \
                 gravity.roll_deg (if not set, it is held horizontally)",
            ),
            Self::NoColor => f.write_str("the frame has no colour: surfaces are told apart by depth alone"),
            Self::Turned { degrees } => write!(
                f,
                "the camera seems to be turned clockwise by about {degrees} degrees: up follows the plane on which most \
                 things stand (if that is wrong, {HOW_HELD})"
            ),
            Self::GroundInDoubt { distance_m, tilt_deg, share } => {
                let percent = 100.0 * share;
                write!(
                    f,
                    "it is not clear which surface is the ground: taken is the one {distance_m:.2} m from the camera, on which it \
                     looks down by {tilt_deg:.0} degrees, with {percent:.0} % of the depth (if that is wrong, {HOW_HELD})"
                )
            }
            Self::GravityMissed { angle_deg } if *angle_deg > EXCHANGED_DEG => write!(
                f,
                "the surface on which most things stand faces {angle_deg:.0} degrees away from up as --gravity has it: is the sign exchanged? An accelerometer \
                 at rest shows the opposite of the direction in which things fall"
            ),
            Self::GravityMissed { angle_deg } => write!(
                f,
                "no surface faces up as --gravity has it, so there is no ground: that on which most things stand faces {angle_deg:.0} degrees away \
                 from it (are the axes x right, y down, z forward?)"
            ),
            Self::EmptyBands(bands) => write!(
                f,
                "depth has bands without any measurement along the borders of the image: {bands}. Nothing is found there, and what reaches there is cut"
            ),
            Self::HoleGrid { share } => {
                let percent = 100.0 * share;
                write!(f, "depth has small holes all over ({percent:.0} % of the pixels), which were bridged")
            }
            Self::Smeared { share } => {
                let percent = 100.0 * share;
                write!(
                    f,
                    "edges in the depth are smeared over several pixels ({percent:.1} % of the pixels), and were made steps again"
                )
            }
            Self::Doubt(doubt) => doubt.fmt(f),
        }
    }
}
