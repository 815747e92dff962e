//! The forest as a picture.

use image::{Rgb, RgbImage};
use objecthood::Discovery;
use objecthood::discovery::{NodeKind, SupportKind};

use crate::drawing::{Point, bar, dashes, disc, line};
use crate::palette::{ink_on, object_color};
use crate::support::forest::{Forest, Link};
use crate::support::layout::{Layout, layout};
use crate::support::legend;
use crate::text::Text;

const PAPER: Rgb<u8> = Rgb([245; 3]);
const INK: Rgb<u8> = Rgb([60; 3]);
/// To what something lies in, and to what it leans on.
const IN: Rgb<u8> = Rgb([30, 110, 200]);
const LEANS: Rgb<u8> = Rgb([215, 120, 20]);
const SURFACE: Rgb<u8> = Rgb([150; 3]);
/// Smaller letters are left out [px].
const LEAST_LETTERS_PX: f32 = 9.0;

/// How a node looks, and the numbers that are written beside it.
struct Look {
    color: Rgb<u8>,
    is_round: bool,
    name: String,
    numbers: Vec<f32>,
}

/// Draws a forest on `size` (columns, rows) pixels: objects as discs in their colours with their P(O) and P(S), whatever
/// else carries one as a grey bar with its name and P(S).
///
/// What carries stands below; lines lead to it, by kind in their colours, dashed where the contact is hidden, with their
/// confidence. Names and numbers for which there is no room are left out; where there are numbers, a legend says what they
/// mean.
pub(crate) fn tree(discovery: &Discovery, forest: &Forest, (width, height): (u32, u32)) -> RgbImage {
    let mut picture = RgbImage::from_pixel(width, height, PAPER);
    if forest.nodes.is_empty() {
        let text = Text::new("no objects", 15.0);
        text.draw(&mut picture, centered(&text, [width as f32 / 2.0, height as f32 / 2.0]), INK);
        return picture;
    }

    let above_legend = layout(forest, [width as f32, (height as f32 - legend::height_px(width)).max(1.0)]);
    let has_numbers = has_room_for_numbers(&above_legend);
    let layout = if has_numbers { above_legend } else { layout(forest, [width as f32, height as f32]) };
    let mut links: Vec<Link> = forest.links().collect();
    // Later lines hide earlier ones where they share a way: `on`, the commonest kind, comes last.
    links.sort_by_key(|link| (!link.edge.hidden, link.edge.kind == SupportKind::On));

    draw_links(&mut picture, forest, &links, &layout);
    if has_numbers {
        legend::draw(&mut picture, INK);
        write_confidences(&mut picture, forest, &links, &layout);
    }
    let names = forest.surface_names(discovery);
    for ((node, name), &center) in forest.nodes.iter().zip(&names).zip(&layout.centers) {
        let look = look(discovery, node.node, name);
        draw_node(&mut picture, &look, center, layout.radius_px);
        if has_numbers {
            write_numbers(&mut picture, &look, center, layout.radius_px);
        }
    }
    picture
}

/// Whether the line to a carrier is a branch of the tree; the others go straight across it.
fn is_branch(forest: &Forest, link: &Link) -> bool {
    forest.nodes[link.upper].parent.is_some_and(|parent| parent.lower == link.lower)
}

fn draw_links(picture: &mut RgbImage, forest: &Forest, links: &[Link], layout: &Layout) {
    let line_px = (layout.radius_px / 8.0).clamp(0.7, 2.5);
    for link in links {
        let ([lower_x, lower_y], [x, y]) = (layout.centers[link.lower], layout.centers[link.upper]);
        let branch_y = lower_y - layout.branch_px;
        let path: &[Point] = if is_branch(forest, link) {
            &[[lower_x, lower_y], [lower_x, branch_y], [x, branch_y], [x, y]]
        } else {
            &[[lower_x, lower_y], [x, y]]
        };
        match link.edge.hidden {
            true => dashes(picture, path, line_px, 3.0 * line_px, color(link.edge.kind)),
            false => line(picture, path, line_px, color(link.edge.kind)),
        }
    }
}

/// Writes on every line how sure it is.
fn write_confidences(picture: &mut RgbImage, forest: &Forest, links: &[Link], layout: &Layout) {
    let letters_px = (0.8 * digits_px(layout.radius_px)).max(LEAST_LETTERS_PX);
    for link in links {
        let ([lower_x, lower_y], [x, y]) = (layout.centers[link.lower], layout.centers[link.upper]);
        let text = Text::new(&format!("{:.2}", link.edge.confidence), letters_px);
        // Below the upper node, before the branch turns.
        let middle = match is_branch(forest, link) {
            true => {
                let branch_y = lower_y - layout.branch_px;
                [x + 0.6 * text.width as f32, (y + layout.radius_px + branch_y) / 2.0]
            }
            false => [(lower_x + x) / 2.0, (lower_y + y) / 2.0],
        };
        text.draw_with_halo(picture, centered(&text, middle), color(link.edge.kind), PAPER, 2);
    }
}

/// Writes the numbers of a node beside it, one above the other, about the height of its middle.
fn write_numbers(picture: &mut RgbImage, look: &Look, [x, y]: Point, radius_px: f32) {
    let digits_px = digits_px(radius_px);
    let first = 0.5 * (1.0 - look.numbers.len() as f32);
    for (k, number) in look.numbers.iter().enumerate() {
        let text = Text::new(&format!("{number:.2}"), digits_px);
        let middle = [x + 1.2 * radius_px + text.width as f32 / 2.0, y + (first + k as f32) * digits_px];
        text.draw_with_halo(picture, centered(&text, middle), INK, PAPER, 2);
    }
}

/// Height of the digits beside nodes of this radius [px].
fn digits_px(radius_px: f32) -> f32 {
    (0.7 * radius_px).clamp(LEAST_LETTERS_PX, 16.0)
}

fn has_room_for_numbers(layout: &Layout) -> bool {
    let number_px = Text::new("0.00", digits_px(layout.radius_px)).width as f32;
    0.5 * layout.radius_px + number_px <= layout.beside_px
}

/// The colour of the line to a carrier.
fn color(kind: SupportKind) -> Rgb<u8> {
    match kind {
        SupportKind::On => INK,
        SupportKind::In => IN,
        SupportKind::Leans => LEANS,
    }
}

/// One line for each kind of node.
fn look(discovery: &Discovery, node: usize, name: &str) -> Look {
    let node = &discovery.support.nodes[node];
    let (color, is_round, name, numbers) = match node.kind {
        NodeKind::Object { object } => {
            (object_color(object.0), true, object.0.to_string(), vec![node.p_o, node.p_s])
        }
        NodeKind::Structure { .. } | NodeKind::Surface => (SURFACE, false, name.to_owned(), vec![node.p_s]),
    };
    Look { color, is_round, name, numbers }
}

fn draw_node(picture: &mut RgbImage, look: &Look, center: Point, radius_px: f32) {
    let outline_px = (radius_px / 10.0).min(1.5);
    let r = radius_px - outline_px;
    if look.is_round {
        disc(picture, center, radius_px, INK);
        disc(picture, center, r, look.color);
    } else {
        bar(picture, center, [radius_px, 0.7 * radius_px], INK);
        bar(picture, center, [r, 0.7 * radius_px - outline_px], look.color);
    }
    let letters_px = radius_px * (2.4 / look.name.len() as f32).min(1.2);
    if letters_px >= LEAST_LETTERS_PX {
        let text = Text::new(&look.name, letters_px);
        text.draw(picture, centered(&text, center), ink_on(look.color));
    }
}

/// Where the box of a text goes so that its middle is at `center`.
fn centered(text: &Text, [x, y]: Point) -> (i64, i64) {
    ((x - text.width as f32 / 2.0).round() as i64, (y - text.height as f32 / 2.0).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    fn drawn(discovery: &Discovery, size: (u32, u32)) -> RgbImage {
        tree(discovery, &Forest::new(discovery), size)
    }

    fn pixels(picture: &RgbImage, color: Rgb<u8>) -> usize {
        picture.pixels().filter(|p| **p == color).count()
    }

    #[test]
    fn objects_have_their_colours_and_carriers_are_grey() {
        let discovery = testing::standing(3, &[1, 2], &[(0, 1, 9), (0, 2, 5), (1, 2, 4)]);
        let picture = drawn(&discovery, (640, 480));
        let disc = pixels(&picture, object_color(1));
        assert!(disc > 500 && disc.abs_diff(pixels(&picture, object_color(2))) < 200, "{disc}");
        assert!(pixels(&picture, SURFACE) > 300);
        let rows = |color| {
            picture.enumerate_pixels().filter(|(.., p)| **p == color).map(|(_, y, _)| y).collect::<Vec<_>>()
        };
        // The median, because the grey of a surface is also at the edges of letters. The layers share what the legend leaves.
        let heights = [SURFACE, object_color(1), object_color(2)].map(|c| rows(c)[rows(c).len() / 2]);
        let is_near = |(found, expected): (u32, u32)| found.abs_diff(expected) <= 5;
        let layer = ((480.0 - legend::height_px(640)) / 3.0) as u32;
        let middles = [5, 3, 1].map(|halves| halves * layer / 2);
        assert!(heights.into_iter().zip(middles).all(is_near), "{heights:?} {middles:?}");
    }

    #[test]
    fn lines_tell_kinds_and_hidden_contacts() {
        let mut discovery = testing::standing(4, &[1, 2, 3], &[(0, 1, 9), (0, 2, 9), (0, 3, 9)]);
        let inked = |discovery: &Discovery| {
            let picture = drawn(discovery, (640, 480));
            [INK, IN, LEANS].map(|color| pixels(&picture, color))
        };
        let plain = inked(&discovery);
        assert!(plain[0] > 500 && plain[1..] == [0, 0], "{plain:?}");
        discovery.support.edges[1].kind = SupportKind::In;
        discovery.support.edges[2].kind = SupportKind::Leans;
        let colored = inked(&discovery);
        assert!(colored[1] > 100 && colored[2] > 100, "{colored:?}");
        discovery.support.edges[1].hidden = true;
        let dashed = inked(&discovery);
        assert!(dashed[1] > 0 && dashed[1] < colored[1] * 4 / 5, "{dashed:?} {colored:?}");
    }

    #[test]
    fn any_number_of_objects_on_any_size() {
        for objects in [0, 1, 40, 200, 3000] {
            let numbers: Vec<u32> = (1..=objects).collect();
            let edges: Vec<_> = numbers.iter().map(|&k| (k / 3, k, k % 7)).collect();
            let discovery = testing::standing(objects + 1, &numbers, &edges);
            for size in [(1, 1), (320, 240), (640, 480), (2640, 240), (320, 960)] {
                let picture = drawn(&discovery, size);
                assert_eq!(picture, drawn(&discovery, size));
                let blank = picture.pixels().all(|p| *p == PAPER);
                assert!(!blank, "{objects} objects on {size:?}");
            }
        }
    }

    #[test]
    fn forty_objects_can_be_read() {
        let numbers: Vec<u32> = (1..=40).collect();
        let edges: Vec<_> = numbers.iter().map(|&k| (0, k, 1)).collect();
        let discovery = testing::standing(41, &numbers, &edges);
        let Layout { radius_px, .. } = layout(&Forest::new(&discovery), [640.0, 480.0]);
        assert!(radius_px * 1.2 >= LEAST_LETTERS_PX, "{radius_px}");
    }

    /// Nobody knew what the numbers were.
    /// Pixels of the letters of the legend, which stands where the nodes have numbers.
    fn legend_px(picture: &RgbImage) -> usize {
        let foot = picture.enumerate_pixels().filter(|(_, y, _)| *y as f32 > 480.0 - legend::height_px(640));
        foot.filter(|(x, _, p)| *x < 200 && **p == INK).count()
    }

    #[test]
    fn where_there_are_numbers_a_legend_says_what_they_are() {
        let foot = |objects: u32| {
            let numbers: Vec<u32> = (1..=objects).collect();
            let edges: Vec<_> = numbers.iter().map(|&k| (0, k, 1)).collect();
            let picture = drawn(&testing::standing(objects + 1, &numbers, &edges), (640, 480));
            legend_px(&picture)
        };
        assert!(foot(5) > 500, "{}", foot(5));
        assert_eq!(foot(200), 0, "no numbers, no legend");
    }

    #[test]
    fn numbers_are_written_where_there_is_room() {
        for (objects, expected) in [(1, true), (5, true), (8, true), (60, false), (200, false)] {
            let numbers: Vec<u32> = (1..=objects).collect();
            let edges: Vec<_> = numbers.iter().map(|&k| (0, k, 1)).collect();
            let discovery = testing::standing(objects + 1, &numbers, &edges);
            let picture = tree(&discovery, &Forest::new(&discovery), (640, 480));
            let has_numbers = legend_px(&picture) > 0;
            assert_eq!(has_numbers, expected, "{objects} objects");
            let at_border = |x: u32| x == 0 || x == 639;
            let cut_off = picture.enumerate_pixels().any(|(x, _, p)| at_border(x) && *p != PAPER);
            assert!(!(has_numbers && cut_off), "{objects} objects");
        }
    }
}
