//! Several label images of one frame side by side.

use image::RgbImage;
use objecthood::{Frame, Raster};

use crate::grid::{sample, tile_size};
use crate::objects::Objects;
use crate::panels::Page;
use crate::tiles::{Tile, numbered};
use crate::view::{NOTHING, resize};

/// What stands for the colour of a frame that has none, where there is depth.
const GREY: [u8; 3] = [128; 3];
/// Longest side of a tile [px]: four of them fit on a screen. Larger frames are shrunk by a whole number.
const MAX_SIDE_PX: usize = 480;

/// One row: the colour image, then every label image (0 = none) under its title, objects with their numbers on the
/// dimmed colour image. The same number has the same colour in all of them. O(pixels of the frame · label images).
///
/// Label images have the size of the frame.
pub fn comparison(frame: &Frame, maps: &[(&str, &Raster<u16>)]) -> RgbImage {
    let (width, height) = frame.size();
    let factor = width.max(height).div_ceil(MAX_SIDE_PX);
    let grey = || frame.depth_m().map(|z| if z.is_nan() { NOTHING.0 } else { GREY });
    let color = shrunk(&frame.color().cloned().unwrap_or_else(grey), factor, mean);
    let size = tile_size(color.size());
    let image = resize(&color).unwrap_or_default();
    let scenery = |u: usize, v: usize| image.get_pixel_checked(u as u32, v as u32).copied();
    let mut tiles = vec![Tile { title: "colour".to_owned(), image: image.clone(), scale: None }];
    tiles.extend(maps.iter().map(|&(title, labels)| {
        let labels = shrunk(labels, factor, |block| block[block.len() / 2]);
        Tile {
            title: title.to_owned(),
            image: numbered(&Objects::new(sample(&labels)), scenery),
            scale: None,
        }
    }));
    Page::new((size.0 as u32, size.1 as u32), tiles.len(), tiles.len()).compose(&tiles)
}

/// One pixel for each block of `factor` x `factor`, made of what is in it; blocks at the border may be smaller.
fn shrunk<T: Copy>(raster: &Raster<T>, factor: usize, pixel: impl Fn(&[T]) -> T) -> Raster<T> {
    let (width, height) = raster.size();
    let (columns, rows) = (width.div_ceil(factor), height.div_ceil(factor));
    let block = |k: usize| -> Vec<T> {
        let (left, top) = (k % columns * factor, k / columns * factor);
        let row = |v: usize| &raster.as_slice()[v * width..][left..(left + factor).min(width)];
        (top..(top + factor).min(height)).flat_map(row).copied().collect()
    };
    let data = (0..columns * rows).map(|k| pixel(&block(k))).collect();
    Raster::from_vec(columns, rows, data).expect("as many blocks as columns times rows")
}

fn mean(colors: &[[u8; 3]]) -> [u8; 3] {
    let sum = |channel: usize| colors.iter().map(|color| u32::from(color[channel])).sum::<u32>();
    [0, 1, 2].map(|channel| (sum(channel) / colors.len() as u32) as u8)
}

#[cfg(test)]
mod tests {
    use image::Rgb;

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
        assert_eq!((picture.get_pixel(x, y), picture.get_pixel(x + 319, y)), (&Rgb(GREY), &NOTHING));
    }

    #[test]
    fn large_frames_are_shrunk_by_a_whole_number() {
        let raster = |width, height| testing::raster(width, height, |i| i as u16);
        assert_eq!(shrunk(&raster(4, 2), 2, |block| block[0]).as_slice(), [0, 2]);
        assert_eq!(shrunk(&raster(5, 3), 2, |block| block.len() as u16).as_slice(), [4, 4, 2, 2, 2, 1]);
        assert_eq!(shrunk(&raster(5, 3), 1, |block| block[0]), raster(5, 3));
        assert_eq!(mean(&[[0, 10, 255], [1, 20, 255]]), [0, 15, 255]);
        let frame = testing::frame(testing::raster(1000, 10, |_| 1.0), None);
        let tile = tile_size((334, 4));
        assert_eq!(
            comparison(&frame, &[]),
            Page::new((tile.0 as u32, tile.1 as u32), 1, 1).compose(&[Tile {
                title: "colour".to_owned(),
                image: RgbImage::from_pixel(334, 4, Rgb(GREY)),
                scale: None,
            }])
        );
    }
}
