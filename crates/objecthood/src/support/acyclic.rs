//! Collects support edges and keeps them free of cycles.

use crate::discovery::support_graph::{SupportEdge, SupportKind};

/// Edges of a support graph without cycles.
pub(crate) struct Acyclic {
    edges: Vec<SupportEdge>,
    /// For each node, the nodes that it carries.
    carries: Vec<Vec<usize>>,
    /// Whether each node stands on or lies in something.
    is_held: Vec<bool>,
}

impl Acyclic {
    /// No edges among `nodes` nodes.
    pub(crate) fn new(nodes: usize) -> Self {
        Self { edges: Vec::new(), carries: vec![Vec::new(); nodes], is_held: vec![false; nodes] }
    }

    /// Whether a node stands on or lies in something.
    pub(crate) fn is_held(&self, node: usize) -> bool {
        self.is_held[node]
    }

    /// Adds an edge unless it closes a cycle. Returns whether it was added. O(nodes + edges).
    pub(crate) fn add(&mut self, edge: SupportEdge) -> bool {
        let (lower, upper) = (edge.lower.0 as usize, edge.upper.0 as usize);
        let mut open = vec![upper];
        let mut is_seen = vec![false; self.carries.len()];
        while let Some(node) = open.pop() {
            if node == lower {
                return false;
            }
            if !std::mem::replace(&mut is_seen[node], true) {
                open.extend(&self.carries[node]);
            }
        }
        self.is_held[upper] |= edge.kind != SupportKind::Leans;
        self.carries[lower].push(upper);
        self.edges.push(edge);
        true
    }

    /// P(O) of every node (eq. 8). Carriers are computed before the nodes that they carry. O(nodes + edges).
    pub(crate) fn hand_up(&self, p_s: &[f32]) -> Vec<f32> {
        let mut carriers = vec![0_usize; p_s.len()];
        self.carries.iter().flatten().for_each(|&upper| carriers[upper] += 1);
        let mut ready: Vec<usize> = (0..p_s.len()).filter(|&node| carriers[node] == 0).collect();
        let mut p_o = vec![0.0_f32; p_s.len()];
        while let Some(lower) = ready.pop() {
            for &upper in &self.carries[lower] {
                p_o[upper] = p_o[upper].max(p_s[lower]).max(p_o[lower]);
                carriers[upper] -= 1;
                if carriers[upper] == 0 {
                    ready.push(upper);
                }
            }
        }
        p_o
    }

    /// The edges, sorted by (lower, upper).
    pub(crate) fn into_sorted(mut self) -> Vec<SupportEdge> {
        self.edges.sort_by_key(|e| (e.lower, e.upper));
        self.edges
    }
}
