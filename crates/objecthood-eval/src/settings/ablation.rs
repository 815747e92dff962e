//! The paper's comparison of what bounds superpixels (its section IV).

use objecthood::Params;
use objecthood::params::Channels;

use super::Setting;

/// The parameters that [`ablation`] goes through; `paper` reads them.
pub const ABLATED: [&str; 2] = ["graph.channels", "curvature.enabled"];

/// Colour, depth and both, each without and with curvature; all else as in `params`.
pub fn ablation(params: &Params) -> Vec<Setting> {
    let mut settings = Vec::new();
    for (enabled, word) in [(false, "off"), (true, "on")] {
        for channels in [Channels::Color, Channels::Depth, Channels::Both] {
            let mut params = params.clone();
            params.graph.channels = channels;
            params.curvature.enabled = enabled;
            settings.push(Setting { name: format!("{channels}, curvature {word}"), params });
        }
    }
    settings
}
