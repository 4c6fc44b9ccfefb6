//! A device of its own for each scene, and the triangles on it: what is made, and given back once.

use std::ffi::c_void;
use std::ptr::NonNull;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

use super::{Error, Library, Settings, abi};

/// Bytes that the device of a scene holds.
pub(super) type Bytes = AtomicI64;

/// A device of its own and the triangles on it, committed or not.
#[derive(Debug)]
pub(super) struct Mesh {
    pub library: Arc<Library>,
    pub device: NonNull<c_void>,
    pub scene: NonNull<c_void>,
    pub geometry: NonNull<c_void>,
    /// What the monitor counts in; the box keeps its place.
    pub bytes: Box<Bytes>,
}

// SAFETY: the handles are counted references that Embree lets any thread use; a committed scene may be
// traced by many at once, and nothing else is done through a shared reference.
unsafe impl Send for Mesh {}
// SAFETY: as above.
unsafe impl Sync for Mesh {}

/// Counts what Embree takes and gives back.
unsafe extern "C" fn monitor(bytes: *mut c_void, change: isize, _after: bool) -> bool {
    // SAFETY: the pointer is that of the mesh's own counter, which is freed after the device.
    unsafe { &*bytes.cast::<Bytes>() }.fetch_add(change as i64, Ordering::Relaxed);
    true
}

impl Mesh {
    pub fn new(library: &Arc<Library>, settings: Settings) -> Result<Self, Error> {
        let f = &library.functions;
        let device = f.device(settings.threads)?;
        let bytes = Box::new(Bytes::new(0));
        // SAFETY: the device is alive; the counter lives until after the device is released. Each of the
        // two others may be null, and is looked at below.
        let (scene, geometry) = unsafe {
            (f.monitor_memory)(device.as_ptr(), Some(monitor), std::ptr::from_ref(&*bytes).cast_mut().cast());
            ((f.new_scene)(device.as_ptr()), (f.new_geometry)(device.as_ptr(), abi::GEOMETRY_TRIANGLE))
        };
        let (Some(scene), Some(geometry)) = (NonNull::new(scene), NonNull::new(geometry)) else {
            // SAFETY: the device is alive; there is nothing on it that could be used.
            return Err(unsafe {
                let error = (f.device_error)(device.as_ptr());
                (f.release_device)(device.as_ptr());
                Error::Reported(error)
            });
        };
        let mesh = Self { library: Arc::clone(library), device, scene, geometry, bytes };
        let quality = if settings.high_quality { abi::QUALITY_HIGH } else { abi::QUALITY_MEDIUM };
        // SAFETY: the handles are alive, and the values are those of the enumerations.
        unsafe {
            (f.geometry_quality)(geometry.as_ptr(), quality);
            (f.scene_quality)(scene.as_ptr(), quality);
            (f.scene_flags)(scene.as_ptr(), if settings.robust { abi::SCENE_ROBUST } else { 0 });
        }
        mesh.check()?;
        Ok(mesh)
    }

    /// Copies a list to a new buffer of the geometry.
    pub fn fill<T: Copy>(&self, kind: u32, format: u32, items: &[[T; 3]]) -> Result<(), Error> {
        let new = self.library.functions.new_buffer;
        // SAFETY: the geometry is alive; stride and count are those of the list.
        let buffer = unsafe { new(self.geometry.as_ptr(), kind, 0, format, size_of::<[T; 3]>(), items.len()) };
        if buffer.is_null() {
            return self.check().and(Err(Error::Indices));
        }
        // SAFETY: Embree gave a buffer of so many items of that size, aligned to 16 bytes, which is new and
        // so does not overlap the list.
        unsafe { buffer.cast::<[T; 3]>().copy_from_nonoverlapping(items.as_ptr(), items.len()) };
        self.check()
    }

    /// What went wrong since the last look.
    pub fn check(&self) -> Result<(), Error> {
        // SAFETY: the device is alive.
        match unsafe { (self.library.functions.device_error)(self.device.as_ptr()) } {
            0 => Ok(()),
            code => Err(Error::Reported(code)),
        }
    }
}

impl Drop for Mesh {
    fn drop(&mut self) {
        let f = &self.library.functions;
        // SAFETY: each handle is released once, what was made last first; the counter goes after them.
        unsafe {
            (f.release_geometry)(self.geometry.as_ptr());
            (f.release_scene)(self.scene.as_ptr());
            (f.release_device)(self.device.as_ptr());
        }
    }
}
