//! Asking for a file with the system's dialog, without the window waiting for it.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

/// Something that asks the user for a file. Tests put their own in its place.
pub trait FileDialog {
    /// Opens the dialog; its answer comes later, `None` for a dialog that was closed.
    fn pick(&self, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>>;
}

/// The system's own dialog.
#[derive(Clone, Copy, Debug, Default)]
pub struct SystemDialog;

impl FileDialog for SystemDialog {
    fn pick(&self, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        let (sender, receiver) = channel();
        let answer = rfd::AsyncFileDialog::new().set_title("Open a model").add_filter("3D models", MODELS).pick_file();
        let wait = move || {
            let path = pollster::block_on(answer).map(|handle| handle.path().to_path_buf());
            let _ = sender.send(path); // the window may be gone
            wake();
        };
        // Without a thread the receiver hears at once that nobody will answer.
        let _ = std::thread::Builder::new().name("open-dialog".into()).spawn(wait);
        receiver
    }
}

/// File name endings that can be opened.
const MODELS: &[&str] = &["glb", "gltf", "obj", "ply", "stl"];
