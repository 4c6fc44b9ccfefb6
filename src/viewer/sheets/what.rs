//! What can be taken away of the window: every table, and which of them are plots, too.

use super::curves;
use crate::lab::prediction;
use crate::viewer::panels::heat;
use crate::viewer::state::State;
use crate::viewer::tradeoffs::Plot;

/// A table or plot of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// The timings.
    Timings,
    /// How the amounts of the heat map are spread.
    Heat,
    /// Figures of the shown structure, and what is predicted of rays in it.
    Statistics,
    /// Why rays are slow.
    Findings,
    /// What the model uses and what is left out.
    Needs,
    /// What holds how much memory.
    Memory,
    /// The SAH cost along the film of the build.
    Film,
    /// The cost of every division of the selected node.
    Division,
    /// Bounding volumes of the selected node.
    Volumes,
    /// The steps of a ray.
    Steps,
    /// The rays of a file.
    Rays,
    /// The picture's error.
    Errors,
    /// Errors of tests of triangles and boxes.
    Tests,
    /// Quality against its cost.
    Quality,
    /// Predicted against measured.
    Prediction,
    /// Time against triangle count.
    Scaling,
    /// The matrix of the stability lab.
    Stability,
    /// The check of the open model.
    Check,
}

impl What {
    /// All, in the order of workspaces.
    pub const ALL: [Self; 18] = [
        Self::Timings,
        Self::Heat,
        Self::Statistics,
        Self::Findings,
        Self::Needs,
        Self::Memory,
        Self::Film,
        Self::Division,
        Self::Volumes,
        Self::Steps,
        Self::Rays,
        Self::Errors,
        Self::Tests,
        Self::Quality,
        Self::Prediction,
        Self::Scaling,
        Self::Stability,
        Self::Check,
    ];

    /// What it is called in menus and names of files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Timings => "timings",
            Self::Heat => "heat",
            Self::Statistics => "statistics",
            Self::Findings => "findings",
            Self::Needs => "needs",
            Self::Memory => "memory",
            Self::Film => "film",
            Self::Division => "division",
            Self::Volumes => "volumes",
            Self::Steps => "steps",
            Self::Rays => "rays",
            Self::Errors => "errors",
            Self::Tests => "tests",
            Self::Quality => "quality",
            Self::Prediction => "prediction",
            Self::Scaling => "scaling",
            Self::Stability => "stability",
            Self::Check => "check",
        }
    }

    /// Whether it is a plot as well as a table.
    pub const fn has_plot(self) -> bool {
        !matches!(self, Self::Findings | Self::Needs | Self::Memory | Self::Steps | Self::Rays | Self::Stability | Self::Check)
    }

    /// Whether there is anything to plot.
    pub fn is_plotted(self, state: &State) -> bool {
        let drawn = || match self {
            Self::Timings => state.timings.fastest().is_some() || state.timings.raster.is_some(),
            // Rows may have no point.
            Self::Prediction => !prediction::points(&state.tradeoffs.rows).is_empty(),
            _ => true,
        };
        self.has_plot() && self.is_there(state) && drawn()
    }

    /// Whether there is anything of it.
    pub fn is_there(self, state: &State) -> bool {
        match self {
            Self::Timings | Self::Memory => state.model.is_some(),
            Self::Heat => heat::on_screen(state).is_some(),
            Self::Statistics => state.shown.as_ref().is_some_and(|shown| shown.stats.is_some()),
            Self::Needs => state.model.as_ref().is_some_and(|model| !model.needs.is_empty()),
            Self::Findings => state.causes.found.is_some(),
            Self::Film => state.film_on_screen().is_some(),
            Self::Division => curves(state).is_some(),
            Self::Volumes => state.fitting().is_some(),
            Self::Steps => !state.rays.columns.is_empty(),
            Self::Rays => state.ray_list.traced.is_some(),
            Self::Errors => !state.errors.curves.is_empty(),
            Self::Tests | Self::Quality | Self::Prediction => !state.tradeoffs.rows.is_empty(),
            Self::Scaling => !state.tradeoffs.scaling.is_empty(),
            Self::Stability => !state.checks.cases.is_empty(),
            Self::Check => state.checks.model.is_some(),
        }
    }

    /// What the plots of the Compare workspace are saved as.
    pub const fn of_plot(plot: Plot) -> Self {
        match plot {
            Plot::Image => Self::Errors,
            Plot::Intersection => Self::Tests,
            Plot::Model => Self::Quality,
            Plot::Prediction => Self::Prediction,
            Plot::Scaling => Self::Scaling,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::sync::Arc;
    use std::sync::mpsc::{Receiver, channel};

    use super::*;
    use crate::lab::RayKind;
    use crate::lab::tradeoffs::TradeoffRow;
    use crate::task::{Budget, Pool};
    use crate::viewer::dialogs::FileDialog;
    use crate::viewer::graphics::Graphics;
    use crate::viewer::settings::Settings;
    use crate::viewer::workers::Shared;

    /// Dialogs that are never answered.
    struct Unanswered;

    impl FileDialog for Unanswered {
        fn pick(&self, _: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
            channel().1
        }

        fn save(&self, _: &str, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
            self.pick(wake)
        }
    }

    #[test]
    fn predictions_are_plotted_only_where_there_is_a_point() {
        let shared = Shared::new(Pool::new("work", 1), Budget::unlimited(), Arc::new(|| {}));
        let mut state = State::new(Settings::default(), shared, Box::new(Unanswered), Graphics::of(None)).expect("threads");
        let is = |state: &State| (What::Prediction.is_there(state), What::Prediction.is_plotted(state));
        assert_eq!(is(&state), (false, false));
        state.tradeoffs.rows = vec![TradeoffRow { error: Some("It does not fit.".to_owned()), ..TradeoffRow::default() }];
        assert_eq!(is(&state), (true, false), "why there is none can be saved, as a table");
        let ns = [(RayKind::Primary, 100.0)].into();
        state.tradeoffs.rows.push(TradeoffRow { predicted_ns: Some(150.0), ns, ..TradeoffRow::default() });
        assert_eq!(is(&state), (true, true));
    }

    #[test]
    fn names_make_names_of_files_and_no_two_are_alike() {
        for (i, what) in What::ALL.iter().enumerate() {
            assert!(what.name().chars().all(|c| c.is_ascii_lowercase()), "{}", what.name());
            assert!(What::ALL[..i].iter().all(|other| other.name() != what.name()), "{}", what.name());
        }
        assert!(Plot::ALL.into_iter().all(|plot| What::of_plot(plot).has_plot()));
    }
}
