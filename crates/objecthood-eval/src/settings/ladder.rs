//! The steps of `context` switched on one after the other (docs/EVALUATION.md, Ladder).

use objecthood::Params;

use super::Setting;

/// Name of the ladder's foot, where all steps are off.
const FOOT: &str = "plane facets, convexity";

/// A step of the method and how to do without it.
struct Step {
    name: &'static str,
    switch_off: fn(&mut Params),
}

/// In the order in which they are switched on: that of the reference (PARITY.md), then what came later.
const STEPS: [Step; 19] = [
    Step { name: "occlusion evidence", switch_off: |p| p.contraction.occlusion_weight = 0.0 },
    Step { name: "straight borders", switch_off: |p| p.refinement.agreement_quanta = 0.0 },
    Step { name: "fragments", switch_off: |p| p.fragments.max_size_px = 0 },
    Step { name: "height filter", switch_off: |p| p.height.min_top_m = -1.0 },
    Step { name: "lateral noise", switch_off: |p| p.sensor.lateral_noise_px = 0.0 },
    Step { name: "quadratic facets", switch_off: |p| p.merging.quadratic_tolerance_quanta = 0.0 },
    Step { name: "convex small steps", switch_off: |p| p.border.step_depth_m = 0.0 },
    Step { name: "vessels by concavity", switch_off: |p| p.vessels.concavity = 0.0 },
    Step { name: "rim circle", switch_off: |p| p.vessels.rim_circle = false },
    Step { name: "occlusion joins", switch_off: |p| p.occlusion.enabled = false },
    Step { name: "far walls by slope", switch_off: |p| p.structure.slope_quanta_per_px = 0.0 },
    Step { name: "bottoms of plates", switch_off: |p| p.vessels.bottom_contact_share = 2.0 },
    Step { name: "cuts along colour", switch_off: |p| p.color_cuts.enabled = false },
    Step { name: "changes of colour", switch_off: |p| p.contraction.color_change_weight = 0.0 },
    Step { name: "flat things", switch_off: |p| p.flat.enabled = false },
    Step { name: "seams", switch_off: |p| p.seams.enabled = false },
    Step { name: "necks", switch_off: |p| p.necks.enabled = false },
    Step { name: "skirts", switch_off: |p| p.structure.skirt_reach_px = 0 },
    Step { name: "objectness", switch_off: |p| p.objectness.every_hypothesis = true },
];

/// A setting a rung, the first without any step, the last `params` itself; then one setting for each step left out alone.
pub fn ladder(params: &Params) -> Vec<Setting> {
    let without = |steps: &[Step]| {
        let mut params = params.clone();
        steps.iter().for_each(|step| (step.switch_off)(&mut params));
        params
    };
    let mut settings = vec![Setting { name: FOOT.to_owned(), params: without(&STEPS) }];
    for (k, step) in STEPS.iter().enumerate() {
        settings.push(Setting { name: format!("+ {}", step.name), params: without(&STEPS[k + 1..]) });
    }
    // The last step left out alone is the rung below the last.
    for step in &STEPS[..STEPS.len() - 1] {
        let alone = std::slice::from_ref(step);
        settings.push(Setting { name: format!("without {}", step.name), params: without(alone) });
    }
    settings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_changes_something_and_the_last_rung_is_the_method() {
        let params = Params::default();
        let settings = ladder(&params);
        assert_eq!(settings.len(), 1 + STEPS.len() + STEPS.len() - 1);
        assert_eq!(settings[STEPS.len()].params, params);
        for (k, a) in settings.iter().enumerate() {
            a.params.validate().unwrap();
            assert!(settings[..k].iter().all(|b| a.params != b.params && a.name != b.name), "{}", a.name);
        }
    }
}
