//! The objects of a frame as detections, which files of several formats hold.

use objecthood::{Discovery, Frame, OrientedBox, PixelBox};

use super::rle::{self, Rle};

/// One object of a frame.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Its number in the label image.
    pub id: u16,
    /// How sure it is, in [0, 1]: its objectness.
    pub score: f32,
    /// Its pixels.
    pub mask: Rle,
    /// The smallest upright rectangle around them.
    pub box_px: PixelBox,
    /// How many they are (px).
    pub area_px: usize,
    /// Those of them that have depth (px).
    pub measured_px: usize,
    /// The box around its points.
    pub box_m: OrientedBox,
}

/// The objects of a frame in the order of their numbers. O(n) for n pixels.
pub fn of_discovery(frame: &Frame, discovery: &Discovery) -> Vec<Instance> {
    let masks = rle::of_labels(&discovery.labels, discovery.objects.len());
    let mut measured_px = vec![0; discovery.objects.len() + 1];
    for (i, &label) in discovery.labels.as_slice().iter().enumerate() {
        if frame.is_valid(i)
            && let Some(count) = measured_px.get_mut(usize::from(label))
        {
            *count += 1;
        }
    }
    let pairs = discovery.objects.iter().zip(masks);
    let instance = |(object, mask): (&objecthood::Object, Rle)| Instance {
        id: object.id.0,
        score: object.objectness,
        mask,
        box_px: object.box_px,
        area_px: object.size_px,
        measured_px: measured_px[usize::from(object.id.0).min(discovery.objects.len())],
        box_m: object.box_m,
    };
    pairs.map(instance).collect()
}
