//! What a user of this program can do about an error of the library: which option helps.
//!
//! The library says what is wrong and knows no options. Every error passes here on its way to the terminal.

use std::error::Error as StdError;

use objecthood_io::formats::Unread;
use objecthood_io::images::ImageError;
use objecthood_io::scope::Limit;
use objecthood_io::{Error, extensions};

/// What to append to the message of an error: `: ` and the advice, or nothing when no option helps.
pub(crate) fn of(error: &anyhow::Error) -> String {
    let advice = error.chain().find_map(for_link);
    advice.map(|advice| format!(": {advice}")).unwrap_or_default()
}

/// The advice for an error of one of the libraries. Some pass on an error of another one as their own.
fn for_link(link: &(dyn StdError + 'static)) -> Option<String> {
    use objecthood_eval::Error as EvalError;
    if let Some(error) = link.downcast_ref() {
        return for_reading(error);
    }
    match link.downcast_ref()? {
        EvalError::Input(error) => for_reading(error),
        EvalError::InScene { error, .. } => for_link(&**error),
        EvalError::SameName { .. } => Some("evaluate one folder at a time with --split".to_owned()),
        EvalError::NothingToCompose => Some("leave out --composites".to_owned()),
        _ => None,
    }
}

fn for_reading(error: &Error) -> Option<String> {
    const CAMERA: &str = "--camera fx,fy,cx,cy[,width,height] or --camera camera.json";
    let text = match error {
        Error::At { error, .. } => return for_reading(error),
        Error::UnknownFormat { looks_like: Some(Unread::Matroska) } => {
            "extract the depth of an Azure Kinect with `ffmpeg -i FILE -map 0:1 -pix_fmt gray16be depth-%06d.png`, and give it by \
             --depth, --depth-scale 1000 and the --camera of its depth"
                .to_owned()
        }
        Error::UnknownFormat { looks_like: Some(Unread::Recording(_)) } => {
            "save its depth and colour as images and give them by --depth and --color".to_owned()
        }
        Error::UnknownFormat { .. } => {
            format!("give a point cloud ({}), or images by --color and --depth", endings())
        }
        Error::NoFrames => "name one that holds some, or images by --color and --depth".to_owned(),
        Error::NoCameraFile { .. } => "add one, or give the camera by --camera".to_owned(),
        Error::NoImageSize { .. } => "write --camera fx,fy,cx,cy,width,height".to_owned(),
        Error::NoView { .. } | Error::CameraResidual { .. } => format!("give the camera, {CAMERA}"),
        Error::NotPinhole => format!("convert them to it, or give the camera, {CAMERA}"),
        Error::NoStamp => "use --frames instead of --time".to_owned(),
        Error::NothingInScope { limits, .. } => {
            let options: Vec<&str> = limits.iter().map(option_of).collect();
            format!("widen {}", options.join(" or "))
        }
        Error::Image(error) => return for_image(error),
        _ => return None,
    };
    Some(text)
}

/// The option that sets a limit.
fn option_of(limit: &Limit) -> &'static str {
    match limit {
        Limit::Range => "--range",
        Limit::Region => "--roi",
        Limit::Mask => "--mask",
    }
}

fn for_image(error: &ImageError) -> Option<String> {
    let text = match error {
        ImageError::TooManyPixels { max_pixels, .. } => format!(
            "give a smaller image, or more than --max-pixels {max_pixels} if there is memory (about 200 bytes a pixel \
             for every frame at a time)"
        ),
        ImageError::ColorIsDepth { .. } => {
            "are --color and --depth swapped? If they are not, save it with 8 bits".to_owned()
        }
        ImageError::NoCamera => "give it by --camera fx,fy,cx,cy or --camera camera.json".to_owned(),
        ImageError::NoDepthScale => {
            "say how many units are a metre, --depth-scale 1000 for millimetres, 5000 for TUM, \
                                     10000 for YCB-Video"
                .to_owned()
        }
        ImageError::UnlikelyUnit { likely: Some(scale), .. } => {
            format!("most likely it is --depth-scale {scale}")
        }
        ImageError::UnlikelyUnit { likely: None, .. } => {
            "no usual --depth-scale fits, check that this is a depth image".to_owned()
        }
        _ => return None,
    };
    Some(text)
}

fn endings() -> String {
    extensions().map(|extension| format!(".{extension}")).collect::<Vec<_>>().join(", ")
}
