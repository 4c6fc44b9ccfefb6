//! `boxwood scenes`: what can be opened without a file.

use serde::Serialize;

use super::failure::Failure;
use super::output::{print, print_json};
use super::table::Table;
use crate::lab::format::count;
use crate::scene::builtin::{self, Builtin, Size};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Row {
    /// What is written where a model is asked for.
    model: String,
    about: &'static str,
    /// Unless told otherwise.
    triangles: usize,
    /// Whether `?triangles=N` changes that.
    scales: bool,
}

impl Row {
    fn of(scene: &Builtin) -> Self {
        Self {
            model: format!("{}{}", builtin::SCHEME, scene.id),
            about: scene.about,
            triangles: scene.size.by_default(),
            scales: !matches!(scene.size, Size::Fixed(_)),
        }
    }
}

pub fn run(args: &Args) -> Result<(), Failure> {
    let rows: Vec<Row> = builtin::all().iter().map(Row::of).collect();
    if args.json {
        return print_json(&serde_json::json!({ "scenes": rows }));
    }
    let mut table = Table::new(&["model", "triangles", "size"]);
    let mut about = String::new();
    let width = rows.iter().map(|row| row.model.len()).max().unwrap_or(0);
    for row in rows {
        let size = if row.scales { "?triangles=N" } else { "fixed" };
        table.row(vec![row.model.clone(), count(row.triangles as u64), size.to_owned()]);
        about.push_str(&format!("{:<width$}  {}\n", row.model, row.about));
    }
    print(&format!("{}\n{about}", table.render()))
}
