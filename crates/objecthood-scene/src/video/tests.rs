//! What videos promise.

use super::*;

#[test]
fn every_kind_generates() {
    for clip in Clip::ALL {
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
