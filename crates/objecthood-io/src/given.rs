//! What the caller knows of frames: it overrides what their files say.

use crate::organize::GridCamera;

/// The most pixels of a frame unless the caller says otherwise: 2^24, for example 4096x4096.
///
/// Processing a frame takes 160 to 180 bytes a pixel: 2.8 GB for a frame of this size, 11 GB for one of 8192x8192
/// pixels.
pub const DEFAULT_MAX_PIXELS: usize = 1 << 24;

/// What the caller knows of frames. By default nothing, and a frame has at most [`DEFAULT_MAX_PIXELS`].
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// The camera, used instead of the file's own. Depth images and unorganized clouds need one from either.
    pub camera: Option<GridCamera>,
    /// Units of a depth image that make a metre, positive, used instead of the file's own. Without either, float depth
    /// is in metres and integer depth is refused. Point clouds are in metres and ignore it.
    pub depth_scale: Option<f64>,
    /// Topics of a recording that hold the frames: of depth, of colour, of points. Which is which its messages tell. Without
    /// any they are chosen by type.
    pub topics: Vec<String>,
    /// The most pixels a frame may have; a larger one is refused before memory is taken.
    pub max_pixels: usize,
}

impl Default for Given {
    fn default() -> Self {
        Self { camera: None, depth_scale: None, topics: Vec::new(), max_pixels: DEFAULT_MAX_PIXELS }
    }
}
