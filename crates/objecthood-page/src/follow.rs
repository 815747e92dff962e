//! Objects through the frames of the page, as far as it was asked.

use std::time::{Duration, Instant};

use objecthood_io::label_image;
use objecthood_track::Tracker;
use serde::Deserialize;
use serde_json::json;

use crate::error::{Error, Result};
use crate::film::Film;
use crate::maps::labels;
use crate::pack::pack;
use crate::session::Session;
use crate::settings::Settings;

/// An answer is given after this time, however far the frames were followed: the page asks again.
const TURN: Duration = Duration::from_millis(400);
/// Frames whose tracks are kept, about 5 kB each.
const MOST_FRAMES: usize = 4000;
/// Frames a second, where frames have no times.
const RATE_HZ: f64 = 30.0;

/// Up to which frame to follow.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Asked {
    /// The number of the frame.
    pub(crate) frame: usize,
    /// The parameters.
    pub(crate) settings: Settings,
}

/// A tracker, and what it said of the frames from the first one on.
pub(crate) struct Following {
    settings: Settings,
    tracker: Tracker,
    film: Film,
    last_stamp_s: Option<f64>,
    /// The label image of each frame, as PNG; none of a frame that cannot be read.
    frames: Vec<Option<Vec<u8>>>,
}

impl Following {
    /// Nothing is followed yet.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    fn new(settings: &Settings) -> Result<Self> {
        Ok(Self {
            settings: settings.clone(),
            tracker: Tracker::new(settings.params()?),
            film: Film::default(),
            last_stamp_s: None,
            frames: Vec::new(),
        })
    }

    /// Follows the objects into the next frame, or past it if it cannot be read: the first frames of a stream are gone.
    ///
    /// # Errors
    /// [`Error::NoFrame`], and those of the tracker.
    fn step(&mut self, session: &Session) -> Result<()> {
        let number = self.frames.len();
        let capture = match session.read(number) {
            Err(Error::Unreadable(_)) => {
                self.film.skip();
                self.frames.push(None);
                return Ok(());
            }
            read => read?,
        };
        let stamp_s = capture.stamp_s(number, self.last_stamp_s, RATE_HZ);
        let tracked = self.tracker.update(&capture.frame, stamp_s, None)?;
        self.last_stamp_s = Some(stamp_s);
        self.film.take(&tracked);
        self.film.show(&tracked);
        self.frames.push(Some(label_image::encode(&tracked.labels)?));
        Ok(())
    }
}

/// Goes on with `kept`, or anew if the parameters are others, until the frame that is asked for or until the turn is over. The answer is packed as
/// a look is: what is known of the video, `next`, the first frame that was not followed yet, and the tracks of the frame once it was.
///
/// # Errors
/// [`Error::TooLong`] behind the frames that are kept; [`Error::NoFrame`], and those of the tracker.
pub(crate) fn follow(kept: &mut Option<Following>, session: &Session, asked: &Asked) -> Result<Vec<u8>> {
    if asked.frame >= MOST_FRAMES {
        return Err(Error::TooLong { most: MOST_FRAMES });
    }
    let following = match kept.take() {
        Some(same) if same.settings == asked.settings => kept.insert(same),
        _ => kept.insert(Following::new(&asked.settings)?),
    };
    let start = Instant::now();
    while following.frames.len() <= asked.frame && start.elapsed() < TURN {
        following.step(session)?;
    }
    let mut header = json!({ "frame": asked.frame, "next": following.frames.len(), "film": following.film });
    let mut maps = Vec::new();
    if let Some(Some(png)) = following.frames.get(asked.frame) {
        header["paths"] = json!(following.film.paths(asked.frame));
        maps.push(labels("tracks", &label_image::decode(png)?));
    }
    pack(header, &maps)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use objecthood::{Camera, Frame, Params, Raster};
    use objecthood_io::Capture;

    use super::*;
    use crate::session::{FrameList, FrameSource};

    #[test]
    fn a_frame_that_cannot_be_read_is_passed() {
        let flat = || {
            let depth_m = Raster::from_vec(64, 48, vec![1.0; 64 * 48]).unwrap();
            Ok(Capture::new(Frame::new(depth_m, None, Camera::new(60.0, 60.0, 31.5, 23.5).unwrap()).unwrap()))
        };
        let gone = || Err("gone".to_owned());
        let frames = FrameList::of(vec![
            FrameSource::new("0".to_owned(), gone),
            FrameSource::new("1".to_owned(), flat),
            FrameSource::new("2".to_owned(), flat),
        ]);
        let session = Session {
            title: String::new(),
            words: Vec::new(),
            frames: Arc::new(frames),
            params: Params::default(),
        };
        let mut kept = None;
        let asked = Asked { frame: 2, settings: Settings::default() };
        while kept.as_ref().is_none_or(|following: &Following| following.frames.len() < 3) {
            follow(&mut kept, &session, &asked).unwrap();
        }
        let following = kept.as_ref().unwrap();
        assert_eq!(following.frames.iter().map(Option::is_some).collect::<Vec<_>>(), [false, true, true]);
        assert_eq!(following.film.frames(), 3);
        let behind = Asked { frame: 3, settings: Settings::default() };
        assert!(matches!(follow(&mut kept, &session, &behind), Err(Error::NoFrame { frame: 3, last: 2 })));
    }
}
