//! Sorting many events in parallel, with a look at the cancel flag every few milliseconds: chunks
//! are sorted; samples of them say where to divide the whole into buckets; each bucket gathers its
//! part of every chunk and merges them (regular sampling, Shi and Schaeffer 1992).

use rayon::prelude::*;

use super::events::Event;
use crate::task::{Cancel, Cancelled};

/// Events in a chunk, and about as many in a bucket.
const CHUNK: usize = 1 << 16;

/// Sorts events that are all different, given in any number of lists.
pub fn sort(lists: Vec<Vec<Event>>, cancel: &Cancel) -> Result<Vec<Event>, Cancelled> {
    let mut events = gather(lists, cancel)?;
    let sort_chunk = |chunk: &mut [Event]| cancel.check().map(|()| chunk.sort_unstable());
    events.par_chunks_mut(CHUNK).try_for_each(sort_chunk)?;
    if events.len() <= CHUNK {
        return Ok(events);
    }
    let chunks: Vec<&[Event]> = events.chunks(CHUNK).collect();
    let bounds = bucket_bounds(&chunks);
    let bucket = |b: usize| {
        cancel.check()?;
        let part = |chunk: &&[Event]| {
            let from = if b == 0 { 0 } else { chunk.partition_point(|e| *e < bounds[b - 1]) };
            let to = bounds.get(b).map_or(chunk.len(), |end| chunk.partition_point(|e| e < end));
            (from, to)
        };
        let parts: Vec<&[Event]> = chunks.iter().map(|chunk| (chunk, part(chunk))).map(|(c, (from, to))| &c[from..to]).collect();
        let mut all = parts.concat();
        // The stable sort finds the runs and merges them.
        all.sort();
        Ok(all)
    };
    let buckets: Vec<Vec<Event>> = (0..=bounds.len()).into_par_iter().map(bucket).collect::<Result<_, _>>()?;
    gather(buckets, cancel)
}

/// All lists in one, with a look at the cancel flag before each.
pub fn gather<T>(mut lists: Vec<Vec<T>>, cancel: &Cancel) -> Result<Vec<T>, Cancelled> {
    if lists.len() == 1 {
        return Ok(lists.pop().unwrap_or_default());
    }
    let mut all = Vec::with_capacity(lists.iter().map(Vec::len).sum());
    for list in lists {
        cancel.check()?;
        all.extend(list);
    }
    Ok(all)
}

/// Where buckets end: as many samples from each chunk as there are chunks, every so many of them. No
/// bucket then holds more than about two chunks' worth.
fn bucket_bounds(chunks: &[&[Event]]) -> Vec<Event> {
    let n = chunks.len();
    let sample = |chunk: &&[Event]| (1..n).map(|i| chunk[chunk.len() * i / n]).collect::<Vec<_>>();
    let mut samples: Vec<Event> = chunks.iter().flat_map(sample).collect();
    samples.sort_unstable();
    (1..n).map(|i| samples[samples.len() * i / n]).collect()
}

#[cfg(test)]
mod tests {
    use super::super::events::Kind;
    use super::*;
    use crate::geometry::num;

    #[test]
    fn large_lists_come_out_in_order() {
        for (n, places) in [(0, 1), (1000, 7), (CHUNK * 5 + 77, 3), (CHUNK * 5 + 77, 1 << 20)] {
            let event = |i: usize| Event::new((i * 7919 % places) as f32, Kind::Start, num::index(i));
            let events: Vec<Event> = (0..n).map(event).collect();
            let mut expected = events.clone();
            expected.sort_unstable();
            let lists = events.chunks(4000).map(<[Event]>::to_vec).collect();
            assert_eq!(sort(lists, &Cancel::new()), Ok(expected));
        }
        let stop = Cancel::new();
        stop.cancel();
        assert!(sort(vec![vec![Event::default()]], &stop).is_err());
    }
}
