//! The window. [`state`] knows everything and changes by [`command`]s, [`panels`] draw it, `workers`
//! do the long work, [`gpu`] puts the 3D view on the screen.

pub mod actions;
mod animation;
pub mod app;
pub mod brute;
mod capture;
pub mod checks;
pub mod command;
pub mod compared;
pub mod dialogs;
mod endurance;
pub mod errors;
pub mod exports;
mod figure;
pub mod files;
pub mod filming;
pub mod folding;
pub mod format;
pub mod gpu;
mod graphics;
pub mod history;
mod kept;
pub mod legends;
mod marks;
pub mod model;
mod mosaic;
pub mod navigation;
mod options;
mod overlay;
mod pace;
pub mod panels;
pub mod panes;
pub mod pick;
mod plots;
pub mod ray_list;
pub mod rays;
mod rays_over;
mod rehearsal;
mod screenshot;
pub mod settings;
pub mod sheets;
mod shown;
pub mod state;
mod tessellation;
pub mod theme;
pub mod tiles;
pub mod timings;
pub mod tour;
pub mod tradeoffs;
pub mod tree;
mod wires;
mod workers;
pub mod workspace_file;

pub use app::App;
pub use options::ViewerOptions;

use eframe::egui;

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum ViewerError {
    /// No display, or no graphics driver, not even one in software.
    #[error(
        "Can't open a window: {0}.\nBoxwood needs a display and a Vulkan or OpenGL driver. On Debian or Ubuntu, install:\n  \
         sudo apt-get install libx11-6 libx11-xcb1 libxcursor1 libxi6 libxrandr2 libxkbcommon0 libxkbcommon-x11-0 \
         libwayland-client0 libegl1 libgl1-mesa-dri libvulkan1 mesa-vulkan-drivers\n\
         The commands stats, compare, render, rays and trace work without."
    )]
    NoWindow(String),
    /// There is no such structure.
    #[error("there is no structure '{0}': use one of {1}")]
    NoStructure(String, String),
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// [`ViewerError`] if there cannot be a window.
pub fn run(options: ViewerOptions) -> Result<(), ViewerError> {
    if let Some(id) = options.structure.as_deref().filter(|id| crate::accel::registry::find(id).is_none()) {
        let known: Vec<&str> = crate::accel::registry::ALL.iter().map(|e| e.id).collect();
        return Err(ViewerError::NoStructure(id.to_owned(), known.join(", ")));
    }
    let size = options.size.map_or(theme::WINDOW, egui::Vec2::from);
    let viewport = egui::ViewportBuilder::default()
        .with_inner_size(size)
        .with_min_inner_size(theme::LEAST_WINDOW)
        .with_app_id("boxwood")
        .with_title("Boxwood")
        .with_drag_and_drop(true);
    let native = eframe::NativeOptions { viewport, persist_window: !options.is_scripted(), ..Default::default() };
    eframe::run_native("Boxwood", native, Box::new(|cc| Ok(Box::new(App::new(cc, options)?))))
        .map_err(|e| ViewerError::NoWindow(e.to_string()))
}
