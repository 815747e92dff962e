//! What colour is worth: for `paper` its own comparison of what bounds superpixels (its section IV), for `context` by stages.

use objecthood::params::{Channels, ColorFor};
use objecthood::{Method, Params};

use super::Setting;

/// The parameters that [`ablation`] goes through with a method.
pub fn ablated(method: Method) -> &'static [&'static str] {
    match method {
        Method::Paper => &["graph.channels", "curvature.enabled"],
        Method::Context => &["sensor.color"],
    }
}

/// All else as in `params`. `paper`: colour, depth and both, each without and with curvature. `context`: depth alone, colour for its
/// first two stages but for skirts, and for all.
pub fn ablation(params: &Params) -> Vec<Setting> {
    match params.method {
        Method::Paper => {
            let channels = [Channels::Color, Channels::Depth, Channels::Both];
            let settings = [(false, "off"), (true, "on")].map(|(enabled, word)| {
                channels.map(|channels| {
                    let mut params = params.clone();
                    params.graph.channels = channels;
                    params.curvature.enabled = enabled;
                    Setting { name: format!("{channels}, curvature {word}"), params }
                })
            });
            settings.into_iter().flatten().collect()
        }
        Method::Context => {
            let settings = [
                (ColorFor::None, "depth only"),
                (ColorFor::Facets, "colour for stages 1 and 2, without skirts"),
                (ColorFor::All, "colour for all stages"),
            ];
            let setting = |(color, name): (ColorFor, &str)| {
                let mut params = params.clone();
                params.sensor.color = color;
                Setting { name: name.to_owned(), params }
            };
            settings.map(setting).into()
        }
    }
}
