//! The real window, driven as a person drives it: keys, mouse, names of widgets. Only the file
//! dialog is another, since nobody sits there to answer it.
#![cfg(feature = "viewer")]

#[path = "../common/mod.rs"]
mod common;
mod files;
mod window;

mod accessibility;
mod budgets;
mod checking;
mod compared;
mod comparing;
mod errors;
mod exploring;
mod exporting;
mod filming;
mod following;
mod hands;
mod heat;
mod layout;
mod made_again;
mod meanwhile;
mod measuring;
mod modes;
mod needs;
mod opening;
mod overlays;
mod pace;
mod palette;
mod panes;
mod parameters;
mod pixels;
mod predicting;
mod presenting;
mod ray_files;
mod resting;
mod saving;
mod section;
mod settings;
mod structures;
mod touring;
mod volumes;
