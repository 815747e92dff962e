//! No file makes the reader allocate by claim. Alone in its program, because the counter counts all threads.

mod common;

use common::{ENCODINGS, decode, small_file, small_ply};
use peak_alloc::PeakAlloc;

#[global_allocator]
static PEAK: PeakAlloc = PeakAlloc;

/// Bytes that reading `file` takes at most at any time.
fn peak_bytes(file: &[u8]) -> usize {
    PEAK.reset_peak_usage();
    let before = PEAK.current_usage();
    let _ = std::hint::black_box(decode(file, None));
    PEAK.peak_usage() - before
}

#[test]
fn memory_is_bounded_by_the_bytes_that_are_there() {
    let sides = [(16_384_u64, 8_192_u64), (16_384, 16_384), (268_435_456, 1), (4_294_967_295, 4_294_967_295)];
    for encoding in ENCODINGS {
        let file = small_file(encoding);
        let at = file.windows(4).position(|window| window == b"DATA").unwrap();
        let header = String::from_utf8(file[..at].to_vec()).unwrap();
        let count = header.lines().find(|line| line.starts_with("POINTS")).unwrap();
        for (width, height) in sides {
            let header = header
                .replace("WIDTH 4", &format!("WIDTH {width}"))
                .replace("HEIGHT 3", &format!("HEIGHT {height}"))
                .replace(count, &format!("POINTS {}", width * height));
            // The compressed data make the same claim where they can, 20 bytes a point.
            for unpacked_size in
                [None, Some((20_u64.saturating_mul(width * height)).min(u64::from(u32::MAX)))]
            {
                let mut data = file[at..].to_vec();
                if let Some(size) = unpacked_size {
                    let sizes = data.iter().position(|&b| b == b'\n').unwrap() + 1;
                    data[sizes + 4..sizes + 8].copy_from_slice(&(size as u32).to_le_bytes());
                }
                let claim = [header.as_bytes(), &data].concat();
                let peak = peak_bytes(&claim);
                assert!(peak <= 100 * claim.len() + 4096, "{peak} bytes for {encoding:?}, {header}");
            }
        }
    }

    let file = String::from_utf8(small_ply()).unwrap();
    let many = |line: &str| line.repeat(10_000) + "comment";
    for (from, to) in [
        ("vertex 11", "vertex 268435456".to_owned()),
        ("vertex 11", "vertex 18446744073709551615".to_owned()),
        ("comment", "element camera 18446744073709551615\nproperty int i\ncomment".to_owned()),
        ("comment", many("element a 9\nproperty int i\n")),
        ("property double z", (0..10_000).map(|i| format!("property char p{i}\n")).collect()),
    ] {
        let claim = file.replace(from, &to);
        let peak = peak_bytes(claim.as_bytes());
        assert!(peak <= 100 * claim.len() + 4096, "{peak} bytes for {}", &to[..40.min(to.len())]);
    }

    // The counter counts: what is there is stored.
    let rows = 1000;
    let point = "0.001 0.002 1\n".repeat(rows);
    let file = format!(
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT {rows}\nPOINTS {rows}\nDATA ascii\n{point}"
    );
    assert!(peak_bytes(file.as_bytes()) >= 12 * rows);
}
