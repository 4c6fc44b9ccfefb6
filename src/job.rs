//! One background job: a named thread that runs a task, its result, and the wake-up of whoever
//! waits for it without blocking.

use std::sync::mpsc::{Receiver, TryRecvError, channel};

use crate::task::{Cancel, Progress};

/// Work that runs. Dropping it asks the work to stop and does not wait.
#[derive(Debug)]
pub struct Job<T> {
    /// Stops it.
    pub cancel: Cancel,
    /// Says how far it is.
    pub progress: Progress,
    result: Receiver<T>,
}

/// What became of a job.
#[derive(Debug, PartialEq, Eq)]
pub enum Outcome<T> {
    /// It still runs.
    Running,
    /// It ended with this.
    Done(T),
    /// It ended with nothing: a defect in Boxwood, reported instead of waited for.
    Died,
}

impl<T: Send + 'static> Job<T> {
    /// Runs `work` on a thread called `name`, and calls `wake` when it has ended.
    ///
    /// # Errors
    /// If the system grants no thread.
    pub fn spawn(
        name: &str,
        wake: impl FnOnce() + Send + 'static,
        work: impl FnOnce(&Cancel, &Progress) -> T + Send + 'static,
    ) -> std::io::Result<Self> {
        let (cancel, progress) = (Cancel::new(), Progress::new());
        let (sender, result) = channel();
        let (its_cancel, its_progress) = (cancel.clone(), progress.clone());
        std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            // Also if the work panics: the sender is gone by then, and the listener must hear it.
            let _wake = WakeOnDrop(Some(wake));
            let sender = sender;
            let _ = sender.send(work(&its_cancel, &its_progress)); // nobody may be waiting any more
        })?;
        Ok(Self { cancel, progress, result })
    }
}

impl<T> Job<T> {
    /// The result once it is there; it is handed out once.
    pub fn poll(&self) -> Outcome<T> {
        match self.result.try_recv() {
            Ok(result) => Outcome::Done(result),
            Err(TryRecvError::Empty) => Outcome::Running,
            Err(TryRecvError::Disconnected) => Outcome::Died,
        }
    }
}

impl<T> Drop for Job<T> {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}

struct WakeOnDrop<W: FnOnce()>(Option<W>);

impl<W: FnOnce()> Drop for WakeOnDrop<W> {
    fn drop(&mut self) {
        if let Some(wake) = self.0.take() {
            wake();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn wait<T>(job: &Job<T>) -> Outcome<T> {
        for _ in 0..2000 {
            match job.poll() {
                Outcome::Running => std::thread::sleep(Duration::from_millis(1)),
                over => return over,
            }
        }
        Outcome::Running
    }

    #[test]
    fn a_job_ends_with_its_result_or_says_that_it_died() {
        let (woken, wakes) = channel();
        let job = Job::spawn("test", move || woken.send(()).expect("heard"), |_, _| 7).expect("a thread");
        assert_eq!(wait(&job), Outcome::Done(7));
        assert!(wakes.recv_timeout(Duration::from_secs(2)).is_ok());
        let job: Job<()> = Job::spawn("test", || {}, |_, _| panic!("on purpose")).expect("a thread");
        assert_eq!(wait(&job), Outcome::Died);
    }

    #[test]
    fn dropping_a_job_asks_it_to_stop() {
        let job = Job::spawn("test", || {}, |cancel, _| while !cancel.is_cancelled() {}).expect("a thread");
        let cancel = job.cancel.clone();
        drop(job);
        assert!(cancel.is_cancelled());
    }
}
