//! Reuses the memory of images from frame to frame.
//!
//! A stream of frames of one size requests the memory of its images from the system once. Without reuse the system hands out and
//! clears new pages for every frame, which takes about a tenth of the time (ours, because of this cost).
//!
//! Callers do not notice: a dropped [`Buffer`] is put on a shelf, and the next buffer of its type takes its memory from there.
//! Shelves are kept only as long as a [`Keeper`] lives; without one a dropped buffer is freed. No result depends on the earlier
//! contents of a buffer.

use std::any::Any;
use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Most buffers of one type that are kept for each keeper; further ones are freed when dropped. No method holds as many at once.
const MOST_KEPT: usize = 16;

/// A list of values. When it is dropped, its memory goes to the shelf of its type.
pub(crate) struct Buffer<T> {
    values: Vec<T>,
    /// Puts the memory on its shelf; `None` when it did not come from one.
    give_back: Option<fn(Vec<T>)>,
}

impl<T: Clone + Send + 'static> Buffer<T> {
    /// `len` values with arbitrary contents: old values of reused memory, and `value` in new memory. For stages that write every value.
    #[expect(clippy::needless_pass_by_value, reason = "values are small: a number or a few")]
    pub(crate) fn stale(len: usize, value: T) -> Self {
        // New memory full of zeros costs nothing until it is touched, because the system hands it out cleared.
        let values = take(len).map_or_else(
            || vec![value.clone(); len],
            |mut values: Vec<T>| {
                values.resize(len, value.clone());
                values
            },
        );
        Self::from_shelf(values)
    }

    /// `len` times `value`.
    pub(crate) fn filled(len: usize, value: T) -> Self {
        let mut buffer = Self::stale(len, value.clone());
        buffer.fill(value);
        buffer
    }

    fn from_shelf(values: Vec<T>) -> Self {
        Self { values, give_back: Some(give_back) }
    }
}

impl<T> Buffer<T> {
    /// The values. Their memory no longer goes to a shelf.
    pub(crate) fn into_vec(mut self) -> Vec<T> {
        self.give_back = None;
        std::mem::take(&mut self.values)
    }
}

impl<T> Drop for Buffer<T> {
    fn drop(&mut self) {
        if let Some(give_back) = self.give_back {
            give_back(std::mem::take(&mut self.values));
        }
    }
}

impl<T> Deref for Buffer<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        &self.values
    }
}

impl<T> DerefMut for Buffer<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.values
    }
}

/// Values of the caller: their memory does not go to a shelf.
impl<T> From<Vec<T>> for Buffer<T> {
    fn from(values: Vec<T>) -> Self {
        Self { values, give_back: None }
    }
}

impl<T: Clone + Send + 'static> FromIterator<T> for Buffer<T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        let values = values.into_iter();
        let mut buffer: Vec<T> = take(values.size_hint().0).unwrap_or_default();
        buffer.clear();
        buffer.extend(values);
        Self::from_shelf(buffer)
    }
}

/// A copy belongs to the caller: its memory does not go to a shelf.
impl<T: Clone> Clone for Buffer<T> {
    fn clone(&self) -> Self {
        self.values.clone().into()
    }
}

impl<T: PartialEq> PartialEq for Buffer<T> {
    fn eq(&self, other: &Self) -> bool {
        self.values == other.values
    }
}

impl<T: Eq> Eq for Buffer<T> {}

impl<T: fmt::Debug> fmt::Debug for Buffer<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.values.fmt(f)
    }
}

/// Dropped buffers are kept as long as a keeper lives.
#[derive(Debug)]
pub(crate) struct Keeper(());

impl Default for Keeper {
    fn default() -> Self {
        shelves().keepers += 1;
        Self(())
    }
}

impl Clone for Keeper {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        // The variable delays the deallocation until the lock is released.
        let _unused = shelves().leave();
    }
}

/// Puts the memory of a buffer on its shelf.
fn give_back<T: Send + 'static>(values: Vec<T>) {
    // The variable delays the deallocation until the lock is released.
    let _surplus = shelves().put(values);
}

/// The buffers that are kept for reuse. The whole process shares them: every pipeline takes buffers from here and puts them back, until
/// the last pipeline is dropped. [`Pipeline::forget`](crate::Pipeline::forget) puts the images of its outputs here and frees none.
static SHELVES: Mutex<Shelves> = Mutex::new(Shelves { keepers: 0, by_type: Vec::new() });

/// Locks the shelves. They are consistent even after a panic: no user code runs between two changes.
fn shelves() -> MutexGuard<'static, Shelves> {
    SHELVES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Memory for `len` values from a shelf, if a buffer there is large enough.
fn take<T: Send + 'static>(len: usize) -> Option<Vec<T>> {
    let taken = shelves().take(len);
    taken.filter(|values| values.capacity() >= len)
}

/// The buffers that are not in use.
struct Shelves {
    /// Number of living keepers.
    keepers: usize,
    /// A `Vec<Vec<T>>` for each type of values.
    by_type: Vec<Box<dyn Any + Send>>,
}

impl Shelves {
    fn shelf<T: 'static>(&mut self) -> Option<&mut Vec<Vec<T>>> {
        self.by_type.iter_mut().find_map(|shelf| shelf.downcast_mut())
    }

    /// Takes the smallest buffer that holds `len` values, so that a buffer serves the same use again; on ties the one put back last,
    /// because the cache most likely holds it. If none is large enough, takes the smallest of all: the caller frees it and later puts
    /// back a larger one.
    fn take<T: 'static>(&mut self, len: usize) -> Option<Vec<T>> {
        let shelf = self.shelf::<T>()?;
        let fit = |&i: &usize| (shelf[i].capacity() < len, shelf[i].capacity());
        let best = (0..shelf.len()).rev().min_by_key(fit)?;
        Some(shelf.remove(best))
    }

    /// Puts a buffer back. Returns the buffer to free, if any.
    fn put<T: Send + 'static>(&mut self, values: Vec<T>) -> Option<Vec<T>> {
        if self.keepers == 0 {
            return Some(values);
        }
        let most = MOST_KEPT * self.keepers;
        match self.shelf() {
            Some(shelf) => {
                shelf.push(values);
                (shelf.len() > most).then(|| shelf.remove(0))
            }
            None => {
                self.by_type.push(Box::new(vec![values]));
                None
            }
        }
    }

    /// Removes a keeper. After the last one, returns all buffers to be freed.
    fn leave(&mut self) -> Vec<Box<dyn Any + Send>> {
        self.keepers -= 1;
        if self.keepers == 0 { std::mem::take(&mut self.by_type) } else { Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::discover;
    use crate::frame::Frame;
    use crate::params::{Method, Params};
    use crate::raster::Raster;

    fn kept(keepers: usize) -> Shelves {
        Shelves { keepers, by_type: Vec::new() }
    }

    #[test]
    fn no_more_buffers_pile_up_than_a_method_uses() {
        for keepers in [1, 3] {
            let mut shelves = kept(keepers);
            let freed: Vec<_> = (0..100).filter_map(|_| shelves.put(vec![1.0_f32; 12])).collect();
            assert_eq!(freed.len(), 100 - keepers * MOST_KEPT);
        }
    }

    #[test]
    fn of_buffers_that_hold_enough_the_smallest_is_handed_out_and_of_those_the_last() {
        let mut shelves = kept(1);
        let buffers = [9, 12, 12, 40].map(|len| vec![0_u32; len]);
        let last = buffers[2].as_ptr();
        buffers.into_iter().for_each(|buffer| drop(shelves.put(buffer)));
        drop(shelves.put(vec![0_i32; 10]));
        assert_eq!(shelves.take::<u32>(10).map(|taken| taken.as_ptr()), Some(last));
        let left = shelves.shelf::<u32>().map(|shelf| shelf.iter().map(Vec::len).collect::<Vec<_>>());
        assert_eq!(left, Some(vec![9, 12, 40]));
        assert_eq!(
            shelves.take::<u32>(50).map(|smallest| smallest.len()),
            Some(9),
            "given up for a larger one"
        );
        assert_eq!(shelves.take::<u64>(1), None);
    }

    #[test]
    fn buffers_are_kept_only_as_long_as_a_keeper_lives() {
        let mut shelves = kept(0);
        assert_eq!(shelves.put(vec![1_u8; 3]), Some(vec![1; 3]));
        shelves.keepers = 2;
        assert_eq!(shelves.put(vec![1_u8; 3]), None);
        assert!(shelves.leave().is_empty());
        assert_eq!(shelves.leave().len(), 1);
        assert_eq!(shelves.take::<u8>(1), None);
    }

    /// Three boxes in front of a wall, in colour.
    fn frame() -> Frame {
        let (width, height) = (96, 72);
        let place = |i: usize| (i % width / 16, i / width / 24);
        let depth_m = |i: usize| match place(i) {
            (1 | 3, 1) => 0.8,
            (4, 0) => 1.1,
            (0, 2) => f32::NAN,
            _ => 1.4 + 0.001 * (i / width) as f32,
        };
        let color = |i: usize| [place(i).0 as u8 * 40, place(i).1 as u8 * 80, 90];
        let depth = Raster::from_vec(width, height, (0..width * height).map(depth_m).collect()).unwrap();
        let color = Raster::from_vec(width, height, (0..width * height).map(color).collect()).unwrap();
        Frame::new(depth, Some(color), Camera::new(80.0, 80.0, 47.5, 35.5).unwrap()).unwrap()
    }

    /// Leaves buffers of an image's size on the shelf, full of `value`.
    #[expect(clippy::needless_pass_by_value, reason = "as in the buffer itself")]
    fn soil<T: Clone + Send + 'static>(value: T) {
        for len in [96 * 72, 4 * 96 * 72] {
            let soiled: Vec<_> = (0..MOST_KEPT / 2).map(|_| Buffer::filled(len, value.clone())).collect();
            drop(soiled);
        }
    }

    #[test]
    fn no_result_depends_on_what_a_buffer_held() {
        let frame = frame();
        for method in [Method::Context, Method::Paper] {
            let params = Params { method, ..Params::default() };
            let clean = discover(&frame, &params).unwrap();
            let _keeper = Keeper::default();
            soil(1e30_f32);
            soil([7.5_f32; 2]);
            soil([-3.0_f32; 3]);
            soil(12_345_i32);
            soil(0xAB_u8);
            soil(-9_i16);
            soil(54_321_u32);
            soil(u64::MAX / 3);
            soil(true);
            let soiled = discover(&frame, &params).unwrap();
            assert_eq!(format!("{soiled:?}"), format!("{clean:?}"), "{method}");
        }
    }
}
