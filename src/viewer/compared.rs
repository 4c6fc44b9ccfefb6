//! What compared pictures are of, what their figures are, what their colours stand for and how their amounts are spread: for
//! whoever draws, writes or reads them. Letters number them; A, the first, is that of the shown structure.

use std::sync::Arc;

use super::format;
use super::kept::Key;
use super::legends::Heat;
use super::panes::{LETTERS, PaneChoice};
use super::state::State;
use crate::accel::registry::Entry;
use crate::render::colormap::{difference, viridis};
use crate::render::{HeatRays, Histogram, Mode, Picture, Range};
use glam::Vec2;

/// What stands in a place.
pub struct Shown<'a> {
    /// Its picture, once there is one.
    pub picture: Option<&'a Arc<Picture>>,
    /// What is shown of hits.
    pub mode: Mode,
    /// Whether that is what A has more.
    pub differs: bool,
}

/// What is on the screen, A first; A alone where nothing is compared.
pub fn shown(state: &State) -> Vec<Shown<'_>> {
    let first = state.settings.mode;
    let a = Shown { picture: state.on_screen(), mode: first, differs: false };
    let beside = state.settings.panes.on_screen().iter().enumerate().map(|(i, choice)| {
        let (mode, differs) = (choice.mode(first), choice.differs(first));
        Shown { picture: state.panes.all.get(i).and_then(|pane| pane.on_screen(differs)), mode, differs }
    });
    std::iter::once(a).chain(beside.filter(|_| state.is_comparing())).collect()
}

/// What pictures are of, A first: the structure, and what tells it from the same structure in another place.
pub fn names(state: &State) -> Vec<String> {
    let first = state.shown.as_ref().map_or_else(|| state.wanted_key(), |shown| shown.key.clone());
    let others = state.settings.panes.on_screen().iter().map(PaneChoice::key);
    let keys: Vec<Key> = std::iter::once(first).chain(others).collect();
    keys.iter().map(|key| name(key, &keys)).collect()
}

fn name(key: &Key, all: &[Key]) -> String {
    let mut name = key.entry.name.to_owned();
    if all.iter().any(|other| other.entry.id == key.entry.id && other != key) {
        for (param, value) in key.params.changed() {
            name.push_str(&format!(" {}={value}", param.id));
        }
        if all.iter().any(|other| other.entry.id == key.entry.id && other.test != key.test) {
            name.push_str(&format!(" {}", key.test.id()));
        }
    }
    name
}

/// Their structures, A first.
pub fn entries(state: &State) -> impl Iterator<Item = &'static Entry> {
    let first = state.shown.as_ref().map_or_else(|| state.settings.entry(), |shown| shown.key.entry);
    std::iter::once(first).chain(state.settings.panes.on_screen().iter().map(PaneChoice::entry))
}

/// The figures beneath a picture.
pub fn facts(state: &State, which: usize, names: &[String]) -> String {
    let name = &names[which];
    let (built, picture) = match which.checked_sub(1) {
        None => (state.shown.as_ref(), state.picture.as_deref()),
        Some(other) => {
            let Some(pane) = state.panes.all.get(other) else { return format!("{name}: waits") };
            if let Some(building) = &pane.building {
                let share = building.job.progress.snapshot().fraction.map(|share| format!(" {}", format::percent(share.into())));
                return format!("{name}: building{}", share.unwrap_or_default());
            }
            (pane.built.as_ref(), pane.picture.as_deref())
        }
    };
    let Some(built) = built else { return format!("{name}: waits to be built") };
    let mut parts: Vec<String> = picture.map(work).into_iter().flatten().collect();
    parts.push(format!("built in {}", format::duration(built.build_secs)));
    parts.push(format::bytes(built.bytes()));
    format!("{name}: {}", parts.join(", "))
}

/// What rays did in a structure, and how many there were.
fn work(picture: &Picture) -> Vec<String> {
    let progress = &picture.progress;
    let over = |n: u64| format::number(n as f64 / progress.counted as f64);
    let counted = (progress.counted > 0).then(|| {
        let counts = &progress.counts;
        format!("{} nodes, {} tests a ray", over(counts.nodes), over(counts.prims))
    });
    let samples = if progress.step > 1 { format!("1/{} resolution", progress.step) } else { format!("{} spp", progress.samples) };
    counted.into_iter().chain([samples]).collect()
}

/// What heat maps of the kind whose range is set are amounts of.
pub fn amount(state: &State) -> Option<String> {
    state.heat_kind().map(|mode| amount_of(mode, state))
}

fn amount_of(mode: Mode, state: &State) -> String {
    format!("{} {}", mode.label(), each(state))
}

/// What the colours of pictures stand for, each kind once, with the last picture that shows it.
pub fn heats(state: &State) -> Vec<(usize, Heat)> {
    let (mut all, mut differences) = (Vec::<(usize, Mode, Heat)>::new(), Vec::new());
    for (which, Shown { picture, mode, differs }) in shown(state).into_iter().enumerate() {
        match (picture, which.checked_sub(1)) {
            (Some(picture), Some(other)) if differs => differences.push((which, less(state, other, picture))),
            (Some(picture), _) if mode.is_heat() => {
                all.retain(|(_, known, _)| *known != mode);
                all.push((which, mode, Heat::new(amount_of(mode, state), picture.range, viridis)));
            }
            _ => {}
        }
    }
    all.into_iter().map(|(which, _, heat)| (which, heat)).chain(differences).collect()
}

/// Of what amounts are told: only where A is a heat map itself its rays may be others than the camera's.
fn each(state: &State) -> &'static str {
    if state.settings.mode.is_heat() { state.settings.heat_rays.each() } else { HeatRays::default().each() }
}

/// What the colours of a difference stand for.
fn less(state: &State, which: usize, picture: &Picture) -> Heat {
    let [a, b] = [0, which + 1].map(|place| entries(state).nth(place).map_or("", |entry| entry.short));
    let letter = LETTERS[which + 1];
    let [a, b] = if a == b { [LETTERS[0], letter] } else { [a, b] };
    let size = format::number(picture.range.max.into());
    let name = format!("{} {}, A less {letter}", state.settings.mode.label(), each(state));
    let colors = |t: f32| difference(2.0 * t - 1.0);
    Heat { ends: [format!("{size} more in {b}"), format!("{size} more in {a}")], ..Heat::new(name, picture.range, colors) }
}

/// How the amounts of pictures that share a range are spread.
pub struct Spread {
    /// Of all of them.
    pub histogram: Histogram,
    /// The letters of those that are counted.
    pub of: Vec<&'static str>,
    /// The range of their colours.
    pub range: Range,
}

/// How the amounts are spread whose range is set: those of all pictures that share it.
pub fn spread(state: &State) -> Option<Spread> {
    let (kind, alone) = (state.heat_kind(), !state.is_comparing());
    let sharing = |shown: &Shown<'_>| alone || (Some(shown.mode) == kind && !shown.differs);
    let spread = |(shown, letter): (Shown<'_>, &'static str)| {
        let picture = shown.picture?;
        let histogram = picture.amounts.as_ref()?.histogram.clone();
        Some(Spread { histogram, of: vec![letter], range: picture.range })
    };
    let all = shown(state).into_iter().zip(LETTERS).filter(|(shown, _)| sharing(shown)).filter_map(spread);
    all.reduce(|a, b| Spread { histogram: a.histogram.with(&b.histogram), of: [a.of, b.of].concat(), range: a.range })
}

/// An amount that a picture shows at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// Which picture, and of what where they show different things.
    pub of: String,
    /// What it is there, if anything is seen.
    pub amount: Option<f32>,
    /// Whether it is what A has more: it has its sign.
    pub differs: bool,
}

impl Told {
    /// The amount in words.
    pub fn written(&self) -> String {
        let sign = if self.differs && self.amount.is_some_and(|amount| amount > 0.0) { "+" } else { "" };
        format!("{sign}{}", format::or_missing(self.amount, |amount| format::number(amount.into())))
    }
}

/// The amounts that pictures show at a place: (-1, -1) is the lower left corner of the view, (1, 1) the upper right.
pub fn told_at(state: &State, at: Vec2) -> Vec<Told> {
    told(state, |picture| picture.amount_at(at))
}

/// The same where a picture was clicked, as long as they are of that view.
pub fn told_of_click(state: &State) -> Vec<Told> {
    let Some((camera, at)) = state.clicked() else { return Vec::new() };
    told(state, |picture| picture.amount_at(at).filter(|_| picture.camera == camera))
}

fn told(state: &State, amount: impl Fn(&Picture) -> Option<f32>) -> Vec<Told> {
    let told = |((shown, entry), letter): ((&Shown<'_>, &Entry), &str)| {
        let picture = shown.picture.filter(|picture| picture.amounts.is_some())?;
        let of = match state.heat_kind() {
            _ if shown.differs => format!("{} less {letter}", LETTERS[0]),
            Some(kind) if kind != shown.mode => format!("{letter}, {}, {}", entry.short, shown.mode.label().to_lowercase()),
            _ => format!("{letter}, {}", entry.short),
        };
        Some(Told { of, amount: amount(picture), differs: shown.differs })
    };
    shown(state).iter().zip(entries(state)).zip(LETTERS).filter_map(told).collect()
}
