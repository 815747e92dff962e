//! Every parameter of both methods, with unit, range, default and the source of the default.
//!
//! There is one group for each algorithm. `parameters!` generates the structs, their defaults, the validation and the table of
//! `objecthood params` from one text.

mod allowed;
mod choices;
mod gravity;
#[macro_use]
mod declare;
mod info;
mod profile;

pub use choices::{Channels, ColorFor, Method, NoiseFrom, Profile, UpFrom};
pub use info::{ParameterInfo, Reader};

use serde::{Deserialize, Serialize};

use crate::error::Result;
use crate::params::allowed::{Allowed, Number, OneOf, check};
use crate::params::choices::Choice;
use crate::stage::Stage;

parameters! {
    /// The noise of the depth sensor.
    Sensor sensor, read by [Paper: Superpixels, Context: Normals] {
        /// Step of inverse depth that the sensor resolves: the unit of disparity in eq. 1.
        disparity_quantum_per_m: f64 = 0.00285, 1e-6..=1.0, "1/m",
            "measured on mOSD learn, a Kinect v1; 1/348 by its disparity law (docs/CONTEXT.md 0.2)";
        /// Sideways noise of points, which looks like noise of disparity on slopes (`context`).
        lateral_noise_px: f64 = 0.8, 0.0..=100.0, "px at a focal length of 525 px", "tuned on mOSD learn (docs/CONTEXT.md 1.2)", read by [Context: Normals];
        /// Source of the noise that tolerances follow (`context`): estimated from each frame, or given by the quantum alone, as a Kinect's.
        noise: NoiseFrom = NoiseFrom::Estimated, OneOf("estimated | given"), "dimensionless: switch", "ours, because no constant fits every sensor (docs/CONTEXT.md 0.5)", read by [Context: Normals];
        /// Kind of the sensor (`context`): its noise counts where a frame tells little of its own. `--profile` also sets
        /// `sensor.lateral_noise_px`.
        profile: Profile = Profile::None, OneOf("none | kinect | stereo | tof | phone"), "dimensionless: switch", "ours, because a frame mostly tells it better (docs/CONTEXT.md 0.6)", read by [Context: Normals];
        /// Stages that ask colour, if there is any (`context`).
        color: ColorFor = ColorFor::All, OneOf("all | facets | none"), "dimensionless: switch", "ours, because colour tells where depth does not (docs/CONTEXT.md)", read by [Context: Normals];
    }

    /// Gaussian smoothing of the colour image before eq. 1.
    Smoothing smoothing, read by [Paper: Superpixels] {
        /// Standard deviation of the Gaussian; 0 = none.
        sigma_px: f64 = 0.5, 0.0..=10.0, "px", "paper, III-A";
    }

    /// Normals from integral images.
    Normals normals, read by [Paper: Normals] {
        /// Side of the window over which tangents are averaged; it shrinks near depth changes.
        window_px: f64 = 10.0, 2.0..=200.0, "px", "tuned on mOSD learn (PARITY.md 7)";
        /// There is a depth change between neighbours whose depths differ by more than this times z^2.
        depth_change_per_m: f32 = 0.02, 1e-5..=10.0, "1/m", "tuned on mOSD learn (PARITY.md 7)";
    }

    /// Curvature of the surface, eq. 2.
    Curvature curvature, read by [Paper: Curvature] {
        /// Whether high curvature bounds superpixels (the paper's comparison).
        enabled: bool = true, OneOf("true | false"), "dimensionless: switch", "paper, IV", read by [Paper: Superpixels];
        /// Curvature above which a pixel is a border.
        threshold: f32 = 0.14, 0.0..=2.0, "dimensionless: 1 - mean cosine of opposite normals", "paper, III-A", read by [Paper: Superpixels];
        /// Distance of the neighbours whose normals are compared.
        offset_px: usize = 2, 1..=50, "px", "paper, III-A (gamma)";
        /// Divides the sum of cosines: greater = more is curved.
        scale: f32 = 1.0, 0.1..=10.0, "dimensionless: sigma of eq. 2", "tuned on mOSD learn (PARITY.md 1); the paper gives no formula";
    }

    /// Graph over-segmentation on colour, depth and curvature, eq. 1.
    Graph graph, read by [Paper: Superpixels] {
        /// The terms of the edge weights.
        channels: Channels = Channels::Both, OneOf("color | depth | both"), "dimensionless: switch", "paper, IV";
        /// Weight of colour against disparity (alpha).
        color_weight: f32 = 0.5, 0.0..=1.0, "dimensionless: share", "paper, III-A (alpha)";
        /// Preference for large components: the step a component of one pixel tolerates (k).
        size_preference_grey: f32 = 100.0, 0.0..=1e6, "grey levels", "paper, III-A (k)";
        /// Smaller components are merged with a neighbour (n).
        min_size_px: u32 = 100, 0..=1_000_000, "px", "paper, III-A (n)";
    }

    /// Pixels of high curvature join the region that they reach over the cheapest path.
    Absorption absorption, read by [Paper: Superpixels] {
        /// No path crosses a step in depth of more than this times z^2.
        depth_gate_per_m: f32 = 0.02, 0.0..=10.0, "1/m", "tuned on mOSD learn (PARITY.md 7)";
    }

    /// Appearance of superpixels: histograms of colour and normals, eq. 3.
    Appearance appearance, read by [Paper: Facets] {
        /// Weight of the colour histogram against the histogram of normals (omega).
        color_weight: f64 = 0.5, 0.0..=1.0, "dimensionless: share", "paper, III-B (omega)";
        /// Bins per axis of the joint Lab histogram.
        lab_bins: usize = 8, 1..=32, "bins", "tuned on mOSD learn (PARITY.md 7)";
        /// Bins of the inclination of the normals, over [0, pi].
        inclination_bins: usize = 8, 1..=180, "bins", "tuned on mOSD learn (PARITY.md 7)";
        /// Bins of the azimuth of the normals, over [-pi, pi].
        azimuth_bins: usize = 16, 1..=360, "bins", "tuned on mOSD learn (PARITY.md 7)";
    }

    /// Superpixels that look alike grouped to facets.
    Grouping grouping, read by [Paper: Facets] {
        /// Internal variation of a single superpixel: the difference in appearance it tolerates (c).
        initial_variation: f64 = 0.4, 0.0..=1.0, "dimensionless: histogram distance", "tuned on mOSD learn (PARITY.md 3)";
    }

    /// Which regions touch in space.
    Contact contact, read by [Paper: Shapes, Context: Support] {
        /// Largest distance in the image to the neighbouring region, across pixels that belong to no region.
        reach_px: usize = 4, 1..=100, "px; in `context` at a focal length of 525 px", "tuned on mOSD learn (PARITY.md 7)";
        /// Points nearer than this are in contact.
        distance_m: f32 = 0.02, 0.0..=1.0, "m", "tuned on mOSD learn (PARITY.md 7)";
    }

    /// The direction "up".
    Gravity gravity, read by [Paper: Support, Context: Structure] {
        /// Source of the direction.
        up_from: UpFrom = UpFrom::Plane, OneOf("plane | camera"), "dimensionless: switch",
            "ours, because the paper's horizontal camera costs a third of the objects on mOSD learn (PARITY.md, Equations)", read by [Paper: Support, Context: Support];
        /// Angle by which the camera looks down from the horizon.
        tilt_deg: f64 = 0.0, -90.0..=90.0, "degrees", "paper, III-D: the camera is held horizontally";
        /// Angle by which the camera is turned clockwise about its optical axis.
        roll_deg: f64 = 0.0, -180.0..=180.0, "degrees", "paper, III-D: the camera is held horizontally";
        /// Points nearer to the plane than this belong to it.
        inlier_distance_m: f64 = 0.008, 1e-4..=1.0, "m", "tuned on mOSD learn (PARITY.md 5)", read by [Paper: Support];
        /// A plane that holds a smaller share of the valid points is no ground to stand on.
        min_inlier_share: f64 = 0.1, 0.0..=1.0, "dimensionless: share of valid points", "ours, because a scene without a plane has no up to read off", read by [Paper: Support];
        /// Points sampled in the search for the plane.
        samples: usize = 6000, 3..=1_000_000, "points", "ours, because more changes no plane (PARITY.md 5)", read by [Paper: Support];
        /// Planes tried.
        trials: usize = 300, 1..=100_000, "planes", "ours, because more changes no plane (PARITY.md 5)", read by [Paper: Support];
    }

    /// Planes fitted to the window around every pixel (`context`).
    LocalFit local_fit, read by [Context: Normals] {
        /// Half the side of the window, without its middle pixel; at most 199 px of the image.
        radius_px: usize = 3, 1..=50, "px at a focal length of 525 px", "docs/CONTEXT.md 0.3";
        /// A pixel keeps its own window when the residual is below this; otherwise it takes the best of nine windows.
        own_window_residual_quanta: f32 = 0.8, 0.0..=1000.0, "quanta of disparity", "docs/CONTEXT.md 0.4: a short cut that saves time";
    }

    /// Large planes that carry or enclose the objects (`context`).
    Structure structure, read by [Context: Structure] {
        /// Pixels nearer than this to the surface belong to it, if they have its tilt.
        tolerance_quanta: f64 = 2.5, 0.0..=1000.0, "quanta of disparity", "tuned on mOSD learn (docs/CONTEXT.md 1.1)";
        /// A pixel has the tilt of the surface when their normals differ by less than this.
        angle_deg: f64 = 30.0, 0.0..=180.0, "degrees", "tuned on mOSD learn (docs/CONTEXT.md 1.1)";
        /// A pixel also has the tilt of the surface when the slopes of their disparities differ by less than this; 0 = only the normals
        /// decide.
        slope_quanta_per_px: f64 = 0.4, 0.0..=1000.0, "quanta of disparity per px at a focal length of 525 px", "ours, because noise tilts a slope alike at any distance, a normal by more the farther it is; 30 degrees at 1 m";
        /// A skirt of the surface reaches at most this far, twice as far where depth is smeared; 0 = skirts are not looked for.
        skirt_reach_px: usize = 10, 0..=100, "px at a focal length of 525 px", "ours, because it is half of a matching window, and the error of registering colour with depth (docs/CONTEXT.md 1.1)";
    }

    /// Superpixels by watershed of the fit residual (`context`).
    Watershed watershed, read by [Context: Superpixels] {
        /// Side of the blocks. Each block has one seed.
        seed_block_px: usize = 8, 1..=1000, "px at a focal length of 525 px", "tuned on mOSD learn (docs/CONTEXT.md 1.2)";
        /// Largest difference between neighbouring pixels of one surface, beyond the difference that its slope explains.
        link_jump_quanta: f32 = 5.0, 0.0..=1000.0, "quanta of disparity", "tuned on mOSD learn (docs/CONTEXT.md 1.2)";
    }

    /// Superpixels that lie on one surface merged to facets (`context`).
    Merging merging, read by [Context: Facets] {
        /// Disagreement up to which planes are merged.
        plane_tolerance_quanta: f32 = 1.2, 0.0..=1000.0, "quanta of disparity", "tuned on mOSD learn (docs/CONTEXT.md 2.1)";
        /// Disagreement up to which quadratics are merged afterwards; 0 = planes only.
        quadratic_tolerance_quanta: f32 = 1.5, 0.0..=1000.0, "quanta of disparity", "tuned on mOSD learn (docs/CONTEXT.md 2.1)";
        /// Smaller facets are dropped; their pixels go to neighbouring facets.
        min_facet_px: usize = 25, 0..=1_000_000, "px at a focal length of 525 px", "tuned on mOSD learn (docs/CONTEXT.md 2.1)";
    }

    /// Borders of facets straightened (`context`).
    Refinement refinement, read by [Context: Facets] {
        /// Misfit that one neighbour in the same facet outweighs.
        agreement_quanta: f64 = 0.35, 0.0..=1000.0, "quanta of disparity", "tuned on mOSD learn (docs/CONTEXT.md 2.2)";
    }

    /// Facets cut where colour changes and the surface folds inwards (`context`).
    ColorCuts color_cuts, read by [Context: Facets] {
        /// Whether they are cut.
        enabled: bool = true, OneOf("true | false"), "dimensionless: switch", "docs/CONTEXT.md 2.3";
        /// Least vote of the border between two parts against one thing.
        least_against: f64 = 0.4, 0.0..=1.0, "dimensionless: vote per metre of border", "ours, because noise makes gentle valleys, and this is one of 18 degrees (docs/CONTEXT.md 2.3)";
    }

    /// Things 0.2 to 12 mm thick that lie flat on a support (`context`).
    Flat flat, read by [Context: Facets] {
        /// Whether they are looked for.
        enabled: bool = true, OneOf("true | false"), "dimensionless: switch", "docs/CONTEXT.md 2.4";
        /// Greatest overlap of the colours of a flat thing with those of the ring around it, where depth proves nothing.
        color_overlap: f64 = 0.35, 0.0..=1.0, "dimensionless: share in common", "ours, because 99 % of empty patches have 0.45 or more (docs/CONTEXT.md 2.4)";
        /// A rise above the ring is proof from this many times the disagreement of blocks of an empty surface on.
        offset_sigmas: f64 = 5.0, 0.0..=1000.0, "dimensionless: multiples of the noise of docs/CONTEXT.md 0.5", "ours, because empty patches of a Kinect reach four (docs/CONTEXT.md 2.4)";
    }

    /// Evidence from the common border of two facets (`context`).
    Border border, read by [Context: Borders] {
        /// Half the side of the window, without its middle pixel. In the window a plane is fitted to each side of the border.
        radius_px: usize = 7, 1..=100, "px at a focal length of 525 px", "tuned on mOSD learn (docs/CONTEXT.md 3.1)";
        /// A larger gap between the two sides is a step.
        gap_quanta: f64 = 4.0, 0.0..=1000.0, "quanta of disparity", "tuned on mOSD learn (docs/CONTEXT.md 3.1)";
        /// A deeper step hides something; a smaller one may be a torn ridge.
        step_depth_m: f64 = 0.013, 0.0..=10.0, "m", "tuned on mOSD learn (docs/CONTEXT.md 3.1)";
    }

    /// Votes of folds, steps and colours, by which facets are joined to shapes (`context`). The more a fold votes against one shape, the
    /// clearer it is as the border of an object.
    Contraction contraction, read by [Paper: Hypotheses, Context: Shapes] {
        /// Concavity at which a fold votes neither for one shape nor against it.
        reflex_offset_deg: f64 = 12.0, -180.0..=180.0, "degrees", "tuned on mOSD learn (docs/CONTEXT.md 3.2)";
        /// Angle between no vote and a full vote.
        full_vote_deg: f64 = 15.0, 1e-3..=360.0, "degrees", "tuned on mOSD learn (docs/CONTEXT.md 3.2)";
        /// Vote of a step against one shape.
        occlusion_weight: f64 = 0.15, 0.0..=100.0, "dimensionless: vote per metre of step", "tuned on mOSD learn (docs/CONTEXT.md 3.2)", read by [Context: Shapes];
        /// Vote of a seam of colour against one shape.
        seam_weight: f64 = 2.0, 0.0..=100.0, "dimensionless: vote per metre of seam", "ours, because it has to outvote a flat border as clearly as a valley does (docs/CONTEXT.md 3.4)", read by [Context: Shapes];
        /// What a fold between facets of different colours votes against one shape, besides its angle.
        color_change_weight: f64 = 0.4, 0.0..=100.0, "dimensionless: vote per metre of fold", "ours, because with half the vote of a flat border a valley of 6 degrees parts two colours, and a flat border does not (docs/CONTEXT.md 3.2)", read by [Context: Shapes];
    }

    /// Seams of colour that part flush things (`context`).
    Seams seams, read by [Context: Shapes] {
        /// Whether colour parts flush things.
        enabled: bool = true, OneOf("true | false"), "dimensionless: switch", "docs/CONTEXT.md 3.4";
        /// Least share of a section of the body where colour changes.
        cross_share: f64 = 0.7, 0.0..=1.0, "dimensionless: share of the section", "ours, because print ends within a face (docs/CONTEXT.md 3.4)";
        /// Greatest overlap of the colours of both sides.
        color_overlap: f64 = 0.12, 0.0..=1.0, "dimensionless: share in common", "ours, because print comes back on the other side (docs/CONTEXT.md 3.4)";
    }

    /// Small clusters are given to a neighbour (`context`).
    Fragments fragments, read by [Context: Clusters] {
        /// Clusters with fewer pixels are given away.
        max_size_px: usize = 250, 0..=1_000_000, "px at a focal length of 525 px", "tuned on mOSD learn (docs/CONTEXT.md 4.2)";
    }

    /// Clusters that hardly rise above the support are a part of it (`context`).
    Height height, read by [Context: Clusters] {
        /// Lowest top of an object.
        min_top_m: f64 = 0.010, -1.0..=10.0, "m", "tuned on mOSD learn (docs/CONTEXT.md 4.3)";
    }

    /// Insides and walls of vessels joined (`context`).
    Vessels vessels, read by [Context: Clusters] {
        /// Concavity of a vessel's inside; 0 = vessels are not joined.
        concavity: f64 = 0.2, 0.0..=2.0, "dimensionless: mean turn of normals towards each other", "tuned on mOSD learn (docs/CONTEXT.md 4.4)";
        /// The tops of inside and wall differ in height by at most this.
        rim_height_m: f64 = 0.015, 0.0..=1.0, "m", "tuned on mOSD learn (docs/CONTEXT.md 4.4)";
        /// Whether the circle of the rim decides which parts belong to a vessel.
        rim_circle: bool = true, OneOf("true | false"), "dimensionless: switch", "docs/CONTEXT.md 4.4.2";
        /// Background, or a flat cluster, that an object encloses is its bottom when at least this share of its border touches
        /// without a step; above 1 = never.
        bottom_contact_share: f64 = 0.8, 0.0..=2.0, "dimensionless: share of the border", "ours, because a plate came out as a ring; the far half of a ring's border touches";
    }

    /// Convex parts of one body joined across a neck or fold (`context`).
    Necks necks, read by [Context: Clusters] {
        /// Whether such parts are joined.
        enabled: bool = true, OneOf("true | false"), "dimensionless: switch", "docs/CONTEXT.md 4.7";
        /// Least overlap of their colour histograms.
        color_overlap: f64 = 0.55, 0.0..=1.0, "dimensionless: share in common", "ours, because parts of one body share colours (docs/CONTEXT.md 4.7)";
    }

    /// Parts of an object joined behind an occluder (`context`).
    Occlusion occlusion, read by [Context: Clusters] {
        /// Whether such parts are joined.
        enabled: bool = true, OneOf("true | false"), "dimensionless: switch", "docs/CONTEXT.md 4.6";
        /// Disagreement up to which both parts lie on one surface.
        disagreement_quanta: f64 = 1.0, 0.0..=1000.0, "quanta of disparity", "tuned on mOSD learn (docs/CONTEXT.md 4.6)";
        /// Largest angle between the surfaces of both parts.
        angle_deg: f64 = 7.0, 0.0..=180.0, "degrees", "tuned on mOSD learn (docs/CONTEXT.md 4.6)";
        /// Least overlap of their colour histograms.
        color_overlap: f64 = 0.08, -1.0..=1.0, "dimensionless: share in common; -1 = colour has no say", "tuned on mOSD learn (docs/CONTEXT.md 4.6)";
        /// Largest distance between the parts.
        max_distance_m: f64 = 0.35, 0.0..=100.0, "m", "tuned on mOSD learn (docs/CONTEXT.md 4.6)";
    }

    /// The score of a hypothesis and its threshold: eq. 6 to 8, and the questions that the paper leaves open.
    Objectness objectness, read by [Paper: Hypotheses, Context: Hypotheses] {
        /// Least length of an object's longest side.
        min_side_m: f32 = 0.02, 0.0..=100.0, "m", "tuned on mOSD learn (PARITY.md 7)", read by [Paper: Objects];
        /// Least length of a graspable object's second-longest side; in objectness a soft limit.
        min_second_side_m: f32 = 0.02, 1e-3..=100.0, "m", "ours, because what is thinner in two directions is a sliver of something; the paper's 2 cm";
        /// Greatest length of an object's longest side; in objectness a soft limit.
        max_side_m: f32 = 0.60, 1e-3..=100.0, "m", "tuned on mOSD learn (PARITY.md 7)", read by [Paper: Hypotheses, Context: Support];
        /// Greatest length of a graspable object's second-longest side; in objectness a soft limit.
        max_second_side_m: f32 = 0.35, 1e-3..=100.0, "m", "ours, because what is larger in two directions is furniture, and no hand spans it (docs/EVALUATION.md)";
        /// Least number of pixels with depth of an object.
        min_size_px: usize = 200, 1..=100_000_000, "px; in `context` at a focal length of 525 px", "tuned on mOSD learn (PARITY.md 7)", read by [Paper: Hypotheses, Context: Support];
        /// Least P(O) of an object.
        min_p_o: f32 = 0.7, 0.0..=1.0, "dimensionless: probability", "tuned on mOSD learn (PARITY.md 7)", read by [Paper: Objects];
        /// Share that objectness loses when the size is not graspable.
        size_weight: f32 = 1.0, 0.0..=1.0, "dimensionless: share", "ours, because what is too large cannot be moved, whatever else it is";
        /// Share that objectness loses when nothing carries the object.
        support_weight: f32 = 0.3, 0.0..=1.0, "dimensionless: share", "ours, because what carries it may be hidden; alone it refuses nothing";
        /// Share that objectness loses when the object is seen to hang in the air.
        footing_weight: f32 = 0.5, 0.0..=1.0, "dimensionless: share", "ours, because people, arms and furniture come in pieces that hang in the air (docs/EVALUATION.md)", read by [Context: Hypotheses];
        /// Share that objectness loses when the object fills nothing of its hull.
        compactness_weight: f32 = 0.3, 0.0..=1.0, "dimensionless: share", "ours, because handles and rings are no less things; alone it refuses nothing";
        /// Share that objectness loses when no border of the object is clear.
        separation_weight: f32 = 1.0, 0.0..=1.0, "dimensionless: share", "ours, because what has no border of its own is a part of something";
        /// Share that objectness loses when nothing of the outline is the object's own.
        visibility_weight: f32 = 0.1, 0.0..=1.0, "dimensionless: share", "ours, because what is half hidden is there all the same";
        /// Least objectness of an object.
        threshold: f32 = 0.55, 0.0..=1.0, "dimensionless: objectness", "ours, because it costs no correct object of mOSD learn nor of scenes composed of it (docs/EVALUATION.md)", read by [Context: Objects];
        /// Whether rejected hypotheses are written as well (`--all`).
        every_hypothesis: bool = false, OneOf("true | false"), "dimensionless: switch", "ours, because the score tells more than a verdict", read by [Paper: Objects, Context: Objects];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_are_valid_and_all_in_the_table() {
        let params = Params::default();
        params.validate().unwrap();
        let table = Params::table();
        assert!(table.iter().any(|p| p.name == "curvature.threshold" && p.default == "0.14"));
        assert!(
            table
                .iter()
                .all(|p| !p.unit.is_empty() && !p.source.is_empty() && p.meaning.ends_with(['.', ')']))
        );
        assert!(table.iter().all(|p| p.unit != "dimensionless"), "say what it means");
        assert!(
            table.iter().all(|p| !p.readers.is_empty() && p.limits().is_some() == (p.choices().len() < 2))
        );
    }

    #[test]
    fn numbers_are_read_and_set_by_name() {
        let default = Params::default();
        for info in Params::table() {
            let Some((least, greatest)) = info.limits() else {
                assert_eq!(default.number(&info.name), None, "{}", info.name);
                assert!(default.with_number(&info.name, 1.0).is_none(), "{}", info.name);
                continue;
            };
            assert_eq!(default.number(&info.name), info.default.parse().ok(), "{}", info.name);
            for limit in [least, greatest] {
                let other = default.with_number(&info.name, limit).unwrap();
                assert_eq!(other.number(&info.name), Some(limit), "{}", info.name);
            }
            assert!(default.with_number(&info.name, greatest + 1.0).is_none(), "{}", info.name);
        }
        assert_eq!(default.with_number("fragments.max_size_px", 9.0).unwrap().fragments.max_size_px, 9);
        assert!(default.with_number("fragments.max_size_px", 9.5).is_none());
        assert!(default.with_number("fragments.nothing", 9.0).is_none());
        assert_eq!((default.number("nothing"), default.number("a.b")), (None, None));
    }

    #[test]
    fn choices_are_read_and_set_by_name() {
        let default = Params::default();
        for info in Params::table() {
            let now = default.choice(&info.name);
            assert_eq!(now, info.limits().is_none().then(|| info.default.clone()), "{}", info.name);
            for choice in info.choices() {
                let other = default.with_choice(&info.name, choice).unwrap();
                assert_eq!(other.choice(&info.name).as_deref(), Some(choice), "{}", info.name);
            }
            assert!(default.with_choice(&info.name, "7").is_none(), "{}", info.name);
        }
        assert!(default.with_choice("flat.nothing", "true").is_none() && default.choice("nothing").is_none());
    }

    #[test]
    fn a_value_outside_its_range_is_named() {
        let mut params = Params::default();
        params.curvature.threshold = f32::NAN;
        let message = params.validate().unwrap_err().to_string();
        assert!(message.contains("curvature.threshold = NaN"), "{message}");
    }
}
