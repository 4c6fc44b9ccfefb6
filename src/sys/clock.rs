//! The time that a thread has worked, which on a busy machine is less than the time that goes by.
#![cfg_attr(target_os = "linux", expect(unsafe_code, reason = "the C library's clocks"))]

use std::time::Duration;

/// How long the calling thread has worked since it began, where the system tells it (Linux).
pub fn thread_time() -> Option<Duration> {
    #[cfg(target_os = "linux")]
    {
        let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
        // SAFETY: the pointer is to a time of our own, which lives through the call.
        let failed = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
        let (secs, nanos) = (u64::try_from(time.tv_sec).ok()?, u32::try_from(time.tv_nsec).ok()?);
        (failed == 0).then(|| Duration::new(secs, nanos))
    }
    #[cfg(not(target_os = "linux"))]
    None
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn a_thread_that_sleeps_does_not_work() {
        let before = thread_time().expect("Linux tells it");
        std::thread::sleep(Duration::from_millis(60));
        let slept = thread_time().expect("Linux tells it") - before;
        assert!(slept < Duration::from_millis(30), "{slept:?}");
        let mut x = 1u64;
        while thread_time().expect("Linux tells it") - before < Duration::from_millis(5) {
            x = std::hint::black_box(x.wrapping_mul(3));
        }
    }
}
