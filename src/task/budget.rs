//! How much memory the work may take: predicted and asked for first, charged as it grows where it
//! cannot be predicted, and given back when the charge is dropped.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A limit in bytes and what is charged against it. Clones share both.
#[derive(Clone, Debug)]
pub struct Budget(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    limit: AtomicU64,
    used: AtomicU64,
}

/// More was asked for than is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it needs {} and {} of the memory budget of {} is left", mib(*asked), mib(*left), mib(*limit))]
pub struct OverBudget {
    /// Bytes asked for.
    pub asked: u64,
    /// Bytes that were left.
    pub left: u64,
    /// Bytes of the whole budget.
    pub limit: u64,
}

/// How amounts of memory are written in errors.
pub fn mib(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / (1024.0 * 1024.0))
}

/// Bytes held against a [`Budget`]; dropping it gives them back.
#[derive(Debug)]
pub struct Charge {
    budget: Budget,
    bytes: u64,
}

impl Budget {
    /// A budget of `limit` bytes.
    pub fn new(limit: u64) -> Self {
        Self(Arc::new(Inner { limit: AtomicU64::new(limit), used: AtomicU64::new(0) }))
    }

    /// A budget of so many MiB.
    pub fn of_mib(mib: u64) -> Self {
        Self::new(mib.saturating_mul(1 << 20))
    }

    /// No limit: for tests and tools that know what they do.
    pub fn unlimited() -> Self {
        Self::new(u64::MAX)
    }

    /// Half of what the machine, or the container the process runs in, has.
    pub fn half_of_machine() -> Self {
        Self::new(crate::sys::memory_bytes() / 2)
    }

    /// Bytes of the whole budget.
    pub fn limit(&self) -> u64 {
        self.0.limit.load(Ordering::Relaxed)
    }

    /// Sets another limit. What is charged already stays, even if it is more.
    pub fn set_limit(&self, limit: u64) {
        self.0.limit.store(limit, Ordering::Relaxed);
    }

    /// Bytes charged now.
    pub fn used(&self) -> u64 {
        self.0.used.load(Ordering::Relaxed)
    }

    /// Takes `bytes`, or says by how much they do not fit.
    pub fn charge(&self, bytes: u64) -> Result<Charge, OverBudget> {
        let limit = self.limit();
        let fits = |used: u64| used.checked_add(bytes).filter(|sum| *sum <= limit);
        match self.0.used.try_update(Ordering::Relaxed, Ordering::Relaxed, fits) {
            Ok(_) => Ok(Charge { budget: self.clone(), bytes }),
            Err(used) => Err(OverBudget { asked: bytes, left: limit.saturating_sub(used), limit }),
        }
    }
}

impl Charge {
    /// Takes `more` bytes on top.
    pub fn grow(&mut self, more: u64) -> Result<(), OverBudget> {
        let extra = self.budget.charge(more)?;
        self.bytes += more;
        std::mem::forget(extra); // its bytes are this charge's now
        Ok(())
    }

    /// Gives back all but `bytes`, where it holds more.
    pub fn shrink(&mut self, bytes: u64) {
        let over = self.bytes.saturating_sub(bytes);
        self.budget.0.used.fetch_sub(over, Ordering::Relaxed);
        self.bytes -= over;
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Drop for Charge {
    fn drop(&mut self) {
        self.budget.0.used.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn charges_are_refused_past_the_limit_and_given_back() {
        let budget = Budget::new(100);
        let mut held = budget.charge(60).expect("fits");
        assert_eq!(budget.charge(50).expect_err("does not fit").left, 40);
        held.grow(40).expect("fits exactly");
        assert_eq!((budget.used(), held.bytes()), (100, 100));
        held.shrink(200);
        assert_eq!(held.bytes(), 100);
        held.shrink(30);
        assert_eq!((budget.used(), held.bytes()), (30, 30));
        budget.set_limit(20);
        assert_eq!(budget.charge(1).expect_err("less than is held").left, 0);
        drop(held);
        assert_eq!(budget.used(), 0);
        assert!(budget.charge(20).is_ok() && budget.charge(21).is_err());
        assert!(budget.charge(u64::MAX).is_err());
    }
}
