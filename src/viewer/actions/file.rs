//! What is opened, saved and taken away.

use super::{List, OPEN, OPEN_PATH, QUIT, SAVE};
use crate::scene::builtin;
use crate::viewer::command::Command;
use crate::viewer::exports::{Export, Form};
use crate::viewer::model::Instances;
use crate::viewer::panels::scene;
use crate::viewer::sheets::What;
use crate::viewer::state::State;

/// Adds them.
pub(super) fn add(list: &mut List, state: &State) {
    list.add("Open…", Command::OpenDialog).key(OPEN);
    list.add("Open a path…", Command::AskForPath(true)).key(OPEN_PATH);
    for model in &state.settings.recent {
        list.add(format!("Open {model}"), Command::Open(model.clone()));
    }
    for scene in builtin::all().iter() {
        let model = format!("{}{}", builtin::SCHEME, scene.id);
        if !state.settings.recent.contains(&model) {
            list.add(format!("Open {model}"), Command::Open(model));
        }
    }
    list.add("Save workspace…", Command::SaveWorkspace).key(SAVE).if_possible(state.model.is_some());
    exports(list, state);
    if let Some(flat) = scene::flattened(state) {
        let (name, instances) =
            if flat { ("Keep instances", Instances::Kept) } else { ("Flatten instances", Instances::Flattened) };
        list.add(name, Command::Instances(instances)).if_possible(state.loading.is_none());
    }
    list.add("Quit", Command::Quit).key(QUIT);
}

/// What can be taken away.
fn exports(list: &mut List, state: &State) {
    let free = state.shown.is_some() && !state.is_measuring() && !state.is_checking();
    for (name, quick) in [("Export report…", true), ("Export thorough report…", false)] {
        list.add(name, Command::Export(Export::Report { quick })).if_possible(free);
    }
    let seen = state.picture.is_some();
    list.add("Save figure…", Command::Export(Export::Figure)).if_possible(seen);
    list.add("Save picture…", Command::Export(Export::Picture)).if_possible(seen);
    for what in What::ALL {
        let (name, there) = (what.name(), what.is_there(state));
        list.add(format!("Save table: {name}…"), Command::Export(Export::Table(what))).if_possible(there);
        for form in [Form::Svg, Form::Png].into_iter().filter(|_| what.has_plot()) {
            let ending = form.ending().to_uppercase();
            let save = Command::Export(Export::Plot(what, form));
            list.add(format!("Save plot as {ending}: {name}…"), save).if_possible(what.is_plotted(state));
        }
    }
}
