//! Asking for a file with the system's dialog, without the window waiting for it.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use super::ray_list::ENDINGS;
use super::workspace_file::ENDING;

/// Something that asks the user for a file. Tests put their own in its place.
pub trait FileDialog {
    /// Opens the dialog; its answer comes later, `None` for a dialog that was closed.
    fn pick(&self, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>>;

    /// The same for a file of rays.
    fn pick_rays(&self, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        self.pick(wake)
    }

    /// The same for a file to be written, with the name that it would have.
    fn save(&self, name: &str, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>>;

    /// The same for a folder to put files into; those who know one way to ask ask in that way.
    fn folder(&self, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        self.pick(wake)
    }
}

/// What a dialog has answered; nothing while it is open, nor where it was closed. The slot is empty once it is not.
pub fn answered(asked: &mut Option<Receiver<Option<PathBuf>>>) -> Option<PathBuf> {
    match asked.as_ref()?.try_recv() {
        Err(TryRecvError::Empty) => None,
        answer => {
            *asked = None;
            answer.ok().flatten()
        }
    }
}

/// The system's own dialog.
#[derive(Clone, Copy, Debug, Default)]
pub struct SystemDialog;

impl FileDialog for SystemDialog {
    fn pick(&self, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        let dialog = rfd::AsyncFileDialog::new().set_title("Open a model or a workspace");
        answer(dialog.add_filter("3D models and workspaces", MODELS).pick_file(), wake)
    }

    fn pick_rays(&self, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        let dialog = rfd::AsyncFileDialog::new().set_title("Open rays");
        answer(dialog.add_filter("Rays", &ENDINGS).pick_file(), wake)
    }

    fn save(&self, name: &str, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        let ending = name.rsplit_once('.').map_or(ENDING, |(_, ending)| ending);
        let (title, kind) = match ending {
            "csv" => ("Save the table", "Tables"),
            "svg" => ("Save as SVG", "SVG"),
            "png" => ("Save as PNG", "PNG"),
            _ => ("Save the workspace", "Workspaces"),
        };
        let dialog = rfd::AsyncFileDialog::new().set_title(title).set_file_name(name);
        answer(dialog.add_filter(kind, &[ending]).save_file(), wake)
    }

    fn folder(&self, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        answer(rfd::AsyncFileDialog::new().set_title("Where to put the report").pick_folder(), wake)
    }
}

/// Waits for what a dialog answers, on a thread of its own.
fn answer(
    dialog: impl Future<Output = Option<rfd::FileHandle>> + Send + 'static,
    wake: Arc<dyn Fn() + Send + Sync>,
) -> Receiver<Option<PathBuf>> {
    let (sender, receiver) = channel();
    let wait = move || {
        let path = pollster::block_on(dialog).map(|handle| handle.path().to_path_buf());
        let _ = sender.send(path); // the window may be gone
        wake();
    };
    // Without a thread the receiver hears at once that nobody will answer.
    let _ = std::thread::Builder::new().name("file-dialog".into()).spawn(wait);
    receiver
}

/// File name endings that can be opened.
const MODELS: &[&str] = &["glb", "gltf", "obj", "ply", "stl", ENDING];
