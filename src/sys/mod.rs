//! What the machine is: its memory, its processor, its files. System calls live here and nowhere else.

mod clock;
#[cfg(feature = "peers")]
pub mod embree;
mod map;
mod pages;
#[cfg(all(feature = "peers", target_arch = "x86_64", not(target_env = "msvc")))]
pub mod tinybvh;

pub use clock::thread_time;
pub use map::Map;
pub use pages::{list_in_large_pages, zeros_in_large_pages};

use std::path::Path;

/// Bytes of memory that this process may count on: the machine's, or the container's where that
/// is smaller. 4 GiB where neither can be read.
pub fn memory_bytes() -> u64 {
    const UNKNOWN: u64 = 4 << 30;
    let Ok(mut system) = sysinfo::System::new() else { return UNKNOWN };
    system.refresh_memory();
    let machine = system.total_memory();
    let container = system.cgroup_limits().map_or(u64::MAX, |limits| limits.total_memory);
    match machine.min(container) {
        0 | u64::MAX => UNKNOWN,
        bytes => bytes,
    }
}

/// The most bytes of memory that this process has held at a time, where the system tells it (Linux).
pub fn peak_memory_bytes() -> Option<u64> {
    of_status("VmHWM:")
}

/// The bytes that it holds now, where the system tells that (Linux).
pub fn held_memory_bytes() -> Option<u64> {
    of_status("VmRSS:")
}

/// A line of what Linux says of this process (proc_pid_status(5)).
fn of_status(name: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1 << 10)
}

/// The processor's name as the system tells it, `unknown` where it does not.
pub fn cpu_name() -> String {
    let Ok(mut system) = sysinfo::System::new() else { return "unknown".to_owned() };
    system.refresh_cpu_list(sysinfo::CpuRefreshKind::nothing());
    let brand = system.cpus().first().map(|cpu| cpu.brand().trim().to_owned());
    brand.filter(|name| !name.is_empty()).unwrap_or_else(|| "unknown".to_owned())
}

/// The number of cores this process may use.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// The folder that a file is in.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A temporary file with the rights of any other new file, to be renamed once it is complete: so that
/// neither Ctrl-C nor a full disk leaves half a file.
///
/// # Errors
/// If the folder cannot be written to.
pub fn temporary_in(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".boxwood-").suffix(".tmp");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}
