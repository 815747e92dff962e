//! The numbers of objects and of nodes of the support graph.

/// Number of an object in the label image: 1, 2, .. by descending objectness, then descending pixel count, then first pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u16);

/// Number of a node in a [`SupportGraph`](crate::discovery::SupportGraph), counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub u32);
