//! EXR images (`OpenEXR`), of which one channel of depth is read.
//!
//! The channel is called Z, as renderers write it, or depth, also within a layer (`View.Z`); or Y, as grey is; or it is the only one.
//! 16-bit, 32-bit and whole numbers become `f32`. A depth of 1e9 and more is none: renderers write 1e10 where they see nothing.

use std::io::Cursor;

use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, Text, Vec2, read};

use super::check_pixels;
use super::error::ImageError;
use super::picture::{Picture, Samples};

/// A depth (m) at which a renderer sees nothing.
const NOTHING_M: f32 = 1e9;
/// The most numbers that all channels of a file may have, for each pixel that is allowed: blocks of rows are unpacked with all of them.
const MOST_CHANNELS_PER_PIXEL: usize = 2;

/// Decodes the depth of an image of at most `max_pixels`.
pub(super) fn decode(bytes: &[u8], max_pixels: usize) -> Result<Picture, ImageError> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(broken)?;
    let (header, channel) = depth_channel(&meta.headers)?;
    let size = (header.layer_size.width(), header.layer_size.height());
    check_pixels(size, max_pixels)?;
    for header in &meta.headers {
        let numbers = header.layer_size.area().saturating_mul(header.channels.list.len());
        if numbers > MOST_CHANNELS_PER_PIXEL.saturating_mul(max_pixels) {
            let found =
                format!("{} channels of {} pixels", header.channels.list.len(), header.layer_size.area());
            return Err(ImageError::PixelKind { found, wanted: "an EXR file of depth alone" });
        }
    }
    if header.shared_attributes.display_window.size != header.layer_size {
        let found = "an EXR file with a part of the picture".to_owned();
        return Err(ImageError::PixelKind { found, wanted: "one whose data window is its display window" });
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required::<f32>(channel)
        .collect_pixels(
            |size: Vec2<usize>, _| (size.width(), vec![f32::NAN; size.area()]),
            |(width, depth): &mut (usize, Vec<f32>), at: Vec2<usize>, (z,): (f32,)| {
                depth[at.y() * *width + at.x()] = if z < NOTHING_M { z } else { f32::NAN };
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(broken)?;
    let (_, samples) = image.layer_data.channel_data.pixels;
    Ok(Picture { size, channels: 1, samples: Samples::F32(samples) })
}

/// The name of the channel of depth, and the layer that has it.
fn depth_channel(headers: &[Header]) -> Result<(&Header, Text), ImageError> {
    let channels = || {
        headers.iter().flat_map(|header| header.channels.list.iter().map(move |channel| (header, channel)))
    };
    let last_part = |name: &Text| {
        let name = name.to_string().to_ascii_lowercase();
        name.rsplit('.').next().unwrap_or_default().to_owned()
    };
    let named = |wanted: &str| channels().find(|(_, channel)| last_part(&channel.name) == wanted);
    let only = || channels().next().filter(|_| channels().count() == 1);
    let found = ["z", "depth", "y"].into_iter().find_map(named).or_else(only);
    let (header, channel) = found.ok_or_else(|| ImageError::DepthIsColor { channels: channels().count() })?;
    Ok((header, channel.name.clone()))
}

#[expect(clippy::needless_pass_by_value, reason = "the shape of map_err")]
fn broken(error: exr::error::Error) -> ImageError {
    ImageError::Broken { format: "EXR", reason: error.to_string().chars().take(200).collect() }
}
