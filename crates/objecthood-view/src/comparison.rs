//! Several label images of one frame side by side.

use image::{Rgb, RgbImage};
use objecthood::{Frame, Raster};

use crate::grid::{sample, tile_size};
use crate::objects::Objects;
use crate::panels::Page;
use crate::tiles::{Tile, numbered};
use crate::view::{NOTHING, resize};

/// What stands for the colour of a frame that has none, where there is depth.
const GREY: Rgb<u8> = Rgb([128; 3]);

/// One row: the colour image, then every label image (0 = none) under its title, objects with their numbers on the
/// dimmed colour image. The same number has the same colour in all of them. O(pixels of the picture).
///
/// Label images have the size of the frame. The sizes of tiles are those of [`panels`](crate::panels()).
pub fn comparison(frame: &Frame, maps: &[(&str, &Raster<u16>)]) -> RgbImage {
    let (width, height) = tile_size(frame.size());
    let color = frame.color().and_then(resize).unwrap_or_else(|| {
        let depth_m = sample(frame.depth_m());
        let grey = |u: u32, v: u32| depth_m.get(u as usize, v as usize).filter(|z| !z.is_nan()).map(|_| GREY);
        RgbImage::from_fn(width as u32, height as u32, |u, v| grey(u, v).unwrap_or(NOTHING))
    });
    let scenery = |u: usize, v: usize| color.get_pixel_checked(u as u32, v as u32).copied();
    let mut tiles = vec![Tile { title: "colour".to_owned(), image: color.clone(), scale: None }];
    tiles.extend(maps.iter().map(|&(title, labels)| Tile {
        title: title.to_owned(),
        image: numbered(&Objects::new(labels), scenery),
        scale: None,
    }));
    Page::new((width as u32, height as u32), tiles.len(), tiles.len()).compose(&tiles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::palette::object_color;
    use crate::testing;

    #[test]
    fn label_images_stand_beside_the_colour_in_one_row() {
        let color = testing::raster(320, 240, |i| [(i % 320 / 2) as u8, 100, 200]);
        let frame = testing::frame(testing::raster(320, 240, |_| 1.0), Some(color));
        let left = testing::raster(320, 240, |i| u16::from(i % 320 < 160));
        let right = testing::raster(320, 240, |i| 2 * u16::from(i % 320 >= 160));
        let picture = comparison(&frame, &[("one", &left), ("other", &right)]);

        // Off the numbers, which stand in the middle of their objects.
        let at = |tile: u32, u: u32, v: u32| {
            let page = Page::new((320, 240), 3, 3);
            let (x, y) = page.corner(tile as usize);
            picture.get_pixel(x + u, y + v).0
        };
        assert_eq!(at(0, 100, 30), [50, 100, 200]);
        assert_eq!((at(1, 100, 30), at(2, 200, 30)), (object_color(1).0, object_color(2).0));
        assert_eq!((at(2, 100, 30), at(1, 200, 30)), ([20, 40, 80], [40, 40, 80]), "the rest is dimmed");
        assert_eq!(picture, comparison(&frame, &[("one", &left), ("other", &right)]));
    }

    #[test]
    fn without_colour_depth_is_grey() {
        let depth_m = testing::raster(320, 240, |i| if i % 320 < 160 { 1.0 } else { f32::NAN });
        let picture = comparison(&testing::frame(depth_m, None), &[]);
        let (x, y) = Page::new((320, 240), 1, 1).corner(0);
        assert_eq!((picture.get_pixel(x, y), picture.get_pixel(x + 319, y)), (&GREY, &NOTHING));
    }
}
