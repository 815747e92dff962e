//! Who stands on what.

/// How two solids touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum ContactKind {
    /// The upper rests on the lower.
    StandsOn,
    /// The upper is tilted and held by the lower.
    LeansOn,
    /// The upper rests in the cavity of the lower.
    LiesIn,
    /// They stand side by side.
    Touches,
}

/// Two solids that touch.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Contact {
    /// Instance number of the one that is held; of the later placed one when neither is.
    pub upper: u16,
    /// Instance number of the one that holds.
    pub lower: u16,
    /// How.
    pub kind: ContactKind,
    /// A point in which they touch, in the frame of the world (m); they may touch in others too.
    pub point_m: [f64; 3],
    /// Unit normal there, from the lower to the upper.
    pub normal: [f64; 3],
}
