//! Parameters that are a choice between names.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A value that may be a choice between names; a switch has the names `true` and `false`.
pub(super) trait Choice: Sized {
    /// The name that was chosen.
    fn choice(&self) -> Option<String>;
    /// The value of this type with this name, if there is one.
    fn from_choice(name: &str) -> Option<Self>;
}

/// A choice between names that are the same in a file, on the command line and in the table.
macro_rules! choice {
    ($(#[$doc:meta])* $Name:ident { $($(#[$variant_doc:meta])* $Variant:ident = $word:literal),+ $(,)? }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
        pub enum $Name {
            $($(#[$variant_doc])* #[serde(rename = $word)] $Variant),+
        }

        impl fmt::Display for $Name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self { $(Self::$Variant => $word),+ })
            }
        }

        impl Choice for $Name {
            fn choice(&self) -> Option<String> {
                Some(self.to_string())
            }
            fn from_choice(name: &str) -> Option<Self> {
                match name { $($word => Some(Self::$Variant),)+ _ => None }
            }
        }
    };
}

choice! {
    /// A method: an implementation of the four stages.
    Method {
        /// Surfaces fitted in disparity, joined by their borders and surroundings.
        #[default]
        Context = "context",
        /// The published method, equation by equation.
        Paper = "paper",
    }
}

choice! {
    /// Source of the sensor's noise in `context`.
    NoiseFrom {
        /// Estimated from the frame.
        #[default]
        Estimated = "estimated",
        /// That of `sensor.profile`; without a profile a Kinect's.
        Given = "given",
    }
}

choice! {
    /// The stages of `context` that ask colour (`eval --ablation` compares them).
    ColorFor {
        /// All of them.
        #[default]
        All = "all",
        /// Single pixels and the first two, but for skirts: smeared edges, cuts of facets and flat things (docs/CONTEXT.md 0.7, 2.3, 2.4).
        Facets = "facets",
        /// None: depth alone decides.
        None = "none",
    }
}

choice! {
    /// A kind of depth sensor, of which published figures are known (docs/CONTEXT.md 0.6).
    Profile {
        /// Not known: a frame alone tells of its noise.
        #[default]
        None = "none",
        /// Kinect v1, Xtion: structured light.
        Kinect = "kinect",
        /// `RealSense` D400: active stereo.
        Stereo = "stereo",
        /// Azure Kinect, Kinect v2: time of flight.
        Tof = "tof",
        /// Phone: few measurements, made dense and smooth.
        Phone = "phone",
    }
}

choice! {
    /// The terms in the weight of an edge between two pixels (the paper's comparison).
    Channels {
        /// Colour difference only.
        Color = "color",
        /// Disparity difference only.
        Depth = "depth",
        /// Both, as in eq. 1.
        #[default]
        Both = "both",
    }
}

choice! {
    /// Source of the direction "up".
    UpFrom {
        /// The normal of the dominant plane.
        #[default]
        Plane = "plane",
        /// The camera's own up, from its tilt and roll. When it is held horizontally, up is opposite to its y axis.
        Camera = "camera",
    }
}
