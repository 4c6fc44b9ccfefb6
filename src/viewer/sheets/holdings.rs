//! What holds how much memory, as it is saved.

use crate::lab::{Field, Sheet};
use crate::viewer::kept::Key;
use crate::viewer::state::State;

/// The budget, the model, and each part of the structures that are kept.
pub fn memory(state: &State) -> Sheet {
    let mut sheet = Sheet::new(&["of", "parameters", "part", "bytes"]);
    let mut row = |of: &str, parameters: Field, part: &str, bytes: u64| {
        sheet.row([of.into(), parameters, part.into(), bytes.into()]);
    };
    let (used, limit) = state.memory();
    row("budget", Field::Missing, "in use", used);
    row("budget", Field::Missing, "limit", limit);
    if let Some(model) = &state.model {
        row("model", Field::Missing, "triangles", model.geometry.bytes());
        row("model", Field::Missing, "textures", model.looks.textures().bytes());
    }
    for built in state.kept_structures() {
        for part in built.memory() {
            row(built.key.entry.id, chosen(&built.key).into(), part.name, part.bytes);
        }
    }
    sheet
}

/// What tells a structure from another of its kind: parameters that are not their defaults, and the triangle test.
fn chosen(key: &Key) -> String {
    let set = key.params.changed();
    let set = set.map(|(param, value)| format!("{}={value}", param.id));
    set.chain([format!("test={}", key.test.id())]).collect::<Vec<_>>().join(" ")
}
