//! The images that are seen: where they are, or a copy of their bytes. Of others nothing is kept, unless all is to be.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use gltf::json::{Root, image::Image as Json};

use super::buffers::Buffers;
use super::uri;
use crate::scene::load::Siblings;
use crate::scene::load::text::clipped;
use crate::scene::texture::{Image, ImageSource, shown_materials};
use crate::scene::{Keep, LoadCx, Reason, Scene};
use crate::task::Charge;

pub(super) struct Images<'a, 'b> {
    pub root: &'a Root,
    pub buffers: &'a Buffers<'b>,
    pub files: &'a dyn Siblings,
    pub cx: &'a LoadCx,
}

impl Images<'_, '_> {
    /// Gives the scene its images, and its materials the indices of them. An image that is not
    /// there is a warning, and leaves its materials without a texture.
    pub fn take(&self, scene: &mut Scene) -> Result<(), Reason> {
        let mut memory = self.cx.budget.charge(0)?;
        let mut taken: HashMap<usize, Option<usize>> = HashMap::new();
        for (m, shown) in shown_materials(scene).into_iter().enumerate() {
            let images: Vec<usize> = scene.materials[m].images().filter(|_| shown).collect();
            for image in images {
                if let Entry::Vacant(place) = taken.entry(image) {
                    place.insert(self.add(image, scene, &mut memory)?);
                }
            }
            scene.materials[m].renumber_images(|image| taken.get(&image).copied().flatten().filter(|_| shown));
        }
        if self.cx.keep == Keep::All {
            for image in (0..self.root.images.len()).filter(|image| !taken.contains_key(image)) {
                self.add(image, scene, &mut memory)?;
            }
        }
        Ok(())
    }

    fn add(&self, index: usize, scene: &mut Scene, memory: &mut Charge) -> Result<Option<usize>, Reason> {
        let Some(json) = self.root.images.get(index) else { return Ok(None) };
        let name = name(index, json);
        match self.source(index, json, memory) {
            Ok(source) => {
                scene.images.push(Image { name, source });
                Ok(Some(scene.images.len() - 1))
            }
            Err(stop @ Reason::Cancelled(_)) => Err(stop),
            Err(why) => {
                let why = why.to_string();
                scene.warnings.push(format!("An image can't be read, and is white: {}.", why.trim_end_matches('.')));
                Ok(None)
            }
        }
    }

    fn source(&self, index: usize, json: &Json, memory: &mut Charge) -> Result<ImageSource, Reason> {
        let place = format!("image {index}");
        if let Some(view) = json.buffer_view {
            let bytes = self.buffers.view(view)?.bytes;
            memory.grow(bytes.len() as u64)?;
            return Ok(ImageSource::Bytes(Arc::from(bytes)));
        }
        let uri = json.uri.as_deref().ok_or_else(|| Reason::malformed(&place, "it has neither a bufferView nor a URI"))?;
        if let Some(bytes) = uri::data(uri, &place, self.cx)? {
            memory.grow(bytes.len() as u64)?;
            return Ok(ImageSource::Bytes(Arc::from(bytes)));
        }
        // As with buffers, not every program escapes the name.
        let path = self.files.locate(&uri::file_name(uri))?;
        let plain = if path.exists() { None } else { self.files.locate(uri).ok().filter(|plain| plain.exists()) };
        Ok(ImageSource::File(plain.unwrap_or(path)))
    }
}

/// What messages call an image.
fn name(index: usize, json: &Json) -> String {
    let file = json.uri.as_deref().filter(|uri| !uri::is_data(uri)).map(uri::file_name);
    let name = file.or_else(|| json.name.clone()).filter(|name| !name.is_empty());
    name.map_or_else(|| index.to_string(), |name| clipped(name.as_bytes()))
}
