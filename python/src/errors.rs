//! Errors of the library -> exceptions. Their classes are in `objecthood/errors.py`.

use pyo3::{PyErr, import_exception};

import_exception!(objecthood.errors, FileError);
import_exception!(objecthood.errors, InputError);
import_exception!(objecthood.errors, ParameterError);

/// What is wrong with a frame or a parameter.
#[expect(clippy::needless_pass_by_value, reason = "the shape of map_err")]
pub(crate) fn core(error: objecthood::Error) -> PyErr {
    match error {
        objecthood::Error::BadParameter { .. } => ParameterError::new_err(error.to_string()),
        _ => InputError::new_err(error.to_string()),
    }
}

/// What is wrong with images that are arrays.
#[expect(clippy::needless_pass_by_value, reason = "the shape of map_err")]
pub(crate) fn input(error: objecthood_io::Error) -> PyErr {
    InputError::new_err(error.to_string())
}

/// What is wrong with a file, or with what a file's content is to become.
#[expect(clippy::needless_pass_by_value, reason = "the shape of map_err")]
pub(crate) fn file(error: objecthood_io::Error) -> PyErr {
    FileError::new_err(error.to_string())
}
