//! One frame of a video and what is true of it.

use std::collections::BTreeSet;

use objecthood::Raster;

/// Which instances of a true frame are what. What is listed nowhere is background: tables, floors, walls.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Roles {
    /// The things to find and follow.
    pub objects: BTreeSet<u16>,
    /// Agents, and things of which the truth does not say whether they are objects. Who finds them is not punished.
    pub unpunished: BTreeSet<u16>,
    /// Things that nothing tells apart yet, because they are flush or closed: each group counts as one thing. Groups that
    /// share a member are one. A group is an object when one of its members is.
    pub groups: Vec<Vec<u16>>,
}

impl Roles {
    /// The groups without overlaps: the members of each in ascending order, at least two.
    pub(crate) fn disjoint_groups(&self) -> Vec<Vec<u16>> {
        let mut disjoint: Vec<BTreeSet<u16>> = Vec::new();
        for group in &self.groups {
            let mut whole: BTreeSet<u16> = group.iter().copied().collect();
            disjoint.retain(|other| {
                let is_apart = other.is_disjoint(&whole);
                if !is_apart {
                    whole.extend(other);
                }
                is_apart
            });
            disjoint.push(whole);
        }
        disjoint.sort();
        disjoint
            .into_iter()
            .filter(|group| group.len() > 1)
            .map(|group| group.into_iter().collect())
            .collect()
    }
}

/// The pixels of a frame: what a tracker says, and what is true.
#[derive(Clone, Debug)]
pub struct LabelledFrame {
    /// The track at every pixel, 0 = none.
    pub tracks: Raster<u16>,
    /// The instance at every pixel, 0 = background.
    pub instances: Raster<u16>,
}

/// What a pixel is worth once groups are one thing each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Place {
    /// Whoever finds something here is wrong.
    Background,
    /// Whoever finds something here is neither right nor wrong.
    Unpunished,
    /// The object that is named by its index in [`Places::things`].
    Object(u32),
}

/// What every instance of a frame is, once groups are one thing each.
pub(crate) struct Places {
    /// The objects: the instances that make up each, ascending.
    pub(crate) things: Vec<Vec<u16>>,
    /// By instance, as far as the last that has a role.
    of: Vec<Place>,
}

impl Places {
    /// O(n log n) for n instances with a role.
    pub(crate) fn of(roles: &Roles) -> Self {
        let groups = roles.disjoint_groups();
        let grouped: BTreeSet<u16> = groups.iter().flatten().copied().collect();
        let last =
            [&roles.objects, &roles.unpunished, &grouped].into_iter().filter_map(|set| set.last()).max();
        let mut of = vec![Place::Background; last.map_or(0, |&last| usize::from(last) + 1)];
        for &label in roles.unpunished.iter().filter(|&&label| label > 0) {
            of[usize::from(label)] = Place::Unpunished;
        }
        let mut things = Vec::new();
        let single = roles.objects.difference(&grouped).map(|&label| vec![label]);
        for members in groups.into_iter().chain(single) {
            let is = |set: &BTreeSet<u16>| members.iter().any(|member| set.contains(member));
            let place = match (is(&roles.objects), is(&roles.unpunished)) {
                (true, _) => Place::Object(things.len() as u32),
                (false, true) => Place::Unpunished,
                (false, false) => continue,
            };
            for &member in members.iter().filter(|&&member| member > 0) {
                of[usize::from(member)] = place;
            }
            if matches!(place, Place::Object(_)) {
                things.push(members);
            }
        }
        Self { things, of }
    }

    /// What an instance is.
    pub(crate) fn at(&self, instance: u16) -> Place {
        self.of.get(usize::from(instance)).copied().unwrap_or(Place::Background)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_that_share_a_member_are_one() {
        let groups = vec![vec![5, 6], vec![1, 2], vec![2, 3], vec![9], vec![6, 4]];
        let roles = Roles { groups, ..Roles::default() };
        assert_eq!(roles.disjoint_groups(), [vec![1, 2, 3], vec![4, 5, 6]]);
    }

    #[test]
    fn a_group_is_an_object_when_a_member_is() {
        let roles = Roles {
            objects: [1, 2].into(),
            unpunished: [7].into(),
            groups: vec![vec![2, 3], vec![7, 8], vec![9, 10]],
        };
        let places = Places::of(&roles);
        assert_eq!(places.things, [vec![2, 3], vec![1]]);
        let at = [0, 1, 2, 3, 7, 8, 9, 11].map(|label| places.at(label));
        use Place::{Background, Object, Unpunished};
        let group = Object(0);
        assert_eq!(at, [Background, Object(1), group, group, Unpunished, Unpunished, Background, Background]);
    }
}
