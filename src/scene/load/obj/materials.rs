//! MTL files: colours and opacity by name. Nothing in them is worth failing a model for.

use std::collections::{HashMap, HashSet};

use super::{each_statement, values};
use crate::scene::load::text::{Line, float, lossy, words};
use crate::scene::load::{Siblings, unit};
use crate::scene::{LoadCx, Material, Reason};
use crate::task::Charge;

pub(super) struct Materials<'a> {
    files: &'a dyn Siblings,
    cx: &'a LoadCx,
    /// Libraries that were looked for.
    tried: HashSet<String>,
    found: Vec<Material>,
    by_name: HashMap<String, usize>,
    missing_libraries: Missing,
    missing_materials: Missing,
    memory: Charge,
}

/// What a byte of text may become: "newmtl a" takes nine, a material and its name in the table
/// not much over a hundred.
const SPREAD: u64 = 16;

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
        let (tried, found, by_name, missing_libraries, missing_materials) = Default::default();
        Ok(Self { files, cx, tried, found, by_name, missing_libraries, missing_materials, memory })
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
        let mut opacity_said = false;
        each_statement(&bytes, self.cx, |word, line| {
            if word == b"newmtl" {
                opacity_said = false;
                let name = lossy(line.tail());
                self.by_name.insert(name.clone(), self.found.len());
                self.found.push(Material { name, ..Material::default() });
            } else if let Some(material) = self.found.last_mut() {
                set(material, word, &line, &mut opacity_said);
            }
            Ok(())
        })?;
        Ok(true)
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

    /// The materials, and what was not found.
    pub fn finish(self) -> (Vec<Material>, Vec<String>) {
        let warnings = [
            self.missing_libraries.sentence("material file", "could not be read"),
            // Without its library every material is missing, which need not be said again.
            self.missing_materials.sentence("material", "is in none of the material files").filter(|_| !self.found.is_empty()),
        ];
        (self.found, warnings.into_iter().flatten().collect())
    }
}

/// Takes a statement for the material that it is about.
fn set(material: &mut Material, word: &[u8], line: &Line, opacity_said: &mut bool) {
    let number = |i: usize| values(line).nth(i).and_then(float).filter(|x| x.is_finite());
    let [r, g, b, a] = &mut material.base_color;
    match word {
        b"Kd" => {
            if let Some(red) = number(0) {
                // One number stands for three.
                (*r, *g, *b) = (red, number(1).unwrap_or(red), number(2).unwrap_or(red));
            }
        }
        b"d" => {
            // `-halo` may come before the number.
            if let Some(opacity) = values(line).last().and_then(float) {
                (*a, *opacity_said) = (unit(opacity), true);
            }
        }
        // Where both stand, `d` is the one of the format.
        b"Tr" if !*opacity_said => *a = number(0).map_or(*a, |t| 1.0 - unit(t)),
        _ => {}
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
