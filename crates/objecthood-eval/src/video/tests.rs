//! Figures of videos, against cases worked out by hand and against `TrackEval`.

use std::collections::BTreeSet;
use std::fmt::Write;

use objecthood::Raster;

use super::*;
use crate::python;

const SIZE: (usize, usize) = (40, 12);

/// An image in which each of `boxes` (number, first column, width) fills all rows of its columns.
fn image(boxes: &[(u16, usize, usize)]) -> Raster<u16> {
    let mut image = Raster::filled(SIZE.0, SIZE.1, 0).unwrap();
    for &(number, first, width) in boxes {
        for row in image.as_mut_slice().chunks_exact_mut(SIZE.0) {
            row[first..first + width].fill(number);
        }
    }
    image
}

type Boxes = Vec<(u16, usize, usize)>;

fn overlaps(frames: &[(Boxes, Boxes)], roles: impl Fn(usize) -> Roles) -> Overlaps {
    let mut counter = OverlapCounter::default();
    for (k, (instances, tracks)) in frames.iter().enumerate() {
        let frame = LabelledFrame { tracks: image(tracks), instances: image(instances) };
        counter.add(&frame, &roles(k)).unwrap();
    }
    counter.finish()
}

fn roles(objects: &[u16]) -> Roles {
    Roles { objects: objects.iter().copied().collect::<BTreeSet<u16>>(), ..Roles::default() }
}

fn figures(overlaps: &Overlaps) -> [f64; 7] {
    let hota = HotaCounts::of(overlaps).figures().unwrap();
    let clear = ClearCounts::of(overlaps);
    let idf1 = IdentityCounts::of(overlaps).unwrap().f1().unwrap();
    let switches = clear.switches as f64;
    [hota.hota, hota.det_a, hota.ass_a, hota.owta.unwrap(), idf1, clear.mota().unwrap(), switches]
}

fn close(found: [f64; 7], expected: [f64; 7]) {
    let is_close = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(is_close, "{found:?} instead of {expected:?}");
}

#[test]
fn perfect_tracks_have_full_marks() {
    let frames = vec![(vec![(1, 2, 10), (2, 20, 8)], vec![(7, 2, 10), (3, 20, 8)]); 10];
    let overlaps = overlaps(&frames, |_| roles(&[1, 2]));
    close(figures(&overlaps), [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0]);
    assert_eq!(ClearCounts::of(&overlaps).unbroken, 2);
    assert_eq!(CloseSum::of(&overlaps).mean(), Some(1.0));
}

#[test]
fn a_change_of_id_halfway_halves_association() {
    let frames: Vec<(Boxes, Boxes)> =
        (0..10).map(|k| (vec![(1, 2, 10)], vec![(if k < 5 { 7 } else { 8 }, 2, 10)])).collect();
    let overlaps = overlaps(&frames, |_| roles(&[1]));
    // Each frame shares its track with 5 of the object's 10 frames. One switch in ten frames costs a tenth of MOTA.
    let root = 0.5_f64.sqrt();
    close(figures(&overlaps), [root, 1.0, 0.5, root, 0.5, 0.9, 1.0]);
    assert_eq!(ClearCounts::of(&overlaps).unbroken, 0);
}

#[test]
fn a_false_track_costs_detection_but_not_owta() {
    let frames = vec![(vec![(1, 2, 10)], vec![(7, 2, 10), (9, 25, 5)]); 4];
    let found = figures(&overlaps(&frames, |_| roles(&[1])));
    let root = 0.5_f64.sqrt();
    close(found, [root, 0.5, 1.0, 1.0, 8.0 / 12.0, 0.0, 0.0]);
}

#[test]
fn what_is_not_punished_costs_nothing() {
    let frames = vec![(vec![(1, 2, 10), (5, 25, 6)], vec![(7, 2, 10), (9, 25, 5)]); 4];
    let agents = |_| Roles { unpunished: [5].into(), ..roles(&[1]) };
    close(figures(&overlaps(&frames, agents)), [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0]);
}

#[test]
fn flush_boxes_are_one_until_they_part_and_either_may_keep_the_id() {
    let together = (vec![(1, 2, 10), (2, 12, 10)], vec![(7, 2, 20)]);
    for kept in [1, 2] {
        let other = 3 - kept;
        let of = |number: u16| if number == 1 { (2, 10) } else { (15, 10) };
        let tracks = vec![(7, of(kept).0, of(kept).1), (8, of(other).0, of(other).1)];
        let apart = (vec![(1, 2, 10), (2, 15, 10)], tracks);
        let frames = [vec![together.clone(); 5], vec![apart; 5]].concat();
        let groups = |k: usize| if k < 5 { vec![vec![1, 2]] } else { vec![] };
        let overlaps = overlaps(&frames, |k| Roles { groups: groups(k), ..roles(&[1, 2]) });
        close(figures(&overlaps), [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0]);
    }
}

/// Boxes that move, vanish, swap and are found badly, from a fixed sequence of numbers.
fn confused_video(seed: u64) -> Vec<(Boxes, Boxes)> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut below = |n: u64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) % n
    };
    let mut ids = [11_u16, 12, 13];
    let frame = |_| {
        if below(6) == 0 {
            let (a, b) = (below(3) as usize, below(3) as usize);
            ids.swap(a, b);
        }
        if below(8) == 0 {
            ids[below(3) as usize] = 20 + below(9) as u16;
        }
        let (mut instances, mut tracks) = (Boxes::new(), Boxes::new());
        for (k, &id) in ids.iter().enumerate() {
            let first = 13 * k + below(3) as usize;
            if below(7) > 0 {
                instances.push((k as u16 + 1, first, 9));
            }
            let is_new = tracks.iter().all(|&(other, ..): &(u16, usize, usize)| other != id);
            if below(6) > 0 && is_new {
                tracks.push((id, first + below(4) as usize, 5 + below(4) as usize));
            }
        }
        (instances, tracks)
    };
    (0..40).map(frame).collect()
}

const TRACKEVAL: &str = r"
import io, json, sys, contextlib
import numpy as np
with contextlib.redirect_stdout(io.StringIO()):
    from trackeval.metrics import HOTA, CLEAR, Identity
for line in sys.stdin:
    frames = json.loads(line)
    objects = sorted({o[0] for f in frames for o in f[0]})
    tracks = sorted({t[0] for f in frames for t in f[1]})
    def overlap(o, t):
        common = max(0, min(o[1] + o[2], t[1] + t[2]) - max(o[1], t[1]))
        return common / (o[2] + t[2] - common)
    data = {
        'num_timesteps': len(frames), 'num_gt_ids': len(objects), 'num_tracker_ids': len(tracks),
        'num_gt_dets': sum(len(f[0]) for f in frames), 'num_tracker_dets': sum(len(f[1]) for f in frames),
        'gt_ids': [np.array([objects.index(o[0]) for o in f[0]], dtype=int) for f in frames],
        'tracker_ids': [np.array([tracks.index(t[0]) for t in f[1]], dtype=int) for f in frames],
        'similarity_scores': [np.array([[overlap(o, t) for t in f[1]] for o in f[0]]).reshape(len(f[0]), len(f[1])) for f in frames],
    }
    with contextlib.redirect_stdout(io.StringIO()):
        h, c, i = HOTA().eval_sequence(data), CLEAR().eval_sequence(data), Identity().eval_sequence(data)
    print(*[float(np.mean(h[k])) for k in ('HOTA', 'DetA', 'AssA', 'OWTA')], float(i['IDF1']), float(c['MOTA']), float(c['IDSW']))
";

#[test]
fn figures_are_those_of_trackeval() {
    let videos: Vec<_> = (1..60).map(confused_video).collect();
    let mut input = String::new();
    for video in &videos {
        let boxes = |boxes: &Boxes| -> String {
            let told: Vec<String> =
                boxes.iter().map(|(id, first, width)| format!("[{id},{first},{width}]")).collect();
            format!("[{}]", told.join(","))
        };
        let frames: Vec<String> = video.iter().map(|(o, t)| format!("[{},{}]", boxes(o), boxes(t))).collect();
        writeln!(input, "[{}]", frames.join(",")).unwrap();
    }
    let Some(output) = python::run(TRACKEVAL, &input) else {
        println!("skipped: no Python with trackeval (set OBJECTHOOD_PYTHON)");
        return;
    };
    let lines: Vec<&str> = output.lines().collect();
    assert_eq!(lines.len(), videos.len(), "{output}");
    for (video, line) in videos.iter().zip(lines) {
        let expected: Vec<f64> = line.split(' ').map(|number| number.parse().unwrap()).collect();
        let found = figures(&overlaps(video, |_| roles(&[1, 2, 3])));
        for (k, (a, b)) in found.iter().zip(&expected).enumerate() {
            assert!((a - b).abs() < 1e-6, "figure {k}: {a} instead of {b}: {found:?}, {expected:?}");
        }
    }
}
