//! The tiles, one function each. Those of a stage that was not recorded are none.

use colorous::Gradient;
use image::{Rgb, RgbImage};
use objecthood::{Raster, Segments};

use crate::distance::{Anchor, anchors, to_border};
use crate::labels::{self, Label};
use crate::objects::Objects;
use crate::palette::object_color;
use crate::region_colors::stage_colors;
use crate::support::tree::tree;
use crate::text::mix;
use crate::view::{NOTHING, View};

const DEPTH: Gradient = colorous::VIRIDIS;
const OBJECTNESS: Gradient = colorous::PLASMA;
/// Around the letters of what carries objects.
const CARRIER: Rgb<u8> = Rgb([225; 3]);

/// One of the pictures in the picture.
pub(crate) struct Tile {
    pub(crate) title: String,
    pub(crate) image: RgbImage,
    /// What the colours mean, if they mean a number.
    pub(crate) scale: Option<Scale>,
}

/// A range of numbers, shown as colours.
pub(crate) struct Scale {
    /// The colour at a share of the way from low to high.
    pub(crate) color: fn(f32) -> Rgb<u8>,
    pub(crate) low: String,
    pub(crate) high: String,
}

/// The image with the outlines of the objects.
pub(crate) fn color(view: &View<'_>) -> Tile {
    let image = view.paint(|u, v| view.objects.outline(u, v, view.line_px()).or_else(|| view.scenery(u, v)));
    let title = if view.has_color() { "colour" } else { "no colour, shaded" };
    Tile { title: title.to_owned(), image, scale: None }
}

/// Depth, from the second to the 98th percentile: one far pixel does not flatten the rest. What lies outside has the
/// colour of the end, and the number there then says so. What is near is bright, so that it stands out from the black
/// of missing depth.
pub(crate) fn depth(view: &View<'_>) -> Tile {
    let mut valid_m = view.valid_depths_m();
    valid_m.sort_unstable_by(f32::total_cmp);
    let image = match percentiles(&valid_m) {
        None => view.paint(|_, _| None),
        Some((near, far)) => view.paint(|u, v| {
            let z = view.depth_m(u, v)?;
            Some(shade(&DEPTH, if far > near { (far - z) / (far - near) } else { 0.5 }))
        }),
    };
    let scale = percentiles(&valid_m).map(|(near, far)| {
        let nearer = if valid_m.first() < Some(&near) { "≤ " } else { "" };
        let farther = if valid_m.last() > Some(&far) { "≥ " } else { "" };
        Scale {
            color: |share| shade(&DEPTH, 1.0 - share),
            low: format!("{nearer}{}", metres(near)),
            high: format!("{farther}{} m", metres(far)),
        }
    });
    Tile { title: "depth".to_owned(), image, scale }
}

/// The depths below which 2 % and 98 % of all lie, each rounded down to a depth of the frame.
pub(crate) fn percentiles(sorted_m: &[f32]) -> Option<(f32, f32)> {
    let at = |percent: usize| sorted_m.get(sorted_m.len().saturating_sub(1) * percent / 100).copied();
    at(2).zip(at(98))
}

/// Normals: x to the right is red, y upwards green, z towards the camera blue.
pub(crate) fn normals(view: &View<'_>) -> Option<Tile> {
    view.recording.normals.as_ref()?;
    let image = view.paint(|u, v| {
        let [x, y, z] = view.normal(u, v)?;
        Some(Rgb([x, -y, -z].map(|a| ((a + 1.0) * 127.5).round() as u8)))
    });
    Some(Tile { title: "normals".to_owned(), image, scale: None })
}

/// The regions of the first stage.
pub(crate) fn superpixels(view: &View<'_>) -> Option<Tile> {
    Some(regions(view, "superpixels", view.recording.superpixels.as_ref()?, view.recording.structure))
}

/// The regions of the second stage.
pub(crate) fn facets(view: &View<'_>) -> Option<Tile> {
    Some(regions(view, "facets", view.recording.facets.as_ref()?, view.recording.structure))
}

/// The regions of the third stage.
pub(crate) fn shapes(view: &View<'_>) -> Option<Tile> {
    Some(regions(view, "shapes", view.recording.shapes.as_ref()?, view.recording.structure.min(1)))
}

/// The objects by objectness; behind them, in grey, the regions that are none, by what carries them: the lighter, the
/// larger P(O). Those that carry an object have the letters under which they stand in the support tree.
pub(crate) fn objectness(view: &View<'_>) -> Tile {
    let regions = view.recording.supports.as_ref().map(|segments| view.labels(segments));
    let nodes = &view.discovery.support.nodes;
    let surface = |u: usize, v: usize| {
        let region = *regions.as_ref()?.get(u, v)?;
        let p_o = nodes.get(usize::try_from(region).ok()?)?.p_o;
        Some(Rgb([(60.0 + 120.0 * p_o.clamp(0.0, 1.0)) as u8; 3]))
    };
    let mut image = view.paint(|u, v| match view.object(u, v) {
        Some((_, depth)) if depth <= 1 => Some(NOTHING),
        Some((id, _)) => {
            let object = view.discovery.objects.get(usize::from(id) - 1);
            Some(shade(&OBJECTNESS, object.map_or(0.0, |o| o.objectness)))
        }
        None => surface(u, v),
    });
    if let Some(regions) = &regions {
        name_carriers(&mut image, view, regions);
    }
    let scale = Scale { color: |share| shade(&OBJECTNESS, share), low: "0".to_owned(), high: "1".to_owned() };
    Tile { title: "objectness".to_owned(), image, scale: Some(scale) }
}

/// Writes the letters of the regions that carry objects; region k is node k of the support graph.
fn name_carriers(image: &mut RgbImage, view: &View<'_>, regions: &Raster<i32>) {
    let names = view.forest.surface_names(view.discovery);
    let mut name_of = vec![0_u16; view.discovery.support.nodes.len()];
    for ((node, name), number) in view.forest.nodes.iter().zip(&names).zip(1..=u16::MAX) {
        name_of[node.node] = if name.is_empty() { 0 } else { number };
    }
    let carriers =
        regions.map(|&r| usize::try_from(r).ok().and_then(|r| name_of.get(r)).copied().unwrap_or(0));
    let label = |anchor: Anchor| {
        let text = names[usize::from(anchor.id) - 1].clone();
        Label { text, color: CARRIER, anchor }
    };
    let anchors = anchors(&carriers, &to_border(&carriers));
    labels::write(image, anchors.into_iter().map(label).collect());
}

/// The objects with their numbers, on the dimmed image.
pub(crate) fn objects(view: &View<'_>) -> Tile {
    let image = numbered(&view.objects, |u, v| view.scenery(u, v));
    Tile { title: format!("objects {}", view.discovery.objects.len()), image, scale: None }
}

/// A map of objects at the size of a tile, each with its number, on the dimmed `scenery`.
pub(crate) fn numbered(objects: &Objects, scenery: impl Fn(usize, usize) -> Option<Rgb<u8>>) -> RgbImage {
    let (width, height) = objects.size();
    let mut image = RgbImage::from_fn(width, height, |x, y| {
        let (u, v) = (x as usize, y as usize);
        match objects.at(u, v) {
            Some((_, depth)) if depth <= 1 => NOTHING,
            Some((id, _)) => object_color(id),
            None => scenery(u, v).map_or(NOTHING, |color| mix(NOTHING, color, 0.4)),
        }
    });
    labels::write(&mut image, objects.numbers());
    image
}

/// What stands on what, on `size` (columns, rows) pixels.
pub(crate) fn support(view: &View<'_>, size: (u32, u32)) -> Tile {
    let title = "support: on, in (blue), leans (orange), hidden (dashed)".to_owned();
    Tile { title, image: tree(view.discovery, &view.forest, size), scale: None }
}

/// The regions of a stage in colours that differ; the first of them, which are `structure`, in greys.
fn regions(view: &View<'_>, name: &str, segments: &Segments, structure: usize) -> Tile {
    let labels = view.labels(segments);
    let colors = stage_colors(&labels, segments.count(), structure);
    let image = view.paint(|u, v| colors[usize::try_from(*labels.get(u, v)?).ok()?]);
    Tile { title: format!("{name} {}", view.count(segments, structure)), image, scale: None }
}

fn shade(gradient: &Gradient, share: f32) -> Rgb<u8> {
    Rgb(gradient.eval_continuous(f64::from(share).clamp(0.0, 1.0)).into_array())
}

/// A length to the centimetre, or with an exponent where that says nothing: a wrong unit is seen at once.
fn metres(length_m: f32) -> String {
    if (0.01..1e4).contains(&length_m) { format!("{length_m:.2}") } else { format!("{length_m:.1e}") }
}

#[cfg(test)]
mod tests {
    use objecthood::discovery::{NodeId, NodeKind, SupportEdge, SupportGraph, SupportNode};
    use objecthood::{Discovery, Frame, ObjectId, Observer, Output};

    use super::*;
    use crate::palette::ink_on;
    use crate::recording::Recording;
    use crate::region_colors::STRUCTURE;
    use crate::testing;

    /// Every pixel of the 4 x 2 frame below is a block of so many pixels in a tile.
    const BLOCK: u32 = 80;

    /// The pixel in a block's upper left quarter: on no outline and on no digit.
    fn at(tile: &Tile, u: u32, v: u32) -> [u8; 3] {
        assert_eq!(tile.image.dimensions(), (4 * BLOCK, 2 * BLOCK));
        tile.image.get_pixel(u * BLOCK + 20, v * BLOCK + 20).0
    }

    /// ```text
    /// depth [m]   1 1 2 -      object   1 0 0 0      shape   0 1 1 2
    ///             1 1 2 3               1 2 0 0              0 3 1 1
    /// ```
    fn small_scene() -> (Frame, Recording, Discovery) {
        let depth_m = [1.0, 1.0, 2.0, f32::NAN, 1.0, 1.0, 2.0, 3.0];
        let color = testing::raster(4, 2, |i| [10 * i as u8, 100, 200]);
        let frame = testing::frame(testing::raster(4, 2, |i| depth_m[i]), Some(color));
        let mut discovery = testing::discovery(testing::raster(4, 2, |i| [1, 0, 0, 0, 1, 2, 0, 0][i]));

        let axes = [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0; 3]];
        let shapes = testing::segments(4, 2, |i| [0, 1, 1, 2, 0, 3, 1, 1][i]);
        let node = |p_o| SupportNode { kind: NodeKind::Surface, p_s: 0.0, p_o, height_m: 0.0, size_px: 1 };
        let nodes = [1.0, 0.5, 0.0, 1.0].map(node).to_vec();
        let mut recording = Recording::default();
        recording.observe(Output::Normals(&testing::raster(4, 2, |i| axes[i % 4])));
        recording.observe(Output::Superpixels((&testing::segments(4, 2, |i| i as i32 - 1)).into()));
        recording.observe(Output::Facets(&testing::segments(4, 2, |_| -1)));
        recording.observe(Output::Shapes((&shapes).into()));
        discovery.support = SupportGraph { nodes, edges: vec![] };
        recording.observe(Output::Support { graph: &discovery.support, regions: &shapes });
        (frame, recording, discovery)
    }

    #[test]
    fn the_tiles_of_a_small_scene() {
        let (frame, recording, discovery) = small_scene();
        let view = View::new(&frame, &recording, &discovery);

        let tile = color(&view);
        assert_eq!((at(&tile, 1, 0), at(&tile, 2, 1)), ([10, 100, 200], [60, 100, 200]));
        assert_eq!(at(&tile, 0, 0), [0, 100, 200], "the inside of an object shows the image");
        assert_eq!(tile.image.get_pixel(0, BLOCK).0, object_color(1).0, "its rim has its colour");
        assert_eq!(tile.image.get_pixel(BLOCK - 2, 40).0, [0; 3]);

        let tile = depth(&view);
        assert_eq!(at(&tile, 0, 0), DEPTH.eval_continuous(1.0).into_array());
        assert_eq!(at(&tile, 2, 0), DEPTH.eval_continuous(0.5).into_array());
        assert_eq!(at(&tile, 3, 1), DEPTH.eval_continuous(0.0).into_array());
        assert_eq!(at(&tile, 3, 0), [0; 3]);
        let scale = tile.scale.unwrap();
        assert_eq!((scale.low.as_str(), scale.high.as_str()), ("1.00", "3.00 m"));
        assert_eq!((scale.color)(0.0).0, at(&depth(&view), 0, 0));

        let tile = normals(&view).unwrap();
        assert_eq!([0, 1, 2].map(|u| at(&tile, u, 0)), [[128, 128, 255], [255, 128, 128], [128, 255, 128]]);
        assert_eq!(at(&tile, 3, 0), [0; 3]);

        let tile = superpixels(&view).unwrap();
        assert_eq!(
            tile.title, "superpixels 6",
            "neither the one without depth nor the pixel without a label"
        );
        assert_eq!((at(&tile, 0, 0), at(&tile, 3, 0)), ([0; 3], [0; 3]));
        let colors = [(1, 0), (2, 0), (0, 1), (1, 1), (2, 1), (3, 1)].map(|(u, v)| at(&tile, u, v));
        assert!(colors.iter().all(|c| *c != [0; 3]));
        assert!(colors[0] != colors[1] && colors[0] != colors[3] && colors[2] != colors[3], "{colors:?}");

        let tile = facets(&view).unwrap();
        assert_eq!(tile.title, "facets 0");
        assert!(tile.image.pixels().all(|p| *p == NOTHING));

        let tile = shapes(&view).unwrap();
        assert_eq!(tile.title, "shapes 3");
        assert_eq!((at(&tile, 1, 0), at(&tile, 0, 0)), (at(&tile, 3, 1), at(&tile, 0, 1)));
        assert_ne!(at(&tile, 0, 0), at(&tile, 1, 0));

        let tile = objectness(&view);
        assert_eq!(at(&tile, 0, 0), OBJECTNESS.eval_continuous(1.0).into_array());
        assert_eq!(at(&tile, 1, 1), OBJECTNESS.eval_continuous(0.5).into_array());
        assert_eq!((at(&tile, 1, 0), at(&tile, 3, 0)), ([120; 3], [0; 3]));

        let tile = objects(&view);
        assert_eq!(tile.title, "objects 2");
        assert_eq!((at(&tile, 0, 0), at(&tile, 1, 1)), (object_color(1).0, object_color(2).0));
        assert_eq!(at(&tile, 1, 0), [4, 40, 80], "the rest is the image, dimmed");
        assert_eq!(tile.image.get_pixel(0, 0).0, [0; 3], "a dark line sets objects apart");
    }

    #[test]
    fn structure_is_grey_and_not_counted() {
        let (frame, mut recording, discovery) = small_scene();
        recording.observe(Output::Structure((&testing::segments(4, 2, |i| (i as i32) - 6)).into()));
        let view = View::new(&frame, &recording, &discovery);
        let tile = superpixels(&view).unwrap();
        assert_eq!(tile.title, "superpixels 4", "of the six with depth two are structure");
        assert_eq!([at(&tile, 1, 0), at(&tile, 2, 0)], [[STRUCTURE[0]; 3], [STRUCTURE[1]; 3]]);
        let tile = shapes(&view).unwrap();
        assert_eq!((tile.title.as_str(), at(&tile, 0, 0)), ("shapes 2", [STRUCTURE[0]; 3]));
        assert_ne!(at(&tile, 1, 0), [STRUCTURE[1]; 3], "all structure is the first shape");
    }

    #[test]
    fn numbers_stand_on_their_objects() {
        let (frame, recording, discovery) = small_scene();
        let view = View::new(&frame, &recording, &discovery);
        let image = objects(&view).image;
        let inked = |id: u16| {
            let inside = |u: u32, v: u32| {
                view.object(u as usize, v as usize).is_some_and(|(object, depth)| object == id && depth > 1)
            };
            let ink = ink_on(object_color(id));
            image.enumerate_pixels().filter(|(u, v, p)| inside(*u, *v) && **p == ink).count()
        };
        assert!(inked(1) > 10 && inked(2) > 10, "{} {}", inked(1), inked(2));
    }

    #[test]
    fn what_was_not_recorded_is_left_out() {
        let (frame, _, discovery) = small_scene();
        let recording = Recording::default();
        let view = View::new(&frame, &recording, &discovery);
        for tile in [normals, superpixels, facets, shapes] {
            assert!(tile(&view).is_none());
        }
        assert_eq!(at(&objectness(&view), 1, 0), [0; 3]);
    }

    #[test]
    fn carriers_are_named_where_they_are() {
        let (frame, recording, mut discovery) = small_scene();
        let inked = |discovery: &Discovery| {
            let image = objectness(&View::new(&frame, &recording, discovery)).image;
            image
                .enumerate_pixels()
                .filter(|(.., p)| **p == CARRIER)
                .map(|(x, y, _)| (x, y))
                .collect::<Vec<_>>()
        };
        assert!(inked(&discovery).is_empty());
        // Object 2, shape 3, stands on shape 1, which lies to its right and above it.
        discovery.support.nodes[3].kind = NodeKind::Object { object: ObjectId(2) };
        discovery.support.edges = vec![SupportEdge::seen(NodeId(1), NodeId(3), 1)];
        let halo = inked(&discovery);
        assert!(!halo.is_empty());
        assert!(halo.iter().all(|&(x, y)| x >= BLOCK && (x >= 2 * BLOCK || y < BLOCK)), "{halo:?}");
    }

    /// The same depths by counting, for each, how many are smaller.
    #[test]
    fn percentiles_are_depths_with_so_many_below() {
        for n in [1_usize, 2, 3, 49, 50, 51, 99, 100, 101, 1000] {
            let mut depths: Vec<f32> = (0..n).map(|i| 0.5 + ((i * 7919) % 1009 / 3) as f32).collect();
            depths.sort_unstable_by(f32::total_cmp);
            let naive = |percent: usize| {
                let below = |z: f32| depths.iter().filter(|&&other| other < z).count();
                depths.iter().copied().filter(|&z| below(z) * 100 <= percent * (n - 1)).fold(0.0, f32::max)
            };
            assert_eq!(percentiles(&depths), Some((naive(2), naive(98))), "{n} depths");
        }
        assert_eq!(percentiles(&[]), None);
    }

    #[test]
    fn a_far_pixel_does_not_flatten_the_rest() {
        let depths = |i: usize| if i == 77 { 60.0 } else { 1.0 + (i % 100) as f32 / 100.0 };
        let frame = testing::frame(testing::raster(100, 80, depths), None);
        let (recording, discovery) =
            (Recording::default(), testing::discovery(testing::raster(100, 80, |_| 0)));
        let tile = depth(&View::new(&frame, &recording, &discovery));
        let scale = tile.scale.unwrap();
        assert_eq!((scale.low.as_str(), scale.high.as_str()), ("≤ 1.01", "≥ 1.98 m"));
        let pixel = |u: u32, v: u32| tile.image.get_pixel(4 * u + 1, 4 * v + 1).0;
        let ends = [1.0, 0.0].map(|share| DEPTH.eval_continuous(share).into_array());
        assert_eq!(
            [pixel(0, 5), pixel(1, 5), pixel(77, 0), pixel(99, 0)],
            [ends[0], ends[0], ends[1], ends[1]]
        );
        assert_ne!(pixel(50, 5), pixel(51, 5));
    }

    #[test]
    fn without_colour_the_surfaces_are_shaded() {
        let (frame, recording, _) = small_scene();
        let frame = testing::frame(frame.depth_m().clone(), None);
        let discovery = testing::discovery(testing::raster(4, 2, |_| 0));
        let tile = color(&View::new(&frame, &recording, &discovery));
        assert_eq!([0, 1, 3].map(|u| at(&tile, u, 0)), [[240; 3], [60; 3], [0; 3]]);
        assert_eq!(tile.title, "no colour, shaded");
    }

    #[test]
    fn a_flat_or_absurd_depth_has_a_scale() {
        for (z, low) in [(1.5, "1.50"), (1e13, "1.0e13"), (1e-30, "1.0e-30")] {
            let frame = testing::frame(testing::raster(3, 3, |i| if i == 4 { f32::NAN } else { z }), None);
            let (recording, discovery) =
                (Recording::default(), testing::discovery(testing::raster(3, 3, |_| 0)));
            let tile = depth(&View::new(&frame, &recording, &discovery));
            assert_eq!(tile.scale.unwrap().low, low);
            assert_eq!(tile.image.get_pixel(7, 7).0, DEPTH.eval_continuous(0.5).into_array());
            assert_eq!(*tile.image.get_pixel(160, 160), NOTHING);
        }
    }
}
