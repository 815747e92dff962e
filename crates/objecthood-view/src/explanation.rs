//! The picture of an explanation: the facet in question, the votes along its borders, and the facets that they join to it.

use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage};
use objecthood::explain::{BorderReport, Explanation, Outcome};
use objecthood::{Frame, Raster, Segments};

use crate::distance::{Anchor, anchors, to_border};
use crate::drawing::{Point, bar, disc};
use crate::grid::{sample, tile_size};
use crate::labels::{self, Label};
use crate::panels::Page;
use crate::text::{Text, mix};
use crate::tiles::Tile;
use crate::view::{NOTHING, resize};

/// The border votes for one shape, mostly folds against it, mostly steps against it, or it has no vote. Of Okabe and Ito's colours.
const FOR: Rgb<u8> = Rgb([0, 158, 115]);
const AGAINST: Rgb<u8> = Rgb([213, 94, 0]);
const STEP: Rgb<u8> = Rgb([86, 180, 233]);
const NO_VOTE: Rgb<u8> = Rgb([150; 3]);
/// The pixel that was asked for.
const ASKED: Rgb<u8> = Rgb([240, 228, 66]);
const OBJECT: Rgb<u8> = Rgb([255; 3]);
const INK: Rgb<u8> = Rgb([30; 3]);
const PAGE: Rgb<u8> = Rgb([255; 3]);
/// What stands for the colour of a frame that has none, where there is depth.
const GREY: [u8; 3] = [128; 3];
/// How much of the frame is left where it is dimmed.
const DIMMED: f32 = 0.4;
/// An enlarged part shows this much more than the facets it is about.
const MARGIN: f32 = 1.15;
/// The greatest enlargement.
const MOST_ENLARGED: usize = 6;

/// The frame, dimmed but for the facet of the pixel; the facet's borders in the colours of their votes; the facets beyond them outlined
/// and numbered; the object outlined. When all that is small, once more enlarged. Beside it what the colours mean, and the votes in
/// numbers.
///
/// `facets` and `labels` (0 = none) have the size of the frame, and the explanation is of them. O(pixels).
pub fn explanation(
    frame: &Frame,
    facets: &Segments,
    labels: &Raster<u16>,
    explanation: &Explanation,
) -> RgbImage {
    let canvas = Canvas::new(facets, labels, explanation);
    let grey = || frame.depth_m().map(|z| if z.is_nan() { NOTHING.0 } else { GREY });
    let color = frame.color().cloned().unwrap_or_else(grey);
    let mut image = resize(&color).unwrap_or_default();
    for (x, y, pixel) in image.enumerate_pixels_mut() {
        *pixel = canvas.paint(x as usize, y as usize, *pixel);
    }
    let (width, height) = frame.size();
    let size = tile_size(frame.size());
    let [u, v] = explanation.pixel;
    let at = [u as f32, v as f32].map(|x| x + 0.5);
    let asked = [at[0] * size.0 as f32 / width as f32, at[1] * size.1 as f32 / height as f32];

    let tile = |title: String, image| Tile { title, image, scale: None };
    let name = explanation.facet.map_or("no facet".to_owned(), |facet| format!("facet {}", facet.facet));
    let detail = canvas.detail();
    let mut tiles = Vec::new();
    if detail.factor > 1 {
        let mut enlarged = detail.of(&image);
        labels::write(&mut enlarged, canvas.numbers(&detail));
        mark(&mut enlarged, detail.place(asked));
        tiles.push(tile(format!("{name}, {} times enlarged", detail.factor), enlarged));
    } else {
        labels::write(&mut image, canvas.numbers(&detail));
    }
    mark(&mut image, asked);
    tiles.insert(0, tile(format!("pixel {u},{v}: {name}"), image));
    let size = (size.0 as u32, size.1 as u32);
    tiles.push(tile(in_words(explanation.outcome), legend(explanation, size)));
    Page::new(size, tiles.len(), tiles.len()).compose(&tiles)
}

/// Marks the pixel that was asked for.
fn mark(image: &mut RgbImage, at: Point) {
    disc(image, at, 6.0, NOTHING);
    disc(image, at, 4.5, ASKED);
}

/// A part of a tile that is shown enlarged.
struct Detail {
    left: u32,
    top: u32,
    /// Columns and rows of the part.
    size: (u32, u32),
    factor: u32,
}

impl Detail {
    /// The part around a box (left, top, right, bottom; the ends included) that enlarged by a whole number is as large as the tile.
    fn around([left, top, right, bottom]: [usize; 4], (width, height): (usize, usize)) -> Self {
        let fits = |factor: &usize| {
            let wide = (right - left) as f32 * MARGIN <= (width / factor) as f32;
            wide && (bottom - top) as f32 * MARGIN <= (height / factor) as f32
        };
        let factor = (2..=MOST_ENLARGED).rev().find(fits).unwrap_or(1);
        let size = ((width / factor).max(1), (height / factor).max(1));
        let start = |low: usize, high: usize, size: usize, all: usize| {
            ((low + high) / 2).saturating_sub(size / 2).min(all - size) as u32
        };
        Self {
            left: start(left, right, size.0, width),
            top: start(top, bottom, size.1, height),
            size: (size.0 as u32, size.1 as u32),
            factor: factor as u32,
        }
    }

    fn of(&self, image: &RgbImage) -> RgbImage {
        let (width, height) = self.size;
        let part = imageops::crop_imm(image, self.left, self.top, width, height).to_image();
        imageops::resize(&part, width * self.factor, height * self.factor, FilterType::Nearest)
    }

    /// Where a point of the tile is in the enlarged part.
    fn place(&self, [x, y]: Point) -> Point {
        let factor = self.factor as f32;
        [(x - self.left as f32) * factor, (y - self.top as f32) * factor]
    }
}

fn in_words(outcome: Outcome) -> String {
    match outcome {
        Outcome::NoDepth => "no depth".to_owned(),
        Outcome::NoFacet => "on no surface".to_owned(),
        Outcome::Structure { plane } => format!("structure plane {plane}"),
        Outcome::Background { .. } => "no object: background".to_owned(),
        Outcome::TooSmall => "no object: too small".to_owned(),
        Outcome::Unlikely => "no object: its objectness is too low".to_owned(),
        Outcome::Object { object } => format!("object {object}"),
    }
}

/// The colour of a border by its vote.
fn color_of(border: &BorderReport) -> Rgb<u8> {
    match border.vote_mm {
        None => NO_VOTE,
        Some(vote_mm) if vote_mm > 0.0 => FOR,
        Some(_) if border.stepped_mm > border.folded_mm => STEP,
        Some(_) => AGAINST,
    }
}

/// What is painted, at the size of a tile.
struct Canvas<'a> {
    facets: Raster<i32>,
    labels: Raster<u16>,
    explanation: &'a Explanation,
    own: i32,
    object: u16,
    /// Half the width of a border.
    reach: usize,
}

impl<'a> Canvas<'a> {
    fn new(facets: &Segments, labels: &Raster<u16>, explanation: &'a Explanation) -> Self {
        let facets = sample(facets.labels());
        Self {
            own: explanation.facet.map_or(Segments::NONE, |facet| facet.facet as i32),
            object: explanation.object.as_ref().and_then(|object| object.object).unwrap_or(0),
            reach: (facets.width().max(facets.height()) / 240).max(1),
            labels: sample(labels),
            facets,
            explanation,
        }
    }

    fn paint(&self, x: usize, y: usize, scenery: Rgb<u8>) -> Rgb<u8> {
        let facet = self.facets.get(x, y).copied().unwrap_or(Segments::NONE);
        let is_own = self.own >= 0 && facet == self.own;
        if is_own && let Some(border) = self.beyond(x, y, self.reach).and_then(|other| self.border(other)) {
            return color_of(border);
        }
        let label = self.labels.get(x, y).copied().unwrap_or(0);
        let ends = |reach| near(&self.labels, x, y, reach).any(|other| other != label);
        if label > 0 && label == self.object && ends(1) {
            return OBJECT;
        }
        let partner = self.border(facet).filter(|border| border.structure_plane.is_none());
        if let Some(border) = partner.filter(|_| self.beyond(x, y, 1).is_some()) {
            return color_of(border);
        }
        if is_own { scenery } else { mix(NOTHING, scenery, DIMMED) }
    }

    /// Another facet within `reach` pixels.
    fn beyond(&self, x: usize, y: usize, reach: usize) -> Option<i32> {
        let facet = *self.facets.get(x, y)?;
        near(&self.facets, x, y, reach).find(|&other| other >= 0 && other != facet)
    }

    /// The border of the facet with another one.
    fn border(&self, other: i32) -> Option<&'a BorderReport> {
        self.explanation.borders.iter().find(|border| border.facet as i32 == other)
    }

    /// The part with the facet and its neighbours that are no structure; all of it when there are none.
    fn detail(&self) -> Detail {
        let (width, height) = self.facets.size();
        let is_shown = |facet: i32| {
            let is_partner = |border: &BorderReport| border.structure_plane.is_none();
            facet >= 0 && (facet == self.own || self.border(facet).is_some_and(is_partner))
        };
        let mut shown: Option<[usize; 4]> = None;
        for (i, _) in self.facets.as_slice().iter().enumerate().filter(|(_, facet)| is_shown(**facet)) {
            let (x, y) = (i % width, i / width);
            let [left, top, right, bottom] = shown.unwrap_or([x, y, x, y]);
            shown = Some([left.min(x), top.min(y), right.max(x), bottom.max(y)]);
        }
        Detail::around(shown.unwrap_or([0, 0, width - 1, height - 1]), (width, height))
    }

    /// The numbers of the neighbours that are no structure, where they are in an enlarged part.
    fn numbers(&self, detail: &Detail) -> Vec<Label> {
        let free = self.explanation.borders.iter().filter(|border| border.structure_plane.is_none());
        let named: Vec<(u32, Rgb<u8>)> = free.map(|border| (border.facet, color_of(border))).collect();
        let place = |facet: i32| named.iter().position(|(name, _)| *name as i32 == facet);
        let map = self.facets.map(|&facet| place(facet).map_or(0, |k| k as u16 + 1));
        let label = |anchor: Anchor| {
            let (facet, color) = named[usize::from(anchor.id) - 1];
            let [u, v] = detail.place([anchor.u as f32, anchor.v as f32]).map(|x| x as usize);
            let anchor = Anchor { u, v, radius_px: anchor.radius_px * detail.factor as f32, ..anchor };
            Label { text: facet.to_string(), color, anchor }
        };
        anchors(&map, &to_border(&map)).into_iter().map(label).collect()
    }
}

/// The values within a square around a pixel, without those outside the raster.
fn near<T: Copy>(raster: &Raster<T>, x: usize, y: usize, reach: usize) -> impl Iterator<Item = T> + '_ {
    let range = move |k: usize| k.saturating_sub(reach)..=k + reach;
    range(y).flat_map(move |y| range(x).filter_map(move |x| raster.get(x, y).copied()))
}

/// What the colours mean, and below the votes as far as there is room.
fn legend(explanation: &Explanation, (width, height): (u32, u32)) -> RgbImage {
    let mut image = RgbImage::from_pixel(width, height, PAGE);
    let letters_px = (width as f32 / 30.0).clamp(11.0, 22.0);
    let meanings = [
        (Some(ASKED), "the pixel".to_owned()),
        (Some(FOR), "border that votes for one thing".to_owned()),
        (Some(AGAINST), "border that votes against: a valley, or a change of colour".to_owned()),
        (Some(STEP), "border that votes against: a step".to_owned()),
        (Some(NO_VOTE), "border with a structure plane: no vote".to_owned()),
        (Some(OBJECT), "outline of the object".to_owned()),
        (None, String::new()),
    ];
    let votes = explanation.borders.iter().map(|border| {
        let name = match border.structure_plane {
            Some(plane) => format!("plane {plane}"),
            None => format!("facet {}", border.facet),
        };
        let vote = border.vote_mm.map_or("no vote".to_owned(), |vote_mm| format!("{vote_mm:+.0} mm"));
        let end = match border.decision.as_ref().map(|decision| decision.yes) {
            // What votes keep apart another rule may join.
            Some(true) if border.vote_mm.is_some_and(|vote_mm| vote_mm < 0.0) => {
                ", one thing by another rule"
            }
            Some(true) => ", one thing",
            Some(false) => ", two things",
            None => "",
        };
        (Some(color_of(border)), format!("{name}: {vote}{end}"))
    });
    let line_px = 1.5 * letters_px;
    for (k, (color, text)) in meanings.into_iter().chain(votes).enumerate() {
        let middle = (k as f32 + 0.8) * line_px;
        if middle + line_px > height as f32 {
            break;
        }
        if let Some(color) = color {
            let (center, half) = ([letters_px, middle], letters_px * 0.35);
            bar(&mut image, center, [half + 1.0; 2], INK);
            bar(&mut image, center, [half; 2], color);
        }
        let text = Text::new(&text, letters_px);
        let top = (middle + letters_px * 0.35) as i64 - text.ascent;
        text.draw(&mut image, ((2.0 * letters_px) as i64, top), INK);
    }
    image
}

#[cfg(test)]
mod tests {
    use objecthood::explain::FacetReport;

    use super::*;
    use crate::testing;

    fn border(facet: u32, folded_mm: f64, stepped_mm: f64, vote_mm: Option<f64>) -> BorderReport {
        BorderReport {
            facet,
            structure_plane: vote_mm.is_none().then_some(1),
            mean_angle_deg: None,
            gap_quanta: 0.0,
            gap_mm: 0.0,
            folded_mm,
            stepped_mm,
            seam_mm: 0.0,
            color_change_mm: 0.0,
            vote_mm,
            decision: None,
        }
    }

    /// Five upright stripes of 64 px, facets 0 to 4, of which facet 2 is asked for; 1 and 2 are object 1.
    fn striped() -> (Frame, Segments, Raster<u16>, Explanation) {
        let stripe = |i: usize| i % 320 / 64;
        let color = testing::raster(320, 240, |_| [200; 3]);
        let frame = testing::frame(testing::raster(320, 240, |_| 1.0), Some(color));
        let facets = testing::segments(320, 240, |i| stripe(i) as i32);
        let labels = testing::raster(320, 240, |i| u16::from((1..=2).contains(&stripe(i))));
        let facet = FacetReport {
            facet: 2,
            size_px: 64 * 240,
            residual_quanta: 0.0,
            mean_residual_quanta: 0.0,
            structure_plane: None,
        };
        let explanation = Explanation {
            pixel: [160, 120],
            depth_m: Some(1.0),
            outcome: Outcome::Object { object: 1 },
            facet: Some(facet),
            kept: None,
            borders: vec![border(1, 30.0, 0.0, Some(30.0)), border(3, 1.0, 20.0, Some(-3.0))],
            way: Vec::new(),
            near_misses: Vec::new(),
            object: None,
        };
        (frame, facets, labels, explanation)
    }

    #[test]
    fn the_facet_is_bright_and_its_borders_have_the_colours_of_their_votes() {
        let (frame, facets, labels, explained) = striped();
        let picture = explanation(&frame, &facets, &labels, &explained);
        let (left, top) = Page::new((320, 240), 2, 2).corner(0);
        let at = |u: u32| *picture.get_pixel(left + u, top + 40);
        assert_eq!(at(140), Rgb([200; 3]), "the facet is as it was");
        assert_eq!(at(20), mix(NOTHING, Rgb([200; 3]), DIMMED), "the rest is dimmed");
        assert_eq!((at(128), at(191)), (FOR, STEP));
        assert_eq!((at(127), at(192)), (FOR, STEP), "the partners are outlined");
        assert_eq!(*picture.get_pixel(left + 160, top + 120), ASKED);
        assert_eq!(picture, explanation(&frame, &facets, &labels, &explained));
    }

    #[test]
    fn what_is_small_is_shown_enlarged() {
        let whole = (320, 240);
        let detail = Detail::around([100, 100, 139, 129], whole);
        assert_eq!((detail.factor, detail.size), (6, (53, 40)));
        assert!(detail.left <= 100 && detail.left + 53 > 139 && detail.top <= 100 && detail.top + 40 > 129);
        let corner = Detail::around([300, 0, 319, 9], whole);
        assert_eq!((corner.left, corner.top), (320 - 53, 0), "it stays within the tile");
        let [x, y] = detail.place([119.0, 114.0]);
        assert!((x - 159.0).abs() < 10.0 && (y - 120.0).abs() < 10.0, "{x} {y}");
        let large = Detail::around([0, 0, 319, 239], whole);
        assert_eq!((large.factor, large.size, large.left, large.top), (1, whole_u32(whole), 0, 0));
        assert_eq!(Detail::around([0, 0, 0, 0], (1, 1)).size, (1, 1));

        let (frame, _, labels, explained) = striped();
        let facets = testing::segments(320, 240, |i| {
            let (x, y) = (i % 320, i / 320);
            if (150..170).contains(&x) && (110..130).contains(&y) { 2 } else { i32::from(x > 200) }
        });
        let explained = Explanation { borders: Vec::new(), ..explained };
        let picture = explanation(&frame, &facets, &labels, &explained);
        assert!(picture.width() > 3 * 320, "three tiles");
    }

    fn whole_u32((width, height): (usize, usize)) -> (u32, u32) {
        (width as u32, height as u32)
    }

    #[test]
    fn a_border_has_the_colour_of_what_speaks_most() {
        assert_eq!(color_of(&border(1, 5.0, 9.0, Some(1.0))), FOR);
        assert_eq!(color_of(&border(1, 9.0, 5.0, Some(-1.0))), AGAINST);
        assert_eq!(color_of(&border(1, 5.0, 9.0, Some(0.0))), STEP);
        assert_eq!(color_of(&border(1, 5.0, 9.0, None)), NO_VOTE);
    }

    #[test]
    fn frames_of_any_size_have_a_picture() {
        let (.., explained) = striped();
        for (width, height) in [(1, 1), (3, 500), (1300, 2)] {
            for color in [None, Some(testing::raster(width, height, |_| [9; 3]))] {
                let frame = testing::frame(testing::raster(width, height, |_| 1.0), color);
                let facets = testing::segments(width, height, |i| (i % 4) as i32 - 1);
                let labels = testing::raster(width, height, |i| (i % 3) as u16);
                let nothing = Explanation { facet: None, borders: Vec::new(), ..explained.clone() };
                for explained in [&explained, &nothing] {
                    let picture = explanation(&frame, &facets, &labels, explained);
                    assert!(picture.width() >= 640, "{width} x {height}");
                }
            }
        }
    }
}
