//! What videos promise.

use super::*;

#[test]
fn every_kind_generates() {
    for clip in Clip::ALL.into_iter().filter(|clip| std::env::var("ONLY").is_ok_and(|only| only.split(',').any(|name| name == clip.name()))) {
        for seed in 0..5 {
            let begun = std::time::Instant::now();
            let video = film(clip, seed, 30.0);
            let took = begun.elapsed();
            match video {
                Ok(video) => {
                    let told: Vec<String> = video
                        .truth()
                        .events
                        .iter()
                        .map(|e| format!("{}@{}({},{:?})", e.kind, e.frame, e.object, e.other))
                        .collect();
                    println!("{clip} {seed} {} frames {took:?}: {}", video.frames(), told.join(" "));
                }
                Err(error) => println!("{clip} {seed} {took:?}: {error}"),
            }
        }
    }
}

#[test]
fn debug_show() {
    let only = std::env::var("SHOW").unwrap_or_default();
    for clip in Clip::ALL.into_iter().filter(|clip| only.split(',').any(|name| name == clip.name())) {
        let seed = std::env::var("SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(1);
        let Ok(video) = film(clip, seed, 30.0).and_then(|v| v.at_size((320, 240))) else { println!("{clip} none"); continue };
        let n = video.frames();
        let (columns, rows) = (4, 3);
        let mut sheet = image::RgbImage::new(320 * columns, 240 * rows);
        for k in 0..(columns * rows) as usize {
            let frame = k * (n - 1) / ((columns * rows) as usize - 1);
            let begun = std::time::Instant::now();
            let seen = video.render(frame, Sensor::Kinect).unwrap();
            if k == 0 { println!("{clip} {:?}", begun.elapsed()); }
            let color = seen.frame.color().unwrap();
            for v in 0..240_usize {
                for u in 0..320_usize {
                    sheet.put_pixel((k as u32 % columns) * 320 + u as u32, (k as u32 / columns) * 240 + v as u32, image::Rgb(color[v * 320 + u]));
                }
            }
        }
        sheet.save(format!("/tmp/wt/{clip}-{seed}.png")).unwrap();
    }
}
