//! Image files, written by other encoders, to captures.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

use std::io::Cursor;

use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, LumaA, Rgb, Rgba};
use objecthood::Camera;
use objecthood_io::images::{ImageError, Resized, decode_images, decode_mask};
use objecthood_io::{Capture, Error, Given};
use proptest::prelude::*;
use tiff::encoder::{TiffEncoder, colortype};

const WIDTH: u32 = 7;
const HEIGHT: u32 = 5;
const PIXELS: u32 = WIDTH * HEIGHT;

fn setup(depth_scale: Option<f64>) -> Given {
    Given { camera: Some("7,7,3,2,7,5".parse().unwrap()), depth_scale, ..Given::default() }
}

fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn png(image: impl Into<DynamicImage>) -> Vec<u8> {
    encoded(image, ImageFormat::Png)
}

fn tiff_of<C: colortype::ColorType>(samples: &[C::Inner]) -> Vec<u8>
where
    [C::Inner]: tiff::encoder::TiffValue,
{
    let mut bytes = Cursor::new(Vec::new());
    TiffEncoder::new(&mut bytes).unwrap().write_image::<C>(WIDTH, HEIGHT, samples).unwrap();
    bytes.into_inner()
}

/// Millimetres: 1000, 1001, ..; the first pixel has none.
fn millimetres() -> Vec<u16> {
    (0..PIXELS as u16).map(|k| if k == 0 { 0 } else { 1000 + k }).collect()
}

fn depth_png() -> Vec<u8> {
    png(ImageBuffer::<Luma<u16>, _>::from_raw(WIDTH, HEIGHT, millimetres()).unwrap())
}

fn refused(color: Option<&[u8]>, depth: &[u8], setup: &Given) -> ImageError {
    match decode_images(color, depth, setup).unwrap_err() {
        Error::Image(error) => {
            assert!(!error.to_string().contains('\n'), "{error}");
            error
        }
        other => panic!("{other}"),
    }
}

fn assert_metres(capture: &Capture) {
    let depth_m = capture.frame.depth_m();
    assert_eq!(capture.frame.size(), (WIDTH as usize, HEIGHT as usize));
    assert!(depth_m[0].is_nan());
    for (k, &z) in depth_m.as_slice().iter().enumerate().skip(1) {
        assert!((f64::from(z) - 1.0 - k as f64 / 1000.0).abs() < 1e-6, "{k}: {z}");
    }
}

#[test]
fn depth_in_every_form_is_the_same_depth() {
    let mm = setup(Some(1000.0));
    assert_metres(&decode_images(None, &depth_png(), &mm).unwrap());
    assert_metres(&decode_images(None, &tiff_of::<colortype::Gray16>(&millimetres()), &mm).unwrap());
    let with_alpha: Vec<u16> = millimetres().into_iter().flat_map(|mm| [mm, 3]).collect();
    let with_alpha = png(ImageBuffer::<LumaA<u16>, _>::from_raw(WIDTH, HEIGHT, with_alpha).unwrap());
    assert_metres(&decode_images(None, &with_alpha, &mm).unwrap());

    let floats = |per_metre: f32, none: f32| -> Vec<u8> {
        let depth = millimetres().into_iter().map(|mm| f32::from(mm) / 1000.0 * per_metre);
        let depth: Vec<f32> = depth.map(|z| if z == 0.0 { none } else { z }).collect();
        tiff_of::<colortype::Gray32Float>(&depth)
    };
    for none in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_metres(&decode_images(None, &floats(1.0, none), &setup(None)).unwrap());
        assert_metres(&decode_images(None, &floats(1000.0, none), &mm).unwrap());
    }
}

#[test]
fn colour_in_every_form_is_the_same_colour() {
    let rgb: Vec<u8> = (0..PIXELS).flat_map(|k| [k as u8, 7 * k as u8, 255 - k as u8]).collect();
    let rgba: Vec<u8> = rgb.chunks(3).flat_map(|c| [c[0], c[1], c[2], 9]).collect();
    let rgb16: Vec<u16> = rgb.iter().map(|&c| u16::from(c) * 257).collect();
    // Rounds to the nearest.
    let rgb16_off: Vec<u16> =
        rgb16.iter().enumerate().map(|(k, c)| c.saturating_add([0, 128][k % 2])).collect();
    let rgba16: Vec<u16> = rgb16.chunks(3).flat_map(|c| [c[0], c[1], c[2], 9]).collect();
    let files = [
        png(ImageBuffer::<Rgb<u8>, _>::from_raw(WIDTH, HEIGHT, rgb.clone()).unwrap()),
        png(ImageBuffer::<Rgba<u8>, _>::from_raw(WIDTH, HEIGHT, rgba.clone()).unwrap()),
        png(ImageBuffer::<Rgb<u16>, _>::from_raw(WIDTH, HEIGHT, rgb16_off).unwrap()),
        png(ImageBuffer::<Rgba<u16>, _>::from_raw(WIDTH, HEIGHT, rgba16).unwrap()),
        tiff_of::<colortype::RGB8>(&rgb),
        tiff_of::<colortype::RGBA8>(&rgba),
        tiff_of::<colortype::RGB16>(&rgb16),
    ];
    for file in files {
        let capture = decode_images(Some(&file), &depth_png(), &setup(Some(1000.0))).unwrap();
        assert_eq!(capture.frame.color().unwrap().as_slice().concat(), rgb);
    }
}

#[test]
fn grey_images_and_jpeg_have_colours_too() {
    let grey: Vec<u8> = (0..PIXELS).map(|k| 100 + k as u8).collect();
    let grey = ImageBuffer::<Luma<u8>, _>::from_raw(WIDTH, HEIGHT, grey).unwrap();
    let red = ImageBuffer::from_pixel(WIDTH, HEIGHT, Rgb([200_u8, 40, 30]));
    let colors = |file: &[u8]| {
        let capture = decode_images(Some(file), &depth_png(), &setup(Some(1000.0))).unwrap();
        capture.frame.color().unwrap().as_slice().to_vec()
    };
    assert_eq!(colors(&png(grey.clone()))[9], [109; 3]);
    let [r, g, b] = colors(&encoded(grey, ImageFormat::Jpeg))[9];
    assert!(r == g && g == b && r.abs_diff(109) < 6);
    let found = colors(&encoded(red, ImageFormat::Jpeg))[9];
    assert!(found.iter().zip([200, 40, 30]).all(|(a, b)| a.abs_diff(b) < 6), "{found:?}");
}

#[test]
fn what_is_no_depth_is_refused() {
    let mm = setup(Some(1000.0));
    let eight = png(ImageBuffer::from_pixel(WIDTH, HEIGHT, Luma([90_u8])));
    assert_eq!(refused(None, &eight, &mm), ImageError::DepthEightBit);
    assert_eq!(refused(None, &tiff_of::<colortype::Gray8>(&[90; 35]), &mm), ImageError::DepthEightBit);
    let rgb = png(ImageBuffer::from_pixel(WIDTH, HEIGHT, Rgb([90_u8; 3])));
    assert_eq!(refused(None, &rgb, &mm), ImageError::DepthIsColor { channels: 3 });
    let jpeg = encoded(ImageBuffer::from_pixel(WIDTH, HEIGHT, Luma([90_u8])), ImageFormat::Jpeg);
    assert_eq!(refused(None, &jpeg, &mm), ImageError::DepthIsJpeg);
    assert_eq!(refused(None, b"1000 1001 1002\n", &mm), ImageError::UnknownFormat);
    assert_eq!(refused(None, b"", &mm), ImageError::Empty);
    for tiff in [tiff_of::<colortype::Gray32>(&[9; 35]), tiff_of::<colortype::Gray64Float>(&[1.0; 35])] {
        assert!(matches!(refused(None, &tiff, &mm), ImageError::PixelKind { .. }));
    }
    let nothing = png(ImageBuffer::from_pixel(WIDTH, HEIGHT, Luma([0_u16])));
    let error = decode_images(None, &nothing, &mm).unwrap_err();
    assert!(matches!(error, Error::Frame(objecthood::Error::NoValidDepth { .. })), "{error}");
}

/// The decoder names every one of the sample formats, and there may be 65535.
#[test]
fn a_table_as_long_as_the_file_likes_is_not_repeated() {
    const SHORT: u32 = 3;
    let (table_at, count) = (200, 2000);
    let entries = [(256, 1, 7), (257, 1, 5), (258, 1, 16), (259, 1, 1), (262, 1, 1), (339, count, table_at)];
    let mut tiff = b"II*\0\x08\0\0\0".to_vec();
    tiff.extend((entries.len() as u16).to_le_bytes());
    for (tag, count, value) in entries {
        tiff.extend([tag | SHORT << 16, count, value].map(u32::to_le_bytes).as_flattened());
    }
    tiff.resize(table_at as usize, 0);
    tiff.extend((0..count).flat_map(|k| (1 + k as u16 % 2).to_le_bytes()));
    let message = refused(None, &tiff, &setup(Some(1000.0))).to_string();
    assert!(message.contains("sample format [Uint, Int, ") && message.len() < 400, "{message}");
}

#[test]
fn what_is_no_colour_is_refused() {
    let mm = setup(Some(1000.0));
    assert!(matches!(refused(Some(&depth_png()), &depth_png(), &mm), ImageError::ColorIsDepth { .. }));
    let floats = tiff_of::<colortype::Gray32Float>(&[1.0; 35]);
    assert!(matches!(refused(Some(&floats), &depth_png(), &mm), ImageError::ColorIsDepth { .. }));
    let cmyk = tiff_of::<colortype::CMYK8>(&[9; 140]);
    assert_eq!(refused(Some(&cmyk), &depth_png(), &mm), ImageError::Cmyk);
    // The header of a JPEG with four components, after a comment.
    let jpeg = b"\xff\xd8\xff\xfe\x00\x05abc\xff\xc0\x00\x14\x08\x00\x05\x00\x07\x04\x01\x11\x00\x02\x11\x00\x03\x11\x00\x04\x11\x00";
    assert_eq!(refused(Some(jpeg), &depth_png(), &mm), ImageError::Cmyk);
    let wide = png(ImageBuffer::from_pixel(WIDTH + 1, HEIGHT, Rgb([90_u8; 3])));
    let said = decode_images(Some(&wide), &depth_png(), &mm).unwrap_err().to_string();
    assert!(said.contains("8x5") && said.contains("7x5"), "{said}");
}

/// Phones record colour of many more pixels than depth: it was refused.
#[test]
fn colour_of_one_view_is_brought_to_the_size_of_the_depth() {
    let colors = ImageBuffer::from_fn(3 * WIDTH, 3 * HEIGHT, |u, _| Rgb([(u / 3) as u8 * 30, 90, 0]));
    let of = |camera: &str| {
        let given = Given { camera: Some(camera.parse().unwrap()), ..setup(Some(1000.0)) };
        decode_images(Some(&png(colors.clone())), &depth_png(), &given)
    };
    for (camera, with_camera) in [("21,21,10,7", true), ("21,21,10,7,21,15", true), ("7,7,3,2", false)] {
        let capture = of(camera).unwrap();
        assert_eq!(capture.resized, Some(Resized { from: (21, 15), with_camera }));
        assert_eq!(capture.frame.camera(), Camera::new(7.0, 7.0, 3.0, 2.0).unwrap(), "{camera}");
        let row: Vec<i32> = (0..7).map(|u| i32::from(capture.frame.color().unwrap()[u][0])).collect();
        assert!(row.iter().zip(0..).all(|(&red, u)| (red - 30 * u).abs() <= 8), "{row:?}");
    }
    assert!(of("7,7,3,2,14,10").is_err());
}

#[test]
fn unit_and_size_are_checked() {
    assert_eq!(refused(None, &depth_png(), &setup(None)), ImageError::NoDepthScale);
    let no_camera = Given { camera: None, ..setup(Some(1000.0)) };
    assert_eq!(refused(None, &depth_png(), &no_camera), ImageError::NoCamera);
    for (scale, said) in [(1.0, "beyond 50 m"), (100_000.0, "below 0.05 m")] {
        let error = refused(None, &depth_png(), &setup(Some(scale)));
        assert!(matches!(error, ImageError::UnlikelyUnit { likely: Some(1000.0), .. }), "{error:?}");
        assert!(error.to_string().contains(said), "{error}");
    }
    let wrong = Given { camera: Some("7,7,3,2,14,10".parse().unwrap()), ..setup(Some(1000.0)) };
    let error = refused(None, &depth_png(), &wrong);
    assert_eq!(error, ImageError::CameraSize { given: (14, 10), image: (7, 5) });
    let small = Given { max_pixels: 34, ..setup(Some(1000.0)) };
    for depth in [depth_png(), tiff_of::<colortype::Gray16>(&millimetres())] {
        assert!(matches!(refused(None, &depth, &small), ImageError::TooManyPixels { size: (7, 5), .. }));
    }
    let jpeg = encoded(ImageBuffer::from_pixel(70, 50, Rgb([90_u8; 3])), ImageFormat::Jpeg);
    let error = refused(Some(&jpeg), &depth_png(), &Given { max_pixels: 35, ..setup(Some(1000.0)) });
    assert!(matches!(error, ImageError::TooManyPixels { size: (70, 50), .. }));
}

/// Most of a picture beyond the reach of 16 bits was taken for a picture in other units.
#[test]
fn saturated_depth_is_no_depth_and_tells_nothing_of_the_unit() {
    let mut saturated = vec![u16::MAX; PIXELS as usize];
    saturated[..3].copy_from_slice(&[900, 65_534, 0]);
    let png = png(ImageBuffer::<Luma<u16>, _>::from_raw(WIDTH, HEIGHT, saturated.clone()).unwrap());
    for file in [png, tiff_of::<colortype::Gray16>(&saturated)] {
        let capture = decode_images(None, &file, &setup(Some(1000.0))).unwrap();
        assert_eq!((0..PIXELS as usize).filter(|&i| capture.frame.is_valid(i)).collect::<Vec<_>>(), [0, 1]);
    }
}

#[test]
fn a_mask_is_what_is_not_black() {
    let mut image = ImageBuffer::from_pixel(3, 1, Rgba([0_u8, 0, 0, 255]));
    image.put_pixel(1, 0, Rgba([0, 0, 1, 0]));
    assert_eq!(decode_mask(&png(image), 3).unwrap().as_slice(), [false, true, false]);
    let grey = ImageBuffer::<Luma<u16>, _>::from_raw(3, 1, vec![0, 1, 65_535]).unwrap();
    assert_eq!(decode_mask(&png(grey), 3).unwrap().as_slice(), [false, true, true]);
    assert!(decode_mask(b"black", 3).is_err());
}

/// One file of every kind, as depth and as colour.
fn files() -> Vec<Vec<u8>> {
    let color = ImageBuffer::from_fn(WIDTH, HEIGHT, |u, v| Rgb([u as u8 * 9, v as u8 * 9, 3]));
    vec![
        depth_png(),
        tiff_of::<colortype::Gray16>(&millimetres()),
        tiff_of::<colortype::Gray32Float>(&[1.0; 35]),
        png(color.clone()),
        encoded(color, ImageFormat::Jpeg),
    ]
}

#[test]
fn a_file_cut_short_anywhere_is_refused() {
    for file in files() {
        // A PNG may do without its end and a TIFF ends with what nobody needs: what is there is whole.
        for end in 0..file.len() - 16 {
            let cut = &file[..end];
            let whole = decode_images(Some(&files()[3]), &file, &setup(Some(1.0))).is_ok();
            if let Ok(capture) = decode_images(Some(&files()[3]), cut, &setup(Some(1.0))) {
                assert!(whole && capture.frame.is_valid(PIXELS as usize - 1), "{end}");
            }
            if file.starts_with(b"\xff\xd8") {
                assert!(decode_images(Some(cut), &depth_png(), &setup(Some(1000.0))).is_err(), "{end}");
            }
        }
    }
}

proptest! {
    #[test]
    fn no_bytes_make_it_panic(
        which in 0_usize..5,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let mut file = files().swap_remove(which);
        for (at, value) in changes {
            let at = at.index(file.len());
            file[at] = value;
        }
        let small = Given { max_pixels: 10_000, ..setup(Some(1000.0)) };
        let _ = decode_images(None, &file, &small);
        let _ = decode_images(Some(&file), &depth_png(), &small);
        let _ = decode_mask(&file, 10_000);
    }
}
