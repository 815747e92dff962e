//! Buffers that are used again from frame to frame.

use crate::oversegment::felzenszwalb::Component;
use crate::raster::Raster;
use crate::surface::plane_fit::Windows;

/// Buffers of one kind that are kept; no method asks for as many at once.
const MOST_KEPT: usize = 16;

/// The images that stages write to, kept from one frame to the next; lists of regions are asked for anew.
///
/// A stream of frames of one size asks the system for the memory of its images once; without, handing out and clearing
/// the pages takes about a tenth of the time. What is found never depends on what was looked at before.
#[derive(Debug, Default)]
pub struct Workspace {
    scalars: Vec<Vec<f32>>,
    slopes: Vec<Vec<[f32; 2]>>,
    vectors: Vec<Vec<[f32; 3]>>,
    labels: Vec<Vec<i32>>,
    masks: Vec<Vec<u8>>,
    distances: Vec<Vec<i16>>,
    pixels: Vec<Vec<u32>>,
    keys: Vec<Vec<u64>>,
    components: Vec<Vec<Component>>,
    /// Of every band of rows its windows.
    pub(crate) windows: Vec<Windows>,
    /// Of every level of a relief a queue for the pixels that are reached; empty between frames.
    pub(crate) floods: Vec<Vec<u32>>,
}

/// Seen by nobody outside: which buffers there are is not promised.
mod sealed {
    /// What there are buffers of.
    pub trait Pixel: Copy {
        /// The buffers that nobody uses.
        fn shelf(workspace: &mut super::Workspace) -> &mut Vec<Vec<Self>>;
    }
}

pub(crate) use sealed::Pixel;

macro_rules! shelves {
    ($($shelf:ident: $pixel:ty),*) => {
        $(impl Pixel for $pixel {
            fn shelf(workspace: &mut Workspace) -> &mut Vec<Vec<Self>> {
                &mut workspace.$shelf
            }
        })*
    };
}

shelves!(
    scalars: f32,
    slopes: [f32; 2],
    vectors: [f32; 3],
    labels: i32,
    masks: u8,
    distances: i16,
    pixels: u32,
    keys: u64,
    components: Component
);

/// Buffers are not copied: a clone begins without any.
impl Clone for Workspace {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Workspace {
    /// The smallest buffer that holds `len` values, so that each is asked for the same again; of equal ones the last that was
    /// given back, because it is nearest. When none does, one is given up for the larger one that will be asked for.
    fn take<T: Pixel>(&mut self, len: usize) -> Option<Vec<T>> {
        let shelf = T::shelf(self);
        let fit = |&i: &usize| (shelf[i].capacity() < len, shelf[i].capacity());
        let best = (0..shelf.len()).rev().min_by_key(fit).map(|i| shelf.remove(i));
        best.filter(|buffer| buffer.capacity() >= len)
    }

    /// A buffer of `len` values; those that were written before stay as they are, the others are `value`.
    pub(crate) fn stale<T: Pixel>(&mut self, len: usize, value: T) -> Vec<T> {
        // What the system hands out is zero already, and costs nothing before it is touched.
        let Some(mut buffer) = self.take(len) else { return vec![value; len] };
        buffer.resize(len, value);
        buffer
    }

    /// A buffer of `len` times `value`.
    pub(crate) fn filled<T: Pixel>(&mut self, len: usize, value: T) -> Vec<T> {
        let mut buffer = self.stale(len, value);
        buffer.fill(value);
        buffer
    }

    /// A buffer of these values.
    pub(crate) fn collected<T: Pixel>(&mut self, values: impl Iterator<Item = T>) -> Vec<T> {
        let mut buffer: Vec<T> = self.take(values.size_hint().0).unwrap_or_default();
        buffer.clear();
        buffer.extend(values);
        buffer
    }

    /// Takes the buffer of a raster back, for a stage to write to again; whole methods give back all they asked for themselves.
    pub fn keep<T: Pixel>(&mut self, raster: Raster<T>) {
        self.shelve(raster.into_vec());
    }

    /// Takes a buffer back. Of what was never taken from here no more than [`MOST_KEPT`] pile up.
    pub(crate) fn shelve<T: Pixel>(&mut self, buffer: Vec<T>) {
        let shelf = T::shelf(self);
        if shelf.len() == MOST_KEPT {
            shelf.remove(0);
        }
        shelf.push(buffer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_never_taken_does_not_pile_up() {
        let mut workspace = Workspace::default();
        for _ in 0..3 * MOST_KEPT {
            workspace.keep(Raster::filled(4, 3, 1.0_f32).unwrap());
        }
        assert_eq!(workspace.scalars.len(), MOST_KEPT);
    }

    #[test]
    fn of_buffers_that_hold_enough_the_smallest_is_handed_out_and_of_those_the_last() {
        let mut workspace = Workspace::default();
        let buffers = [9, 12, 12, 40].map(|len| vec![0_u32; len]);
        let last = buffers[2].as_ptr();
        buffers.into_iter().for_each(|buffer| workspace.shelve(buffer));
        let taken = workspace.stale(10, 7_u32);
        assert_eq!(taken.as_ptr(), last);
        assert_eq!(workspace.pixels.iter().map(Vec::len).collect::<Vec<_>>(), [9, 12, 40]);
    }
}
