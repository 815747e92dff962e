//! Detections of a run in the format of COCO: one JSON file with images, annotations and the one category, `object`.
//!
//! Masks are compressed [run lengths](super::rle), boxes `[x, y, width, height]` (px), `score` is the objectness. Extra keys of an annotation:
//! `label`, the number in the frame's label image. Source: cocodataset.org, "Data format" and "Results format".

use std::path::Path;

use serde_json::{Value, json};

use super::Growing;
use super::instances::Instance;
use crate::error::Result;

/// The only category.
const CATEGORY: u8 = 1;

/// The file of a run, which grows frame by frame.
#[derive(Debug)]
pub struct CocoFile {
    file: Growing,
    /// The list of images, which stands behind that of annotations.
    images: String,
    image_count: usize,
    annotation_count: usize,
}

impl CocoFile {
    /// Begins the file that is to be at `path`.
    ///
    /// # Errors
    /// [`Error::Write`](crate::Error::Write).
    pub fn create(path: &Path) -> Result<Self> {
        let mut file = Growing::create(path)?;
        file.append(b"{\"annotations\":[")?;
        Ok(Self { file, images: String::new(), image_count: 0, annotation_count: 0 })
    }

    /// Adds a frame of `width` x `height` pixels, whose image is called `file_name`. Images are numbered from 1 in the order of the calls.
    ///
    /// # Errors
    /// [`Error::Write`](crate::Error::Write).
    pub fn add(
        &mut self,
        file_name: &str,
        (width, height): (usize, usize),
        found: &[Instance],
    ) -> Result<()> {
        self.image_count += 1;
        append_to(&mut self.images, &image(self.image_count, file_name, (width, height)));
        for instance in found {
            let comma = if self.annotation_count == 0 { "\n" } else { ",\n" };
            self.annotation_count += 1;
            let annotation = annotation(self.annotation_count, self.image_count, instance);
            self.file.append(comma.as_bytes())?;
            self.file.append(annotation.to_string().as_bytes())?;
        }
        Ok(())
    }

    /// Ends the file, which takes its name.
    ///
    /// # Errors
    /// [`Error::Write`](crate::Error::Write).
    pub fn finish(self) -> Result<()> {
        let Self { mut file, images, .. } = self;
        let categories = json!([category()]);
        let info =
            json!({"description": "objects found by objecthood", "version": env!("CARGO_PKG_VERSION")});
        file.append(format!("],\n\"images\":[{images}],\n\"categories\":{categories},\n\"licenses\":[],\n\"info\":{info}}}\n").as_bytes())?;
        file.finish()
    }
}

/// What the file says of an image of `width` x `height` pixels.
pub fn image(id: usize, file_name: &str, (width, height): (usize, usize)) -> Value {
    json!({"id": id, "file_name": file_name, "width": width, "height": height})
}

/// What the file says of an object in an image.
pub fn annotation(id: usize, image_id: usize, instance: &Instance) -> Value {
    let area = instance.box_px;
    json!({
        "id": id,
        "image_id": image_id,
        "category_id": CATEGORY,
        "segmentation": instance.mask,
        "area": instance.area_px,
        "bbox": [area.u, area.v, area.width, area.height],
        "iscrowd": 0,
        "score": instance.score,
        "label": instance.id,
    })
}

/// The only category.
pub fn category() -> Value {
    json!({"id": CATEGORY, "name": "object", "supercategory": ""})
}

/// Adds an element to the text of a list.
fn append_to(list: &mut String, value: &Value) {
    list.push_str(if list.is_empty() { "\n" } else { ",\n" });
    list.push_str(&value.to_string());
}
