//! Packs the maps that are asked for as the stages put them out, and measures the stages.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use objecthood::objectness::hypotheses::Hypothesis;
use objecthood::params::Contraction;
use objecthood::{Frame, Observer, Output, Stage};

use crate::label_map::labelled;
use crate::maps::{labels, map, normals};
use crate::pack::{Kind, Map};
use crate::votes::votes;

/// Watches a method at work on a frame.
pub(crate) struct Layers<'a> {
    frame: &'a Frame,
    votes_by: &'a Contraction,
    wanted: &'a BTreeSet<String>,
    /// The maps, in the order of the stages.
    pub(crate) maps: Vec<Map>,
    /// How long each stage took; next to nothing for those that did not run again.
    pub(crate) laps: Vec<(Stage, Duration)>,
    lap: Instant,
    /// Number of planes: the first regions of several stages.
    structure: usize,
}

impl<'a> Layers<'a> {
    pub(crate) fn new(frame: &'a Frame, votes_by: &'a Contraction, wanted: &'a BTreeSet<String>) -> Self {
        let (maps, laps) = (Vec::new(), Vec::new());
        Self { frame, votes_by, wanted, maps, laps, lap: Instant::now(), structure: 0 }
    }

    fn wants(&self, name: &str) -> bool {
        self.wanted.contains(name)
    }

    fn take(&mut self, output: Output<'_>) {
        let (frame, planes) = (self.frame, self.structure);
        match output {
            Output::Normals(map) if self.wants("normals") => self.maps.push(normals(map)),
            Output::Structure(map) => {
                let segments = map.segments();
                self.structure = segments.count();
                if self.wants("structure") {
                    self.maps.extend(labelled("structure", frame, &segments, segments.count()));
                }
            }
            Output::Superpixels(map) if self.wants("superpixels") => {
                self.maps.extend(labelled("superpixels", frame, &map.segments(), planes));
            }
            Output::Facets(segments) if self.wants("facets") => {
                self.maps.extend(labelled("facets", frame, segments, planes));
            }
            Output::Borders { facets, evidence } if self.wants("votes") => {
                self.maps.push(votes(facets, evidence, self.votes_by));
            }
            Output::Shapes(map) if self.wants("shapes") => {
                self.maps.extend(labelled("shapes", frame, &map.segments(), planes.min(1)));
            }
            Output::Clusters { facets, .. } if self.wants("filled") => {
                self.maps.extend(labelled("filled", frame, &facets.segments, planes));
            }
            Output::Support { regions, .. } if self.wants("clusters") => {
                self.maps.extend(labelled("clusters", frame, regions, planes));
            }
            Output::Hypotheses(hypotheses) if self.wants("objectness") => {
                self.maps.push(objectness(frame, hypotheses));
            }
            Output::Objects(discovery) if self.wants("objects") => {
                self.maps.push(labels("objects", &discovery.labels));
            }
            _ => {}
        }
    }
}

impl Observer for Layers<'_> {
    fn observe(&mut self, output: Output<'_>) {
        self.laps.push((output.stage(), self.lap.elapsed()));
        self.take(output);
        self.lap = Instant::now();
    }
}

/// The objectness of every pixel's hypothesis: 1 = 0, 255 = 1; 0 where there is no hypothesis.
fn objectness(frame: &Frame, hypotheses: &[Hypothesis]) -> Map {
    let (width, height) = frame.size();
    let mut bytes = vec![0; width * height];
    for hypothesis in hypotheses {
        let step = 1 + (254.0 * hypothesis.objectness).round() as u8;
        hypothesis.pixels.iter().for_each(|&i| bytes[i] = step);
    }
    map("objectness", Kind::U8, frame.size(), bytes)
}
