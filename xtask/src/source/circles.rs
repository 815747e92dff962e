//! Circles in a graph of imports: what hangs together, and which few imports to remove.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Who imports whom, and where: the places of every edge, as text.
pub(crate) type Graph = BTreeMap<String, BTreeMap<String, Vec<String>>>;

/// One circle: every node imports the next one, the last the first.
pub(crate) type Circle = Vec<String>;

/// Groups of nodes that reach each other, the largest first.
pub(crate) fn knots(graph: &Graph) -> Vec<BTreeSet<String>> {
    let reach: BTreeMap<&String, BTreeSet<String>> =
        graph.keys().map(|node| (node, reachable(graph, node))).collect();
    let mut knots: Vec<BTreeSet<String>> = Vec::new();
    for (&node, reached) in &reach {
        if !reached.contains(node) || knots.iter().any(|knot| knot.contains(node)) {
            continue;
        }
        let mutual = |other: &&String| reach.get(other).is_some_and(|back| back.contains(node));
        knots.push(reached.iter().filter(mutual).cloned().collect());
    }
    knots.sort_by_key(|knot| std::cmp::Reverse(knot.len()));
    knots
}

/// Short circles, each with the import to remove from it; without those imports the graph has no circle.
///
/// Of the imports of a circle the one is removed that leaves fewest imports in circles, then the one with fewest places.
pub(crate) fn cuts(graph: &Graph) -> Vec<(Circle, (String, String))> {
    let mut graph = graph.clone();
    let mut cuts = Vec::new();
    while let Some(circle) = shortest(&graph) {
        let edges = circle.iter().zip(circle.iter().cycle().skip(1));
        let cost = |&(from, to): &(&String, &String)| {
            let mut without = graph.clone();
            remove(&mut without, from, to);
            (in_circles(&without), graph[from][to].len())
        };
        let Some((from, to)) = edges.min_by_key(cost) else { break };
        let (from, to) = (from.clone(), to.clone());
        remove(&mut graph, &from, &to);
        cuts.push((circle, (from, to)));
    }
    cuts
}

fn remove(graph: &mut Graph, from: &str, to: &str) {
    if let Some(targets) = graph.get_mut(from) {
        targets.remove(to);
    }
}

/// How many imports lie on circles.
fn in_circles(graph: &Graph) -> usize {
    let within = |knot: BTreeSet<String>| -> usize {
        knot.iter().map(|node| graph[node].keys().filter(|to| knot.contains(*to)).count()).sum()
    };
    knots(graph).into_iter().map(within).sum()
}

fn reachable(graph: &Graph, start: &String) -> BTreeSet<String> {
    let mut reached = BTreeSet::new();
    let mut open = vec![start];
    while let Some(node) = open.pop() {
        for next in graph.get(node).into_iter().flat_map(BTreeMap::keys) {
            if reached.insert(next.clone()) {
                open.push(next);
            }
        }
    }
    reached
}

fn shortest(graph: &Graph) -> Option<Circle> {
    graph.keys().filter_map(|node| shortest_through(graph, node)).min_by_key(Vec::len)
}

/// The shortest circle through `start`, by breadth-first search.
fn shortest_through(graph: &Graph, start: &String) -> Option<Circle> {
    let mut came_from: BTreeMap<&String, &String> = BTreeMap::new();
    let mut open = VecDeque::from([start]);
    while let Some(node) = open.pop_front() {
        for next in graph.get(node).into_iter().flat_map(BTreeMap::keys) {
            if next == start {
                let back = std::iter::successors(Some(node), |node| came_from.get(node).copied());
                let mut circle: Circle = back.cloned().collect();
                circle.reverse();
                return Some(circle);
            }
            if !came_from.contains_key(next) {
                came_from.insert(next, node);
                open.push_back(next);
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(edges: &[(&str, &str, usize)]) -> Graph {
        let mut graph = Graph::new();
        for &(from, to, places) in edges {
            graph.entry(to.to_owned()).or_default();
            graph.entry(from.to_owned()).or_default().insert(to.to_owned(), vec![String::new(); places]);
        }
        graph
    }

    #[test]
    fn a_graph_without_circles_has_no_knot() {
        let graph = graph(&[("a", "b", 1), ("a", "c", 1), ("b", "d", 1), ("c", "d", 1)]);
        assert!(knots(&graph).is_empty() && cuts(&graph).is_empty());
    }

    #[test]
    fn knots_are_what_reaches_itself() {
        let graph = graph(&[
            ("a", "b", 1),
            ("b", "a", 1),
            ("b", "c", 1),
            ("d", "e", 1),
            ("e", "f", 1),
            ("f", "d", 1),
        ]);
        let knots: Vec<String> = knots(&graph).iter().map(|k| k.iter().cloned().collect()).collect();
        assert_eq!(knots, ["def", "ab"]);
    }

    #[test]
    fn the_import_that_opens_most_circles_is_cut() {
        let graph = graph(&[("a", "b", 1), ("b", "c", 3), ("c", "a", 1), ("c", "b", 1), ("x", "a", 1)]);
        let [(circle, cut)] = &cuts(&graph)[..] else { panic!() };
        assert_eq!(circle.concat(), "bc");
        assert_eq!((cut.0.as_str(), cut.1.as_str()), ("b", "c"));
    }

    #[test]
    fn of_imports_that_open_as_much_the_one_with_fewest_places_is_cut() {
        let graph = graph(&[("a", "b", 3), ("b", "c", 1), ("c", "a", 2)]);
        let [(circle, cut)] = &cuts(&graph)[..] else { panic!() };
        assert_eq!(circle.concat(), "abc");
        assert_eq!((cut.0.as_str(), cut.1.as_str()), ("b", "c"));
    }
}
