//! Objects through the frames of the page, as far as it was asked.

use std::time::{Duration, Instant};

use objecthood_io::label_image;
use objecthood_track::{Tracked, Tracker};
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
    /// The label image of each frame, as PNG, or why nothing is said of it.
    frames: Vec<Result<Vec<u8>, String>>,
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

    /// Follows the objects into the next frame, or past it if nothing can be said of it: it cannot be read, as the first frames of a stream, which
    /// are gone, or it was not taken after the last one.
    ///
    /// # Errors
    /// [`Error::NoFrame`], and those of the tracker.
    fn step(&mut self, session: &Session) -> Result<()> {
        match self.track(session) {
            Ok(tracked) => {
                let labels = label_image::encode(&tracked.labels)?;
                self.film.take(&tracked);
                self.film.show(&tracked);
                self.frames.push(Ok(labels));
            }
            Err(error @ (Error::Unreadable(_) | Error::Track(objecthood_track::Error::Stamp { .. }))) => {
                self.tracker.skip();
                self.film.skip();
                self.frames.push(Err(error.to_string()));
            }
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// Reads the next frame and follows the objects into it.
    ///
    /// # Errors
    /// [`Error::NoFrame`], [`Error::Unreadable`], and those of the tracker.
    fn track(&mut self, session: &Session) -> Result<Tracked> {
        let number = self.frames.len();
        let capture = session.read(number)?;
        let stamp_s = capture.stamp_s(number, self.last_stamp_s, RATE_HZ);
        let tracked = self.tracker.update(&capture.frame, stamp_s, None)?;
        self.last_stamp_s = Some(stamp_s);
        Ok(tracked)
    }
}

/// Goes on with `kept`, or anew if the parameters are others, until the frame that is asked for or until the turn is over. The answer is packed as
/// a look is: what is known of the video, `next`, the first frame that was not followed yet, and once the frame was, its tracks, or `silence`, why
/// nothing is said of it.
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
    match following.frames.get(asked.frame) {
        Some(Ok(png)) => {
            header["paths"] = json!(following.film.paths(asked.frame));
            maps.push(labels("tracks", &label_image::decode(png)?));
        }
        Some(Err(why)) => header["silence"] = json!(why),
        None => {}
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

    /// A flat wall, taken at a time (s) if that is known.
    fn flat(time_s: Option<i64>) -> Capture {
        let depth_m = Raster::from_vec(64, 48, vec![1.0; 64 * 48]).unwrap();
        let frame = Frame::new(depth_m, None, Camera::new(60.0, 60.0, 31.5, 23.5).unwrap()).unwrap();
        let mut capture = Capture::new(frame);
        capture.stamp_ns = time_s.map(|time_s| time_s * 1_000_000_000);
        capture
    }

    /// A session of frames that are read, or cannot be.
    fn session(frames: Vec<Result<Capture, &'static str>>) -> Session {
        let source = |frame: Result<Capture, &'static str>| {
            FrameSource::new(String::new(), move || frame.clone().map_err(str::to_owned))
        };
        let frames = Arc::new(FrameList::of(frames.into_iter().map(source).collect()));
        Session { title: String::new(), words: Vec::new(), frames, params: Params::default() }
    }

    /// Follows objects to a frame: what was followed, and the header of the last answer.
    fn follow_to(frame: usize, session: &Session) -> (Following, serde_json::Value) {
        let (mut kept, asked) = (None, Asked { frame, settings: Settings::default() });
        loop {
            let packed = follow(&mut kept, session, &asked).unwrap();
            if kept.as_ref().is_some_and(|following: &Following| following.frames.len() > frame) {
                let length = u32::from_le_bytes(packed[..4].try_into().unwrap()) as usize;
                return (kept.unwrap(), serde_json::from_slice(&packed[4..4 + length]).unwrap());
            }
        }
    }

    fn are_told(following: &Following) -> Vec<bool> {
        following.frames.iter().map(Result::is_ok).collect()
    }

    #[test]
    fn a_frame_that_cannot_be_read_is_passed() {
        let session = session(vec![Err("gone"), Ok(flat(None)), Ok(flat(None))]);
        let (following, _) = follow_to(2, &session);
        assert_eq!(are_told(&following), [false, true, true]);
        assert_eq!(following.film.frames(), 3);
        let behind = Asked { frame: 3, settings: Settings::default() };
        let ends = follow(&mut Some(following), &session, &behind);
        assert!(matches!(ends, Err(Error::NoFrame { frame: 3, last: 2 })));
    }

    /// Following ended at it with an error, and came no further.
    #[test]
    fn a_frame_with_the_stamp_of_the_last_is_passed() {
        let session = session([3, 4, 4, 2, 5].map(|time_s| Ok(flat(Some(time_s)))).to_vec());
        let (following, header) = follow_to(4, &session);
        assert_eq!(are_told(&following), [true, true, false, false, true]);
        assert_eq!(following.film.frames(), 5);
        assert_eq!(header["silence"], json!(null));
        let (_, header) = follow_to(2, &session);
        let why = header["silence"].as_str().unwrap();
        assert!(why.starts_with("the stamp 4 s is not after that of the last frame, 4 s"), "{why}");
    }
}
