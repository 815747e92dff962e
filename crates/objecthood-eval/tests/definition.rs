//! `score` against docs/EVALUATION.md, Definitions, read literally, pixel by pixel, on small images.

use objecthood::Raster;
use objecthood_eval::{ImageMetrics, Roles, Truth, Verdict, score};
use proptest::prelude::*;

const WIDTH: usize = 18;
const HEIGHT: usize = 14;
const LEN: usize = WIDTH * HEIGHT;

type Mask = Vec<bool>;

fn count(mask: &Mask) -> f64 {
    mask.iter().filter(|&&m| m).count() as f64
}

fn and(a: &Mask, b: &Mask) -> Mask {
    a.iter().zip(b).map(|(&a, &b)| a && b).collect()
}

fn harmonic(p: f64, r: f64) -> f64 {
    if p + r == 0.0 { 0.0 } else { 2.0 * p * r / (p + r) }
}

fn boundary(mask: &Mask) -> Mask {
    let differs = |i: usize, steps: &[usize]| steps.iter().any(|step| mask[i + step] != mask[i]);
    (0..LEN)
        .map(|i| match (i % WIDTH == WIDTH - 1, i / WIDTH == HEIGHT - 1) {
            (false, false) => differs(i, &[1, WIDTH, WIDTH + 1]),
            (false, true) => differs(i, &[1]),
            (true, false) => differs(i, &[WIDTH]),
            (true, true) => false,
        })
        .collect()
}

fn dilated(mask: &Mask) -> Mask {
    let radius = (0.003 * (WIDTH as f64).hypot(HEIGHT as f64)).ceil();
    let near = |i: usize, j: usize| {
        let (du, dv) = ((i % WIDTH).abs_diff(j % WIDTH) as f64, (i / WIDTH).abs_diff(j / WIDTH) as f64);
        du * du + dv * dv <= radius * radius
    };
    (0..LEN).map(|i| (0..LEN).any(|j| mask[j] && near(i, j))).collect()
}

/// All one-to-one assignments of the smaller side, as (object, hypothesis).
fn assignments(objects: usize, hypotheses: usize) -> Vec<Vec<(usize, usize)>> {
    if objects > hypotheses {
        let swap = |pairs: Vec<_>| pairs.into_iter().map(|(a, b)| (b, a)).collect();
        return assignments(hypotheses, objects).into_iter().map(swap).collect();
    }
    (0..objects).fold(vec![vec![]], |partial, g| {
        let extend = |pairs: &Vec<(usize, usize)>| {
            let free = (0..hypotheses).filter(|c| pairs.iter().all(|p| p.1 != *c)).collect::<Vec<_>>();
            free.into_iter().map(|c| [pairs.clone(), vec![(g, c)]].concat()).collect::<Vec<_>>()
        };
        partial.iter().flat_map(extend).collect()
    })
}

/// The metrics of every assignment that is best, up to rounding.
fn metrics(objects: &[Mask], hypotheses: &[Mask]) -> Vec<[f64; 7]> {
    let f = |(g, c): (usize, usize)| {
        let common = count(&and(&objects[g], &hypotheses[c]));
        harmonic(common / count(&hypotheses[c]), common / count(&objects[g]))
    };
    let sum = |pairs: &[(usize, usize)]| pairs.iter().map(|&p| f(p)).sum::<f64>();
    let all = assignments(objects.len(), hypotheses.len());
    let best = all.iter().map(|pairs| sum(pairs)).fold(0.0, f64::max);
    let of_assignment = |pairs: &Vec<(usize, usize)>| {
        let total = |masks: &[Mask]| masks.iter().map(count).sum::<f64>();
        let common: f64 = pairs.iter().map(|&(g, c)| count(&and(&objects[g], &hypotheses[c]))).sum();
        let (op, or) = (common / total(hypotheses), common / total(objects));
        let edges = |masks: &[Mask]| masks.iter().map(boundary).collect::<Vec<_>>();
        let (of_objects, of_hypotheses) = (edges(objects), edges(hypotheses));
        let (mut right, mut found) = (0.0, 0.0);
        for &(g, c) in pairs.iter().filter(|&&p| f(p) > 0.0) {
            right += count(&and(&of_hypotheses[c], &dilated(&of_objects[g])));
            found += count(&and(&of_objects[g], &dilated(&of_hypotheses[c])));
        }
        let bp = right / total(&of_hypotheses).max(1.0);
        let br = found / total(&of_objects).max(1.0);
        let p75 = pairs.iter().filter(|&&p| f(p) > 0.75).count() as f64 / objects.len() as f64;
        [op, or, harmonic(op, or), bp, br, harmonic(bp, br), p75]
    };
    all.iter().filter(|pairs| sum(pairs) > best - 1e-9).map(of_assignment).collect()
}

fn verdict(g: usize, objects: &[Mask], parts: &[Mask], hypotheses: &[Mask]) -> (f64, Verdict) {
    let size = count(&objects[g]);
    let common = |c: usize| count(&and(&objects[g], &hypotheses[c]));
    let on_others = |c: usize| {
        let others = (0..objects.len()).filter(|&o| o != g);
        others.map(|o| count(&and(&objects[o], &hypotheses[c]))).sum::<f64>()
    };
    let iou = |c: usize| common(c) / (size + count(&hypotheses[c]) - common(c));
    let first_best = |figure: &dyn Fn(usize) -> f64| {
        (0..hypotheses.len()).reduce(|a, b| if figure(b) > figure(a) { b } else { a })
    };
    let (Some(j), Some(k)) = (first_best(&iou), first_best(&common)) else { return (0.0, Verdict::Missed) };
    let alien = |c: usize| on_others(c) / count(&hypotheses[c]);
    let off = |c: usize| (count(&hypotheses[c]) - common(c) - on_others(c)) / count(&hypotheses[c]);
    // Of the shares, not of the pixels: where an object is held to exactly one half, rounding decides as in score.py.
    let mut shares: Vec<f64> = (0..hypotheses.len()).map(|c| common(c) / size).collect();
    let held: f64 = shares.iter().sum();
    shares.sort_by(f64::total_cmp);
    let second = shares.iter().rev().nth(1).copied().unwrap_or(0.0);
    let large = parts.iter().filter(|p| count(&and(p, &objects[g])) > 0.0 && count(p) >= 0.05 * size).count();
    let verdict = if iou(j) >= 0.75 && alien(j) < 0.10 && second < 0.10 {
        Verdict::Correct
    } else if held < 0.5 {
        Verdict::Missed
    } else if large >= 2 && alien(k) < 0.25 {
        Verdict::Occlusion
    } else if alien(k) >= 0.10 || off(k) > 0.25 {
        Verdict::Under
    } else if second >= 0.10 || held - common(k) / size >= 0.10 {
        Verdict::Over
    } else {
        Verdict::Boundary
    };
    (iou(j), verdict)
}

/// The masks of the labels for which `fits`, by ascending label.
fn masks(labels: &[u32], fits: impl Fn(u32) -> bool) -> (Vec<u32>, Vec<Mask>) {
    let mut values: Vec<u32> = labels.iter().copied().filter(|&l| fits(l)).collect();
    values.sort_unstable();
    values.dedup();
    let mask = |value: &u32| labels.iter().map(|l| l == value).collect();
    let masks = values.iter().map(mask).collect();
    (values, masks)
}

fn raster<T>(labels: Vec<T>) -> Raster<T> {
    Raster::from_vec(WIDTH, HEIGHT, labels).expect("one label a pixel")
}

/// Rectangles painted over each other, so that regions touch, overlap and vanish as in real label images.
fn image(labels: std::ops::Range<u32>) -> impl Strategy<Value = Vec<u32>> {
    let rectangle = (0..WIDTH, 0..HEIGHT, 1..=WIDTH, 1..=HEIGHT, labels);
    (0_u32..2, prop::collection::vec(rectangle, 0..7)).prop_map(|(ground, rectangles)| {
        let mut image = vec![ground; LEN];
        for (u, v, width, height, label) in rectangles {
            for row in v..(v + height).min(HEIGHT) {
                image[row * WIDTH + u..row * WIDTH + (u + width).min(WIDTH)].fill(label);
            }
        }
        image
    })
}

/// The truth with some pixels changed, or something else entirely.
fn prediction(truth: Vec<u32>) -> impl Strategy<Value = Vec<u32>> {
    let noise = prop::collection::vec((0..LEN, 0_u32..6), 0..60);
    let copied = noise.prop_map(move |noise| {
        let mut labels: Vec<u32> = truth.iter().map(|&l| if l > 1 { l } else { 0 }).collect();
        noise.into_iter().for_each(|(i, label)| labels[i] = label);
        labels
    });
    prop_oneof![copied, image(0..5)]
}

fn images() -> impl Strategy<Value = (Vec<u32>, Vec<u32>, Vec<u32>)> {
    image(0..5).prop_flat_map(|truth| (Just(truth.clone()), image(0..3), prediction(truth)))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]

    #[test]
    fn scores_are_those_of_the_definition(
        (truth, cuts, labels) in images(),
        ignore in prop::option::of(Just(0_u32)),
        background in prop::option::of(Just(1_u32)),
    ) {
        let is_object = |l: u32| Some(l) != ignore && Some(l) != background;
        // Parts lie within one object each.
        let cut: Vec<u32> = truth.iter().zip(&cuts).map(|(t, c)| t * 10 + c).collect();
        let roles = Roles { ignore, background };
        let scored = score(
            &raster(labels.iter().map(|&l| l as u16).collect()),
            &Truth::new(raster(truth.clone()), raster(cut.clone()), roles).unwrap(),
        ).unwrap();

        let counted: Vec<u32> =
            labels.iter().zip(&truth).map(|(&l, &t)| if Some(t) == ignore { 0 } else { l }).collect();
        let (names, objects) = masks(&truth, is_object);
        let (_, hypotheses) = masks(&counted, |l| l > 0);
        let (_, parts) = masks(&cut, |_| true);

        prop_assert_eq!(scored.hypotheses, hypotheses.len());
        let on_objects = |c: &&Mask| objects.iter().map(|g| count(&and(g, c))).sum::<f64>();
        let off = hypotheses.iter().filter(|c| on_objects(c) / count(c) < 0.5).count();
        prop_assert_eq!(scored.hypotheses_off_objects, off);

        prop_assert_eq!(scored.objects.len(), objects.len());
        for (g, object) in scored.objects.iter().enumerate() {
            let (iou, verdict) = verdict(g, &objects, &parts, &hypotheses);
            prop_assert_eq!((object.truth_label, object.pixels), (names[g], count(&objects[g]) as usize));
            prop_assert!((object.iou - iou).abs() < 1e-12);
            prop_assert_eq!(object.verdict, verdict);
        }

        match scored.metrics {
            None => prop_assert!(objects.is_empty()),
            Some(found) if hypotheses.is_empty() => prop_assert_eq!(found, ImageMetrics::default()),
            Some(found) => {
                let best = metrics(&objects, &hypotheses);
                let near = |m: &[f64; 7]| m.iter().zip(found.values()).all(|(a, b)| (a - b).abs() < 1e-9);
                prop_assert!(best.iter().any(near), "{:?} is none of {:?}", found, best);
            }
        }
    }
}

/// One object of 20 pixels in a row, its parts and the hypotheses over it; what lies beyond is table.
fn judged(truth: &str, parts: &str, labels: &str) -> Verdict {
    let digits = |text: &str| text.bytes().map(|b| u32::from(b - b'0')).collect::<Vec<_>>();
    let row = |text: &str| Raster::from_vec(text.len(), 1, digits(text)).expect("a row");
    let truth =
        Truth::new(row(truth), row(parts), Roles { ignore: Some(0), background: Some(1) }).expect("a truth");
    score(&row(labels).map(|&l| l as u16), &truth).expect("a score").objects[0].verdict
}

#[test]
fn each_verdict_at_its_threshold() {
    let object = "22222222222222222222";
    let cases = [
        // IoU exactly 15/20 is enough, 14/20 is not.
        (object, object, "11111111111111100000", Verdict::Correct),
        (object, object, "11111111111111000000", Verdict::Boundary),
        // A second hypothesis may hold less than 2 of 20.
        (object, object, "11111111111111111112", Verdict::Correct),
        (object, object, "11111111111111111122", Verdict::Over),
        // Many small ones that hold 2 of 20 together.
        (object, object, "11111111111111000023", Verdict::Over),
        // Less than half is missed, half is not.
        (object, object, "11111111110000000000", Verdict::Boundary),
        (object, object, "11111111100000000000", Verdict::Missed),
        (object, object, "00000000000000000000", Verdict::Missed),
        // Another object may be less than 10 % of the hypothesis.
        ("22222222222222222223", "22222222222222222223", "11111111111111111111", Verdict::Correct),
        ("22222222222222222233", "22222222222222222233", "11111111111111111111", Verdict::Under),
        // More than 25 % of the main hypothesis on the table, 7 of 27.
        (
            "222222222222222222221111111",
            "222222222222222222221111111",
            "111111111111111111111111111",
            Verdict::Under,
        ),
        (
            "22222222222222222222111111",
            "22222222222222222222111111",
            "11111111111111111111111111",
            Verdict::Correct,
        ),
        // Two parts, of which the smaller has 5 % of the object or not.
        (object, "22222222222222222223", "11111111110000000000", Verdict::Occlusion),
        ("222222222222222222222", "222222222222222222223", "111111111110000000000", Verdict::Boundary),
    ];
    for (truth, parts, labels, expected) in cases {
        assert_eq!(judged(truth, parts, labels), expected, "{truth} {parts} {labels}");
    }
    // Two parts do not excuse a quarter of other objects.
    let truth = "222222222222222333333";
    assert_eq!(judged(truth, "222222222222224333333", "111111111111111111111"), Verdict::Under);
    assert_eq!(
        judged("222222222222222333311", "222222222222224333311", "111111111111111111111"),
        Verdict::Occlusion
    );
}
