//! No image makes the reader allocate before its size is judged. Alone in its program, because the counter counts all
//! threads.
#![allow(clippy::unwrap_used, reason = "in a test, an unwrap that fails is the failure report")]

use std::io::Cursor;

use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb};
use objecthood_io::Given;
use objecthood_io::images::decode_images;
use peak_alloc::PeakAlloc;
use tiff::encoder::{TiffEncoder, colortype};

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

/// Bytes that reading takes at most at any time, and what it said.
fn peak(color: Option<&[u8]>, depth: &[u8]) -> (usize, String) {
    let camera = Some("9,9,3,2".parse().unwrap());
    let setup = Given { camera, depth_scale: Some(1000.0), ..Given::default() };
    PEAK.reset_peak_usage();
    let before = PEAK.current_usage();
    let said = decode_images(color, depth, &setup).map_or_else(|e| e.to_string(), |_| "fine".to_owned());
    (PEAK.peak_usage() - before, said)
}

fn encoded(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

#[test]
fn claims_beyond_the_limit_take_no_memory() {
    let depth = encoded(ImageBuffer::from_pixel(8, 8, Luma([1000_u16])), ImageFormat::Png);
    assert_eq!(peak(None, &depth).1, "fine");

    let mut files = Vec::new();
    for side in [8192_u32, 65_535, 0x7fff_ffff] {
        // The size stands behind the signature and the name of the first chunk; its checksum behind 13 bytes.
        let mut png = depth.clone();
        png[16..20].copy_from_slice(&side.to_be_bytes());
        png[20..24].copy_from_slice(&side.to_be_bytes());
        let checksum = crc32(&png[12..29]).to_be_bytes();
        png[29..33].copy_from_slice(&checksum);
        files.push((false, png));
    }
    let mut tiff = Cursor::new(Vec::new());
    TiffEncoder::new(&mut tiff).unwrap().write_image::<colortype::Gray16>(8, 8, &[1000; 64]).unwrap();
    let tiff = tiff.into_inner();
    for side in [8192_u32, 0xffff_ffff] {
        // Tags 256 and 257, one LONG each.
        let mut claim = tiff.clone();
        for tag in [[0_u8, 1, 4, 0], [1, 1, 4, 0]] {
            let at = claim.windows(4).position(|window| window == tag).unwrap();
            claim[at + 8..at + 12].copy_from_slice(&side.to_le_bytes());
        }
        files.push((false, claim));
    }
    let mut jpeg = encoded(ImageBuffer::from_pixel(8, 8, Rgb([9_u8; 3])), ImageFormat::Jpeg);
    let at = jpeg.windows(2).position(|window| window == [0xff, 0xc0]).unwrap();
    jpeg[at + 5..at + 9].copy_from_slice(&[0xff, 0xff, 0xff, 0xff]);
    files.push((true, jpeg));

    for (is_color, file) in files {
        let (bytes, said) = if is_color { peak(Some(&file), &depth) } else { peak(None, &file) };
        // A TIFF also says how many strips it has.
        let is_refused = said.contains("more than the 16777216") || said.contains("inconsistent sizes");
        assert!(is_refused, "{said}");
        assert!(bytes < 200_000, "{bytes} bytes: {said}");
    }

    // The counter counts: what is there is stored.
    let large = encoded(ImageBuffer::from_pixel(1024, 1024, Luma([1000_u16])), ImageFormat::Png);
    assert!(peak(None, &large).0 >= 4 << 20);
}

/// The checksum of a chunk of PNG, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}
