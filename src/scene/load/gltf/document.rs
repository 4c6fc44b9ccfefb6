//! The JSON of a glTF file.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use gltf::json::Root;

use crate::scene::{LoadCx, Reason};
use crate::task::Charge;

/// What an object of the JSON takes in memory, roughly: a node with everything it may have.
const OBJECT: u64 = 512;
/// What an item of a list takes: a value of an extension that nobody knows.
const ITEM: u64 = 32;
/// JSON up to this length is parsed on the spot, which cannot be stopped.
const SMALL: usize = 1 << 21;
/// Time between two looks at the cancel flag while longer JSON is parsed.
const LOOK: Duration = Duration::from_millis(20);

/// Parses it, and charges the budget for what it becomes.
pub(super) fn parse(json: &[u8], cx: &LoadCx) -> Result<(Root, Charge), Reason> {
    cx.progress.start("parse", 0);
    let mut memory = cx.budget.charge(json.len() as u64)?;
    for piece in json.chunks(1 << 20) {
        cx.cancel.check()?;
        let count = |wanted: u8| piece.iter().filter(|b| **b == wanted).count() as u64;
        memory.grow(count(b'{') * OBJECT + count(b',') * ITEM)?;
    }
    let (parsed, memory) = if json.len() <= SMALL { (Root::from_slice(json), memory) } else { aside(json, memory, cx)? };
    let root = parsed.map_err(|error| {
        let place = format!("JSON, line {} column {}", error.line(), error.column());
        version_1(json).unwrap_or_else(|| Reason::malformed(place, first_clause(&error.to_string())))
    })?;
    Ok((root, memory))
}

/// What parsing gives, and the memory it may take.
type Parsed = (Result<Root, serde_json::Error>, Charge);

/// Parses on a thread of its own. The parser of a slice cannot be stopped, but it can be left alone:
/// it gives its memory back when it is done. (The parser of a reader could be stopped, and compiles
/// into this crate, half of which it would be.)
fn aside(json: &[u8], memory: Charge, cx: &LoadCx) -> Result<Parsed, Reason> {
    let (sender, receiver) = channel();
    let copy = json.to_vec();
    let work = move || {
        let parsed = Root::from_slice(&copy);
        let _ = sender.send((parsed, memory)); // nobody listens any more if it was cancelled
    };
    let thread = std::thread::Builder::new().name("parse".into()).spawn(work);
    thread.map_err(|error| Reason::malformed("JSON", format_args!("no thread to parse it on: {error}")))?;
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok(parsed) => return Ok(parsed),
            Err(RecvTimeoutError::Timeout) => cx.cancel.check()?,
            Err(RecvTimeoutError::Disconnected) => return Err(Reason::malformed("JSON", "the parser failed")),
        }
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
