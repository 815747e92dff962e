//! The support graph: which region stands on which.

use crate::discovery::ids::{NodeId, ObjectId};

/// The kind of a node of the support graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeKind {
    /// A shape that is an object.
    Object {
        /// Its number in the label image.
        object: ObjectId,
    },
    /// A shape that is no object: the table, or a shape of too little objectness.
    Surface,
    /// A structure plane (`context`).
    Structure {
        /// Its index among the structure planes.
        plane: usize,
    },
}

/// One shape in the support graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportNode {
    /// Its kind.
    pub kind: NodeKind,
    /// P(S), eq. 7: how well its surface can carry something, in [0, 1].
    pub p_s: f32,
    /// P(O), eq. 8: how probably it is an object, judged by its carriers, in [0, 1].
    pub p_o: f32,
    /// Mean height along up, relative to the camera (m).
    pub height_m: f32,
    /// Pixels with depth.
    pub size_px: usize,
}

/// The way in which one thing carries another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SupportKind {
    /// The upper stands on the lower. All edges of `paper` are of this kind.
    On,
    /// The upper stands or lies in the lower, below its rim.
    In,
    /// The upper is tilted, and the lower holds it from the side.
    Leans,
}

/// One node carries another (eq. 6).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportEdge {
    /// The carrier.
    pub lower: NodeId,
    /// The node that it carries.
    pub upper: NodeId,
    /// The way in which it carries it.
    pub kind: SupportKind,
    /// How sure it is that the lower carries the upper, in [0, 1]; 1 in `paper`, in `context` see
    /// [`build_forest`](crate::support::forest::build_forest).
    pub confidence: f32,
    /// Whether the contact is inferred and not seen.
    pub hidden: bool,
    /// Pairs of neighbouring points in contact there; 0 when it is hidden.
    pub contacts: u32,
}

impl SupportEdge {
    /// `upper` stands on `lower`, as `contacts` pairs of points show.
    pub fn seen(lower: NodeId, upper: NodeId, contacts: u32) -> Self {
        Self { lower, upper, kind: SupportKind::On, confidence: 1.0, hidden: false, contacts }
    }
}

/// The support graph: directed, without cycles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SupportGraph {
    /// The nodes; node k is region k of the label map from which the graph was built.
    pub nodes: Vec<SupportNode>,
    /// The edges, sorted by (lower, upper).
    pub edges: Vec<SupportEdge>,
}

impl SupportGraph {
    /// The nodes that carry each node, in ascending order. O(nodes + edges).
    pub fn parents(&self) -> Vec<Vec<NodeId>> {
        let named = self.edges.iter().map(|e| e.upper.0 as usize + 1).max().unwrap_or(0);
        let mut parents = vec![Vec::new(); self.nodes.len().max(named)];
        self.edges.iter().for_each(|e| parents[e.upper.0 as usize].push(e.lower));
        parents
    }

    /// How surely each node is carried, in [0, 1]: its P(O), halved when the confidence in its surest carrier is 0 (ours, because in a
    /// forest a floating thing has a carrier too). O(nodes + edges).
    pub(crate) fn carried(&self) -> Vec<f32> {
        let mut surest = vec![0.0_f32; self.nodes.len()];
        for edge in &self.edges {
            let surest = &mut surest[edge.upper.0 as usize];
            *surest = surest.max(edge.confidence);
        }
        self.nodes.iter().zip(surest).map(|(node, surest)| node.p_o * (1.0 + surest) / 2.0).collect()
    }

    /// The carrier of each node whose foot is hidden; `None` where a contact is seen, or nothing carries it. O(nodes + edges).
    pub(crate) fn hidden_carriers(&self) -> Vec<Option<NodeId>> {
        let mut carriers = vec![None; self.nodes.len()];
        for edge in self.edges.iter().filter(|edge| edge.hidden) {
            carriers[edge.upper.0 as usize] = Some(edge.lower);
        }
        for edge in self.edges.iter().filter(|edge| !edge.hidden) {
            carriers[edge.upper.0 as usize] = None;
        }
        carriers
    }
}
