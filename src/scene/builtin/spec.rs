//! What follows `builtin:`: the name of a scene, and how large it shall be.

use super::{ALL, Builtin, Size};
use crate::scene::Reason;

/// A scene and the number of triangles to aim for.
pub(super) struct Spec {
    pub scene: &'static Builtin,
    pub triangles: usize,
}

impl Spec {
    /// Reads `NAME` or `NAME?triangles=N`.
    pub fn parse(spec: &str) -> Result<Self, Reason> {
        let (name, options) = spec.split_once('?').map_or((spec, None), |(name, rest)| (name, Some(rest)));
        let scene = ALL.iter().find(|scene| scene.id == name).ok_or_else(|| unknown(name))?;
        let mut triangles = None;
        for option in options.into_iter().flat_map(|list| list.split('&')) {
            let value = value_of(option, scene)?;
            if triangles.replace(count(value, scene.size.most())?).is_some() {
                return Err(Reason::Builtin("the option 'triangles' is given twice".into()));
            }
        }
        Ok(Self { scene, triangles: triangles.unwrap_or(scene.size.by_default()) })
    }
}

fn unknown(name: &str) -> Reason {
    let names: Vec<&str> = ALL.iter().map(|scene| scene.id).collect();
    Reason::Builtin(format!("there is no built-in scene '{name}'. There are {}", names.join(", ")))
}

/// The `N` of `triangles=N`, if the scene takes that option.
fn value_of<'a>(option: &'a str, scene: &Builtin) -> Result<&'a str, Reason> {
    if let Size::Fixed(_) = scene.size {
        return Err(Reason::Builtin(format!("'{}' has a fixed size and takes no options", scene.id)));
    }
    let (key, value) = option.split_once('=').unwrap_or((option, ""));
    if key == "triangles" {
        return Ok(value);
    }
    Err(Reason::Builtin(format!("'{}' has no option '{key}'. Its only option is triangles=N", scene.id)))
}

fn count(value: &str, most: usize) -> Result<usize, Reason> {
    let digits = !value.is_empty() && value.bytes().all(|b| b.is_ascii_digit());
    match value.parse() {
        Ok(n) if digits && (1..=most).contains(&n) => Ok(n),
        _ => Err(Reason::Builtin(format!("'triangles={value}' does not say a whole number from 1 to {most}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(spec: &str) -> String {
        Spec::parse(spec).err().map(|e| e.to_string()).unwrap_or_default()
    }

    #[test]
    fn a_name_and_a_size_are_read() {
        let read = |spec| Spec::parse(spec).map(|s| (s.scene.id, s.triangles)).ok();
        assert_eq!(read("hair"), Some(("hair", 100_000)));
        assert_eq!(read("soup?triangles=1"), Some(("soup", 1)));
        assert_eq!(read("soup?triangles=50000000"), Some(("soup", 50_000_000)));
        assert_eq!(read("sphere-flake?triangles=1000000000"), Some(("sphere-flake", 1_000_000_000)));
    }

    #[test]
    fn a_wrong_name_is_told_the_right_ones() {
        let said = error("hare");
        assert!(said.contains("'hare'") && ALL.iter().all(|scene| said.contains(scene.id)), "{said}");
        assert!(error("").contains("hair") && error("Hair").contains("hair"));
    }

    #[test]
    fn a_wrong_option_is_told_the_right_one() {
        for spec in ["soup?size=3", "soup?", "soup?triangles=3&", "soup?triangles=3&seed=1"] {
            assert!(error(spec).contains("triangles=N"), "{spec}");
        }
        assert!(error("soup?triangles=3&triangles=3").contains("twice"));
        assert!(error("lecture?triangles=3").contains("takes no options"));
    }

    #[test]
    fn a_size_is_a_whole_number_within_the_limit() {
        for n in ["", "0", "-5", "+5", "1.5", "1e6", "many", "50000001", "99999999999999999999999"] {
            assert!(error(&format!("soup?triangles={n}")).contains("from 1 to 50000000"), "{n}");
        }
    }
}
