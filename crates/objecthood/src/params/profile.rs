//! Published figures of kinds of sensors (docs/CONTEXT.md 0.6 names the publications).

use crate::params::{Profile, Sensor};

/// Published figures of a kind of sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Figures {
    /// Standard deviation of depth at 1 m (m).
    at_1_m: f64,
    /// It grows with this power of depth: 2 for triangulation, 1 for time of flight.
    power: i32,
    /// Sideways noise of points (px at a focal length of 525 px).
    pub(crate) lateral_px: f64,
    /// Values d px apart have the correlation exp(-d² / (4 `correlation_px`²)); 0 = none (px at a focal length of 525 px).
    pub(crate) correlation_px: f64,
}

impl Figures {
    /// Half a step of disparity: Khoshelham and Elberink 2012. Lateral: Nguyen, Izadi and Lovell 2012.
    const KINECT: Self = Self { at_1_m: 1.425e-3, power: 2, lateral_px: 0.8, correlation_px: 1.5 };
    /// 0.05 px of disparity at a focal length of 383 px and a baseline of 50 mm: Intel 2018.
    const STEREO: Self = Self { at_1_m: 2.61e-3, power: 2, lateral_px: 0.7, correlation_px: 5.0 };
    /// 0.7 mm at 1 m of a white surface, of which half the light returns: Tölgyessy et al. 2021.
    const TOF: Self = Self { at_1_m: 0.99e-3, power: 1, lateral_px: 0.29, correlation_px: 0.0 };
    /// 0.3 % of the depth: Luetzenburg, Kroon and Bjørk 2021. One measurement in 4 x 4 px: Apple, `ARKit`.
    const PHONE: Self = Self { at_1_m: 3.0e-3, power: 1, lateral_px: 1.15, correlation_px: 6.0 };

    /// Standard deviation of depth (m) at depth `z_m`.
    pub(crate) fn deviation_m(&self, z_m: f64) -> f64 {
        self.at_1_m * z_m.powi(self.power)
    }
}

impl Profile {
    /// The figures of this kind of sensor; `None` when it is not known.
    pub(crate) fn figures(self) -> Option<Figures> {
        Some(match self {
            Self::None => return None,
            Self::Kinect => Figures::KINECT,
            Self::Stereo => Figures::STEREO,
            Self::Tof => Figures::TOF,
            Self::Phone => Figures::PHONE,
        })
    }
}

impl Sensor {
    /// The parameters of a kind of sensor: the profile, and its sideways noise.
    pub fn of(profile: Profile) -> Self {
        let sensor = Self { profile, ..Self::default() };
        let lateral = profile.figures().map(|figures| figures.lateral_px);
        Self { lateral_noise_px: lateral.unwrap_or(sensor.lateral_noise_px), ..sensor }
    }
}
