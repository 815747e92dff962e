//! Which parameter may have been meant by a name that does not exist.

use objecthood::ParameterInfo;
use strsim::normalized_damerau_levenshtein as likeness;

/// Names less alike than this are not taken for a slip of the pen.
const ALIKE: f64 = 0.5;
/// No more than this many are proposed.
const PROPOSED: usize = 3;

/// Says of a parameter `key` that does not exist which ones may have been meant; if none is like it, what its group holds;
/// if there is no such group either, where all are listed.
pub(super) fn no_such_parameter(known: &[ParameterInfo], key: &str) -> String {
    let wanted = key.to_lowercase();
    let group = wanted.split_once('.').map_or(&*wanted, |(group, _)| group);
    let all = || known.iter().map(|info| info.name.as_str());
    let siblings: Vec<&str> = all().filter(|name| before_dot(name) == group).collect();

    // In a group that exists only the name is in doubt, and a name without a group is compared with names alone.
    let mut alike: Vec<(f64, &str)> = match (siblings.is_empty(), wanted.split_once('.')) {
        (false, name) => {
            let name = name.map_or("", |(_, name)| name);
            siblings.iter().map(|full| (likeness(after_dot(full), name), *full)).collect()
        }
        (true, Some(_)) => all().map(|full| (likeness(full, &wanted), full)).collect(),
        (true, None) => all().map(|full| (likeness(after_dot(full), &wanted), full)).collect(),
    };
    alike.sort_by(|a, b| b.0.total_cmp(&a.0));
    let best = alike.first().map_or(0.0, |first| first.0);
    let near = alike.iter().take_while(|(likeness, _)| *likeness >= (best - 0.05).max(ALIKE)).take(PROPOSED);
    let near: Vec<String> = near.map(|(_, name)| format!("`{name}`")).collect();

    let advice = if !near.is_empty() {
        format!("did you mean {}? `objecthood params` lists all", near.join(" or "))
    } else if !siblings.is_empty() {
        let names: Vec<&str> = siblings.iter().map(|full| after_dot(full)).collect();
        format!("those of the group {group} are {}", names.join(", "))
    } else {
        "`objecthood params` lists all".to_owned()
    };
    format!("there is no parameter `{key}`: {advice}")
}

fn before_dot(full: &str) -> &str {
    full.split_once('.').map_or("", |(group, _)| group)
}

fn after_dot(full: &str) -> &str {
    full.split_once('.').map_or(full, |(_, name)| name)
}

#[cfg(test)]
mod tests {
    use objecthood::Params;

    use super::*;

    /// `objectness.foo` was answered with `objectness.min_p_o`.
    #[test]
    fn what_is_like_nothing_in_its_group_is_answered_with_the_group() {
        let said = |key| no_such_parameter(&Params::table(), key);
        for key in ["objectness.foo", "objectness", "objectness."] {
            let said = said(key);
            assert!(
                said.contains("of the group objectness are min_side_m, ") && !said.contains("mean"),
                "{said}"
            );
        }
        assert!(said("objectness.treshold").contains("did you mean `objectness.threshold`?"));
        assert!(said("curvatur.threshold").contains("did you mean `curvature.threshold`?"));
        assert!(said("threshold").contains("`curvature.threshold` or `objectness.threshold`?"));
        for key in ["z", "foo.bar", "", ".", "ü"] {
            assert!(said(key).ends_with(": `objecthood params` lists all"), "{}", said(key));
        }
    }
}
