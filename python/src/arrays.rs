//! NumPy arrays <-> rasters. Arrays come C-contiguous, aligned and in native byte order: `objecthood/_arrays.py` sees to it,
//! and the types here refuse anything else.

use numpy::{
    Element, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3,
    PyUntypedArrayMethods,
};
use objecthood::Raster;
use pyo3::prelude::*;

use crate::errors::{InputError, core};

/// The raster of an image, of the numbers that `values` makes of its pixels. This is the one copy of an image on its way in: a frame
/// owns its pixels, because nothing stops another thread from writing to the array while the frame is looked at.
pub(crate) fn raster<T: Element, U>(
    image: &PyReadonlyArray2<'_, T>,
    values: impl FnOnce(&[T]) -> Vec<U>,
) -> PyResult<Raster<U>> {
    let [height, width] = [image.shape()[0], image.shape()[1]];
    let pixels = image.as_slice().map_err(|_| InputError::new_err("the image is not C-contiguous"))?;
    Raster::from_vec(width, height, values(pixels)).map_err(core)
}

/// The raster of a colour image.
pub(crate) fn color(image: &PyReadonlyArray3<'_, u8>) -> PyResult<Raster<[u8; 3]>> {
    let [height, width, channels] = [image.shape()[0], image.shape()[1], image.shape()[2]];
    let samples = image.as_slice().map_err(|_| InputError::new_err("the image is not C-contiguous"))?;
    let (pixels, _) = samples.as_chunks::<3>();
    if channels != 3 {
        return Err(InputError::new_err(format!("color has {channels} channels: give 3, RGB")));
    }
    Raster::from_vec(width, height, pixels.to_vec()).map_err(core)
}

/// An image of one number a pixel.
pub(crate) fn image<'py, T: Element + Copy>(
    py: Python<'py>,
    raster: &Raster<T>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    PyArray1::from_slice(py, raster.as_slice()).reshape([raster.height(), raster.width()])
}

/// An image of three numbers a pixel.
pub(crate) fn image3<'py, T: Element + Copy>(
    py: Python<'py>,
    raster: &Raster<[T; 3]>,
) -> PyResult<Bound<'py, PyArray3<T>>> {
    PyArray1::from_slice(py, raster.as_slice().as_flattened()).reshape([raster.height(), raster.width(), 3])
}

/// A table with a row of `N` numbers for each value.
pub(crate) fn table<'py, T: Element + Copy, const N: usize>(
    py: Python<'py>,
    values: &[[T; N]],
) -> PyResult<Bound<'py, PyArray2<T>>> {
    PyArray1::from_slice(py, values.as_flattened()).reshape([values.len(), N])
}
