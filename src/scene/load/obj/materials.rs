//! MTL files: materials by name, and the images that they name. Nothing in them is worth failing a
//! model for.

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;

use super::maps::{self, Map};
use super::material::Draft;
use super::statements::Statements;
use crate::scene::load::Siblings;
use crate::scene::load::text::{lossy, without_mark, words};
use crate::scene::texture::{Channel, Image, ImageSource, TextureUse};
use crate::scene::{LoadCx, Material, NormalTexture, Reason, Scene, ValueTexture};
use crate::task::Charge;

pub(super) struct Materials<'a> {
    files: &'a dyn Siblings,
    cx: &'a LoadCx,
    /// Libraries that were looked for.
    tried: HashSet<String>,
    found: Vec<Draft>,
    by_name: HashMap<String, usize>,
    images: Vec<Image>,
    /// Where each image is in the list; `None` for one that may not be read.
    by_file: HashMap<String, Option<usize>>,
    missing_libraries: Missing,
    missing_materials: Missing,
    forbidden_images: Missing,
    memory: Charge,
}

/// What a byte of text may become: "newmtl a" takes nine, a material and its name in the table
/// not much over five hundred.
const SPREAD: u64 = 64;

/// What is read from an image.
#[derive(Clone, Copy)]
enum Reads {
    Color,
    Opacity,
    Emission,
    Roughness,
    Metallic,
    Normals,
}

impl Reads {
    /// What a statement means that names an image. `bump` names one of heights, which is not read.
    fn of(word: &[u8]) -> Option<Self> {
        const WORDS: &[(&[u8], Reads)] = &[
            (b"map_Kd", Reads::Color),
            (b"map_d", Reads::Opacity),
            (b"map_Ke", Reads::Emission),
            // The extension for physically based materials.
            (b"map_Pr", Reads::Roughness),
            (b"map_Pm", Reads::Metallic),
            (b"norm", Reads::Normals),
        ];
        WORDS.iter().find(|(known, _)| known.eq_ignore_ascii_case(word)).map(|(_, reads)| *reads)
    }

    fn note(self, material: &mut Material, texture: TextureUse, channel: Option<Channel>) {
        let value = |or: Channel| Some(ValueTexture { texture, channel: channel.unwrap_or(or) });
        match self {
            Self::Color => material.base_color_texture = Some(texture),
            Self::Opacity => material.alpha_texture = value(Channel::Mask),
            Self::Emission => material.emission_texture = Some(texture),
            Self::Roughness => material.roughness_texture = value(Channel::Luminance),
            Self::Metallic => material.metallic_texture = value(Channel::Luminance),
            Self::Normals => material.normal_texture = Some(NormalTexture { texture, scale: 1.0 }),
        }
    }
}

/// Names that were not found: how many, and the first few.
#[derive(Default)]
struct Missing {
    names: Vec<String>,
    count: usize,
    known: HashSet<String>,
}

impl<'a> Materials<'a> {
    pub fn new(files: &'a dyn Siblings, cx: &'a LoadCx) -> Result<Self, Reason> {
        let memory = cx.budget.charge(0)?;
        Ok(Self {
            files,
            cx,
            tried: HashSet::new(),
            found: Vec::new(),
            by_name: HashMap::new(),
            images: Vec::new(),
            by_file: HashMap::new(),
            missing_libraries: Missing::default(),
            missing_materials: Missing::default(),
            forbidden_images: Missing::default(),
            memory,
        })
    }

    /// `mtllib`: one name with blanks in it, or several names; both are written.
    pub fn library(&mut self, names: &[u8]) -> Result<(), Reason> {
        let whole = lossy(names);
        if names.is_empty() || !self.tried.insert(whole.clone()) {
            return Ok(());
        }
        if self.read(&whole)? {
            return Ok(());
        }
        let several = names_of(names);
        if several.len() < 2 {
            self.missing_libraries.add(whole);
            return Ok(());
        }
        for name in several {
            if self.tried.insert(name.clone()) && !self.read(&name)? {
                self.missing_libraries.add(name);
            }
        }
        Ok(())
    }

    /// Whether there is such a library.
    fn read(&mut self, name: &str) -> Result<bool, Reason> {
        let bytes = match self.files.read(name) {
            Ok(bytes) => bytes,
            Err(stop @ (Reason::Cancelled(_) | Reason::Memory(_))) => return Err(stop),
            Err(_) => return Ok(false),
        };
        self.memory.grow(bytes.len() as u64 * SPREAD)?;
        // Images are named from where the library is.
        let folder = &name[..name.rfind(['/', '\\']).map_or(0, |slash| slash + 1)];
        let before = self.found.len();
        let cx = self.cx;
        let mut statements = Statements::within(without_mark(&bytes), 1, cx);
        while let Some(line) = statements.next()? {
            let word = line.words().next().unwrap_or_default();
            if word == b"newmtl" {
                let name = lossy(line.tail());
                self.by_name.insert(name.clone(), self.found.len());
                self.found.push(Draft::new(name));
            } else if self.found.len() == before {
                // Of no material.
            } else if let Some(reads) = Reads::of(word) {
                self.map(reads, line.tail(), folder)?;
            } else if let Some(draft) = self.found.last_mut() {
                draft.set(word, &line);
            }
        }
        Ok(true)
    }

    /// A statement that names an image, of the last material.
    fn map(&mut self, reads: Reads, tail: &[u8], folder: &str) -> Result<(), Reason> {
        let Some(Map { file, sampler, transform, channel }) = maps::parse(tail) else { return Ok(()) };
        let Some(image) = self.image(file, folder)? else { return Ok(()) };
        let texture = TextureUse { image, sampler, transform };
        let Some(Draft { material, .. }) = self.found.last_mut() else { return Ok(()) };
        reads.note(material, texture, channel);
        Ok(())
    }

    /// The index of an image, which is noted and not read.
    fn image(&mut self, file: String, folder: &str) -> Result<Option<usize>, Reason> {
        let name = format!("{folder}{file}");
        if let Some(known) = self.by_file.get(&name) {
            return Ok(*known);
        }
        // Both have to be relative: a folder in front must not hide an absolute name.
        let path: Option<PathBuf> = self.files.locate(&file).and_then(|_| self.files.locate(&name)).ok();
        let length = path.as_ref().map_or(0, |path| path.as_os_str().len()) + 4 * name.len();
        self.memory.grow((length + size_of::<(Image, String, usize)>()) as u64)?;
        let known = if let Some(path) = path {
            self.images.push(Image { name: file, source: ImageSource::File(path) });
            Some(self.images.len() - 1)
        } else {
            self.forbidden_images.add(file);
            None
        };
        self.by_file.insert(name, known);
        Ok(known)
    }

    /// The material that the file calls `name`.
    pub fn find(&mut self, name: &[u8]) -> Option<usize> {
        let name = lossy(name);
        let found = self.by_name.get(&name).copied();
        if found.is_none() && !name.is_empty() {
            self.missing_materials.add(name);
        }
        found
    }

    /// Gives the scene its materials and images, and says what was not found.
    pub fn finish(self, scene: &mut Scene) {
        let warnings = [
            self.missing_libraries.sentence("material file", "could not be read"),
            self.forbidden_images.sentence("image", "could not be read, as only those beside the model are"),
            // Without its library every material is missing, which need not be said again.
            self.missing_materials.sentence("material", "is in none of the material files").filter(|_| !self.found.is_empty()),
        ];
        scene.warnings.extend(warnings.into_iter().flatten());
        scene.materials = self.found.into_iter().map(Draft::finish).collect();
        scene.images = self.images;
    }
}

/// The names in a list, where a backslash keeps a blank from parting two.
fn names_of(list: &[u8]) -> Vec<String> {
    let mut names: Vec<Vec<u8>> = Vec::new();
    let mut joined = false;
    for word in words(list) {
        let (name, joins_next) = word.strip_suffix(b"\\").map_or((word, false), |name| (name, true));
        match names.last_mut().filter(|_| joined) {
            Some(last) => {
                last.push(b' ');
                last.extend_from_slice(name);
            }
            None => names.push(name.to_vec()),
        }
        joined = joins_next;
    }
    names.iter().map(|name| lossy(name)).collect()
}

impl Missing {
    const SHOWN: usize = 3;

    fn add(&mut self, name: String) {
        if self.known.insert(name.clone()) {
            self.count += 1;
            if self.names.len() < Self::SHOWN {
                self.names.push(name);
            }
        }
    }

    fn sentence(&self, what: &str, wrong: &str) -> Option<String> {
        let more = if self.count > Self::SHOWN { format!(" and {} more", self.count - Self::SHOWN) } else { String::new() };
        let plural = if self.count > 1 { "s" } else { "" };
        (self.count > 0).then(|| format!("{} {what}{plural} {wrong}: {}{more}.", self.count, self.names.join(", ")))
    }
}
