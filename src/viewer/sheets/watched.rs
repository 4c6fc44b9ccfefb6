//! What is watched over the view, as it is saved: how the amounts of a heat map are spread, and what a build costs along its film.

use crate::lab::film::Film;
use crate::lab::{Field, Sheet};
use crate::render::{Histogram, Range};
use crate::viewer::panels::heat::{self, Shown};
use crate::viewer::state::State;

/// How the amounts of the heat map on the screen are spread.
pub fn heat(state: &State) -> Option<Sheet> {
    let Shown { of, name, spread } = heat::on_screen(state)?;
    let structures = of.iter().map(|entry| entry.id).collect::<Vec<_>>().join(", ");
    Some(bins(&structures, &name, (&spread.histogram, spread.range)))
}

/// The ends of the colours, and a row a bin.
fn bins(structure: &str, name: &str, (histogram, range): (&Histogram, Range)) -> Sheet {
    let mut sheet = Sheet::new(&["structure", "amount", "kind", "from", "to below", "pixels"]);
    for (kind, end) in [("dark end", range.min), ("bright end", range.max)] {
        let from = f64::from(end).into();
        sheet.row([structure.into(), name.into(), kind.into(), from, Field::Missing, Field::Missing]);
    }
    for (i, pixels) in histogram.counts.iter().enumerate() {
        let [from, to] = [i, i + 1].map(|i| Field::from(i as f64 * f64::from(histogram.width)));
        sheet.row([structure.into(), name.into(), "bin".into(), from, to, u64::from(*pixels).into()]);
    }
    sheet
}

/// The SAH cost at every position of a film, and what happened last there.
pub fn film(film: &Film) -> Sheet {
    let mut sheet = Sheet::new(&["event", "SAH cost", "what happened"]);
    for event in 0..=film.last() {
        sheet.row([u64::from(event).into(), film.cost(event).into(), film.tell(event).into()]);
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bin_is_a_row_after_the_ends_of_the_colours() {
        let histogram = Histogram { width: 2.0, counts: vec![5, 0, 7] };
        let csv = bins("bvh", "Nodes visited a ray", (&histogram, Range { min: 0.5, max: 4.0 })).csv();
        let expected = [
            "structure,amount,kind,from,to below,pixels",
            "bvh,Nodes visited a ray,dark end,0.5,,",
            "bvh,Nodes visited a ray,bright end,4,,",
            "bvh,Nodes visited a ray,bin,0,2,5",
            "bvh,Nodes visited a ray,bin,2,4,0",
            "bvh,Nodes visited a ray,bin,4,6,7",
        ];
        assert_eq!(csv.lines().collect::<Vec<_>>(), expected);
    }
}
