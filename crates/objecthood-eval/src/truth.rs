//! What is known to be in a frame, and which label plays which part.

use objecthood::Raster;

use crate::error::{Error, Result};

/// The labels of a data set that do not name an object; each data set declares its own. All others are objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Roles {
    /// Pixels with this label do not count at all: a prediction there is neither right nor wrong.
    pub ignore: Option<u32>,
    /// What the objects stand on or before: counts, but is no object.
    pub background: Option<u32>,
}

/// The truth of every pixel of a frame.
#[derive(Clone, Debug)]
pub struct Truth {
    labels: Raster<u32>,
    parts: Raster<u32>,
    roles: Roles,
}

impl Truth {
    /// Joins the labels of the objects, the labels of their parts that are apart in the image, and what labels mean.
    ///
    /// A data set that does not tell parts apart gives `labels` twice. `parts` is read on objects only.
    ///
    /// # Errors
    /// [`Error::PartsSize`] when the two differ in size.
    pub fn new(labels: Raster<u32>, parts: Raster<u32>, roles: Roles) -> Result<Self> {
        if labels.size() != parts.size() {
            return Err(Error::PartsSize { labels: labels.size(), parts: parts.size() });
        }
        Ok(Self { labels, parts, roles })
    }

    /// The label of every pixel, all parts of an object under one label.
    pub fn labels(&self) -> &Raster<u32> {
        &self.labels
    }

    /// The label of every pixel, each visible part of an object under its own label.
    pub fn parts(&self) -> &Raster<u32> {
        &self.parts
    }

    /// Which labels are no objects.
    pub fn roles(&self) -> Roles {
        self.roles
    }

    /// Number of columns and rows.
    pub fn size(&self) -> (usize, usize) {
        self.labels.size()
    }

    /// The label of the pixel with index `i`, `None` where it is ignored.
    #[inline]
    pub fn label_at(&self, i: usize) -> Option<u32> {
        Some(self.labels[i]).filter(|&l| Some(l) != self.roles.ignore)
    }

    /// The object at the pixel with index `i`, if there is one.
    #[inline]
    pub fn object_at(&self, i: usize) -> Option<u32> {
        self.label_at(i).filter(|&l| self.is_object(l))
    }

    /// Whether `label` names an object.
    #[inline]
    pub fn is_object(&self, label: u32) -> bool {
        Some(label) != self.roles.ignore && Some(label) != self.roles.background
    }
}
