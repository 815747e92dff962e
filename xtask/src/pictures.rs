//! The pictures of docs/CONTEXT.md: parts of what the program draws of synthetic scenes.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result};
use image::codecs::png::{CompressionType, FilterType as PngFilter, PngEncoder};
use image::imageops::{self, FilterType};
use image::{ImageReader, RgbImage};

use crate::house::{House, pass_on};

/// Columns and rows of a synthetic scene, which are those of a tile (px).
const TILE_PX: [u32; 2] = [640, 480];
/// Left of each tile, and above the title of each (px), as objecthood-view sets them.
const GAP_PX: u32 = 22;
/// Room for a title above each tile (px).
const TITLE_PX: u32 = 44;
/// Whole rows and explanations are made smaller by this factor.
const SHRINK: u32 = 2;
/// Levels of each colour that are kept: noise compresses badly.
const LEVELS: u32 = 32;

/// A synthetic scene.
struct Scene {
    family: &'static str,
    seed: u32,
}

/// What a picture is cut from.
enum Source {
    /// Tiles side by side of `segment --write panels`: the row.
    Row(u32),
    /// A part (left, top, columns, rows; px of the frame) of these tiles (column, row).
    Parts { tiles: &'static [[u32; 2]], part: [u32; 4] },
    /// What `explain --at` draws.
    Explanation { at: &'static str },
}

/// A picture: its file, and what it shows.
struct Picture {
    file: &'static str,
    scene: Scene,
    source: Source,
}

const STACK: Scene = Scene { family: "stacked", seed: 8 };

const PICTURES: [Picture; 6] = [
    Picture { file: "pixels.png", scene: STACK, source: Source::Row(0) },
    Picture { file: "regions.png", scene: STACK, source: Source::Row(1) },
    Picture { file: "objects.png", scene: STACK, source: Source::Row(2) },
    Picture { file: "votes.png", scene: STACK, source: Source::Explanation { at: "307,308" } },
    Picture {
        file: "vessels.png",
        scene: Scene { family: "vessels", seed: 10 },
        source: Source::Parts { tiles: &[[0, 0], [2, 1], [1, 2]], part: [230, 90, 280, 280] },
    },
    Picture {
        file: "occlusion.png",
        scene: Scene { family: "clutter", seed: 2 },
        source: Source::Parts { tiles: &[[0, 0], [2, 1], [1, 2]], part: [380, 130, 240, 190] },
    },
];

/// Draws the pictures anew.
///
/// # Errors
/// When the program cannot be built or run, or a picture cannot be written.
pub(crate) fn run(house: &House) -> Result<bool> {
    pass_on(&mut house.cargo("build --release -p objecthood-cli"))?;
    let (made, docs) = (house.folder("pictures")?, house.root.join("docs/pictures/context"));
    std::fs::create_dir_all(&docs).with_context(|| format!("{}", docs.display()))?;
    let program = Program { path: house.program("objecthood"), made };
    for picture in &PICTURES {
        let image = picture.cut(&program)?;
        let file = docs.join(picture.file);
        write(&fewer_levels(image), &file).with_context(|| format!("{}", file.display()))?;
        println!("{}", file.display());
    }
    Ok(true)
}

/// The program, and where it writes.
struct Program {
    path: PathBuf,
    made: PathBuf,
}

impl Program {
    fn run(&self, arguments: &[&str]) -> Result<()> {
        pass_on(Command::new(&self.path).current_dir(&self.made).args(arguments).stdout(Stdio::null()))
    }

    fn picture(&self, name: &str) -> Result<RgbImage> {
        read(&self.made.join(name))
    }
}

fn read(file: &Path) -> Result<RgbImage> {
    let image = ImageReader::open(file).map_err(anyhow::Error::from).and_then(|image| Ok(image.decode()?));
    Ok(image.with_context(|| format!("{}", file.display()))?.to_rgb8())
}

impl Picture {
    fn cut(&self, program: &Program) -> Result<RgbImage> {
        let Scene { family, seed } = self.scene;
        let number = seed.to_string();
        program.run(&["synth", "--out", ".", "--scenes", "1", "--family", family, "--seed", &number])?;
        let (name, cloud) = (format!("{family}{seed}"), format!("{family}/{family}{seed}.pcd"));
        let image = match self.source {
            Source::Explanation { at } => {
                program.run(&["explain", &cloud, "--at", at, "--out", "."])?;
                program.picture(&format!("{name}.explain.png"))?
            }
            _ => {
                program.run(&["segment", &cloud, "--out", ".", "--write", "panels"])?;
                program.picture(&format!("{name}.panels.png"))?
            }
        };
        Ok(match self.source {
            Source::Row(row) => {
                let height = TITLE_PX + TILE_PX[1];
                let strip = imageops::crop_imm(&image, 0, row * height, image.width(), height).to_image();
                smaller(&strip)
            }
            Source::Explanation { .. } => smaller(&image),
            Source::Parts { tiles, part: [left, top, width, height] } => {
                let wide = tiles.len() as u32 * (width + GAP_PX) - GAP_PX;
                let mut row = RgbImage::from_pixel(wide, height, image::Rgb([255; 3]));
                for (k, [column, line]) in (0..).zip(tiles) {
                    let x = GAP_PX + column * (TILE_PX[0] + GAP_PX) + left;
                    let y = TITLE_PX + line * (TILE_PX[1] + TITLE_PX) + top;
                    let part = imageops::crop_imm(&image, x, y, width, height).to_image();
                    imageops::replace(&mut row, &part, i64::from(k * (width + GAP_PX)), 0);
                }
                row
            }
        })
    }
}

fn smaller(image: &RgbImage) -> RgbImage {
    imageops::resize(image, image.width() / SHRINK, image.height() / SHRINK, FilterType::Triangle)
}

/// Rounds every colour to one of [`LEVELS`]; black stays black and white stays white.
fn fewer_levels(mut image: RgbImage) -> RgbImage {
    for level in image.iter_mut() {
        let nearest = (u32::from(*level) * (LEVELS - 1) + 127) / 255;
        *level = (nearest * 255 / (LEVELS - 1)) as u8;
    }
    image
}

fn write(image: &RgbImage, file: &Path) -> Result<()> {
    let mut bytes = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, PngFilter::NoFilter);
    image.write_with_encoder(encoder)?;
    Ok(std::fs::write(file, bytes)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_and_white_stay_and_the_rest_is_rounded_a_little() {
        let ramp = RgbImage::from_fn(256, 1, |x, _| image::Rgb([x as u8; 3]));
        let rounded = fewer_levels(ramp.clone());
        assert_eq!([0, 255].map(|x| rounded.get_pixel(x, 0).0[0]), [0, 255]);
        for (before, after) in ramp.pixels().zip(rounded.pixels()) {
            assert!(before.0[0].abs_diff(after.0[0]) <= 5, "{before:?} {after:?}");
        }
    }
}
