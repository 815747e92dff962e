//! What one or two pixels belong to: the question of a repair, and its answers.

use serde::Serialize;

use crate::error::{Error, Result};
use crate::raster::Raster;

/// The question: whether one pixel is in an object, or whether two pixels are in one object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Pixels {
    /// The pixel: column and row.
    pub pixel: [usize; 2],
    /// The other pixel, if there are two.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with: Option<[usize; 2]>,
}

/// The answer: what they belong to, by the numbers in the label image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Belonging {
    /// The one pixel is in no object.
    NoObject,
    /// The one pixel is in an object.
    Object {
        /// The object.
        object: u16,
    },
    /// The two pixels are in one object.
    OneObject {
        /// The object.
        object: u16,
    },
    /// The two pixels are in two objects.
    TwoObjects {
        /// The objects, in the order of the pixels.
        objects: [u16; 2],
    },
    /// At least one of the two pixels is in no object.
    NotBoth {
        /// The objects, in the order of the pixels; 0 = none.
        objects: [u16; 2],
    },
}

impl Pixels {
    /// The present answer in a label image. O(1).
    ///
    /// # Errors
    /// [`Error::OutsideImage`].
    pub(super) fn belonging(self, labels: &Raster<u16>) -> Result<Belonging> {
        let at = |pixel: [usize; 2]| {
            let outside = Error::OutsideImage { pixel, size: labels.size() };
            labels.get(pixel[0], pixel[1]).copied().ok_or(outside)
        };
        let a = at(self.pixel)?;
        let b = self.with.map(at).transpose()?;
        Ok(match (a, b) {
            (0, None) => Belonging::NoObject,
            (object, None) => Belonging::Object { object },
            (a, Some(b)) if a == 0 || b == 0 => Belonging::NotBoth { objects: [a, b] },
            (a, Some(b)) if a == b => Belonging::OneObject { object: a },
            (a, Some(b)) => Belonging::TwoObjects { objects: [a, b] },
        })
    }
}

impl Belonging {
    /// Whether another answer repairs this one. Two objects have to become one, or one has to become two;
    /// losing one of them is no repair.
    pub(super) fn is_turned_by(self, then: Self) -> bool {
        match self {
            Self::NoObject => matches!(then, Self::Object { .. }),
            Self::Object { .. } => then == Self::NoObject,
            Self::OneObject { .. } => matches!(then, Self::TwoObjects { .. }),
            Self::TwoObjects { .. } | Self::NotBoth { .. } => matches!(then, Self::OneObject { .. }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_pixels_belong_to_is_read_off_the_labels() {
        let labels = Raster::from_vec(4, 1, vec![0, 1, 1, 2]).unwrap();
        let asked = |u: usize, with: Option<usize>| {
            Pixels { pixel: [u, 0], with: with.map(|u| [u, 0]) }.belonging(&labels)
        };
        assert_eq!(asked(0, None).unwrap(), Belonging::NoObject);
        assert_eq!(asked(3, None).unwrap(), Belonging::Object { object: 2 });
        assert_eq!(asked(1, Some(2)).unwrap(), Belonging::OneObject { object: 1 });
        assert_eq!(asked(3, Some(1)).unwrap(), Belonging::TwoObjects { objects: [2, 1] });
        assert_eq!(asked(1, Some(0)).unwrap(), Belonging::NotBoth { objects: [1, 0] });
        assert_eq!(asked(0, Some(0)).unwrap(), Belonging::NotBoth { objects: [0, 0] });
        assert!(matches!(asked(1, Some(4)), Err(Error::OutsideImage { pixel: [4, 0], .. })));
    }

    /// To lose both would pass as "in the same": that is no repair.
    #[test]
    fn to_lose_an_object_repairs_no_pair() {
        let one = Belonging::OneObject { object: 1 };
        let two = Belonging::TwoObjects { objects: [2, 3] };
        let lost = Belonging::NotBoth { objects: [0, 0] };
        assert!(one.is_turned_by(two) && two.is_turned_by(one) && lost.is_turned_by(one));
        assert!(!one.is_turned_by(lost) && !two.is_turned_by(lost) && !lost.is_turned_by(two));
        assert!(!one.is_turned_by(Belonging::OneObject { object: 2 }), "another number is the same answer");
    }
}
