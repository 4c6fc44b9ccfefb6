//! The JSON of a glTF file.

use std::io::{BufReader, Error, Read};

use gltf::json::Root;

use crate::scene::load::pace::Pace;
use crate::scene::{LoadCx, Reason};
use crate::task::Charge;

/// What an object of the JSON takes in memory, roughly: a node with everything it may have.
const OBJECT: u64 = 512;
/// What an item of a list takes: a value of an extension that nobody knows.
const ITEM: u64 = 32;
/// JSON up to this length is parsed in one go, which is faster but cannot be stopped.
const SMALL: usize = 1 << 21;

/// Parses it, and charges the budget for what it becomes.
pub(super) fn parse(json: &[u8], cx: &LoadCx) -> Result<(Root, Charge), Reason> {
    cx.progress.start("parse", json.len() as u64);
    let mut memory = cx.budget.charge(json.len() as u64)?;
    for piece in json.chunks(1 << 20) {
        cx.cancel.check()?;
        let count = |wanted: u8| piece.iter().filter(|b| **b == wanted).count() as u64;
        memory.grow(count(b'{') * OBJECT + count(b',') * ITEM)?;
    }
    let parsed = if json.len() <= SMALL {
        Root::from_slice(json)
    } else {
        Root::from_reader(BufReader::new(Paced { rest: json, pace: Pace::new(cx) }))
    };
    cx.cancel.check()?;
    let root = parsed.map_err(|error| {
        let place = format!("JSON, line {} column {}", error.line(), error.column());
        version_1(json).unwrap_or_else(|| Reason::malformed(place, first_clause(&error.to_string())))
    })?;
    Ok((root, memory))
}

/// Fails once the work is cancelled.
struct Paced<'a> {
    rest: &'a [u8],
    pace: Pace<'a>,
}

impl Read for Paced<'_> {
    fn read(&mut self, to: &mut [u8]) -> std::io::Result<usize> {
        let n = self.rest.read(to)?;
        self.pace.step(n).map_err(Error::other)?;
        Ok(n)
    }
}

/// serde appends the place, which is said already.
fn first_clause(message: &str) -> &str {
    message.rsplit_once(" at line ").map_or(message, |(what, _)| what)
}

/// glTF 1.0 is another format, which fails somewhere in the middle: say so instead.
fn version_1(json: &[u8]) -> Option<Reason> {
    #[derive(serde::Deserialize)]
    struct Head {
        asset: Asset,
    }
    #[derive(serde::Deserialize)]
    struct Asset {
        version: String,
    }
    let head: Head = serde_json::from_slice(json.get(..json.len().min(SMALL))?).ok()?;
    let old = head.asset.version.starts_with("1.");
    old.then(|| Reason::malformed("asset", "it is glTF 1.0, and only 2.0 can be read. Convert it first"))
}
