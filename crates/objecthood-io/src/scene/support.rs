//! What stands on what.

use objecthood::discovery::{self, NodeKind};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What stands on what: a directed graph without cycles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// The shapes; others refer to them by index, from 0.
    pub nodes: Vec<SupportNode>,
    /// Which carries which, sorted by (lower, upper).
    pub edges: Vec<SupportEdge>,
}

/// A shape in the support graph.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportNode {
    /// Number of the object that it is; absent when it is none: the table, or what too little speaks for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "u16", range(min = 1))]
    pub object: Option<u16>,
    /// Index of the structure plane that it is; absent when it is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(with = "usize")]
    pub plane: Option<usize>,
    /// P(S): how well it can carry something.
    #[schemars(range(min = 0, max = 1))]
    pub p_s: f32,
    /// P(O): the probability that it is an object by what carries it.
    #[schemars(range(min = 0, max = 1))]
    pub p_o: f32,
    /// Mean height along up, relative to the camera (m).
    pub height_m: f32,
    /// Its pixels with depth (px).
    pub size_px: usize,
}

/// How one thing carries another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SupportKind {
    /// The upper stands on the lower; in `paper` whatever is higher.
    On,
    /// The upper stands or lies in the lower, below its rim.
    In,
    /// The upper is tilted and held by the lower from the side; it stands on something else besides.
    Leans,
}

/// One node carries another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportEdge {
    /// Node of the carrier.
    pub lower: u32,
    /// Node of what it carries.
    pub upper: u32,
    /// How.
    pub kind: SupportKind,
    /// How sure it is that this carries it: of what stands, the share of the contacts of its foot; of what lies in
    /// something, the share of directions in which the rim is seen; of what leans, the share of its sides that are tilted
    /// alike; of a hidden contact, half of that, and of what stands half the share of the foot that something hides. 1 in `paper`.
    #[schemars(range(min = 0, max = 1))]
    pub confidence: f32,
    /// Whether the contact itself is not seen.
    pub hidden: bool,
    /// Pairs of neighbouring points in contact there.
    pub contacts: u32,
}

impl From<&objecthood::discovery::SupportGraph> for Support {
    fn from(graph: &objecthood::discovery::SupportGraph) -> Self {
        let nodes = graph.nodes.iter().map(|node| SupportNode {
            object: match node.kind {
                NodeKind::Object { object } => Some(object.0),
                NodeKind::Structure { .. } | NodeKind::Surface => None,
            },
            plane: match node.kind {
                NodeKind::Structure { plane } => Some(plane),
                NodeKind::Object { .. } | NodeKind::Surface => None,
            },
            p_s: node.p_s,
            p_o: node.p_o,
            height_m: node.height_m,
            size_px: node.size_px,
        });
        let edges = graph.edges.iter().map(|edge| SupportEdge {
            lower: edge.lower.0,
            upper: edge.upper.0,
            kind: match edge.kind {
                discovery::SupportKind::On => SupportKind::On,
                discovery::SupportKind::In => SupportKind::In,
                discovery::SupportKind::Leans => SupportKind::Leans,
            },
            confidence: edge.confidence,
            hidden: edge.hidden,
            contacts: edge.contacts,
        });
        Self { nodes: nodes.collect(), edges: edges.collect() }
    }
}
