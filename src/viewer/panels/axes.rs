//! Logarithmic axes: what is drawn over them are logarithms to the base of ten.

use std::ops::RangeInclusive;

use egui_plot::{GridInput, GridMark, Plot};

use crate::viewer::format;

/// A plot that stays as it is, with names along its axes.
pub fn log_log<'a>(id: &str, [x, y]: [&str; 2]) -> Plot<'a> {
    Plot::new(id)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .x_axis_label(x)
        .y_axis_label(y)
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .x_axis_formatter(power)
        .y_axis_formatter(power)
        .label_formatter(|_| None)
}

/// A line for each power of ten, and finer ones between them.
fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = (input.bounds.0.floor(), input.bounds.1.ceil());
    let powers = (high - low).clamp(1.0, 40.0) as u32;
    let lines = (0..=powers).flat_map(|i| {
        let power = low + f64::from(i);
        (1..10u32).map(move |k| {
            let step_size = if k == 1 { 1.0 } else { 0.1 };
            GridMark { value: power + f64::from(k).log10(), step_size }
        })
    });
    lines.collect()
}

/// Powers of ten are named where they are within the axis, and nothing in between.
fn power(mark: GridMark, shown: &RangeInclusive<f64>) -> String {
    let named = mark.step_size >= 1.0 && shown.contains(&mark.value);
    if named { format::number(10f64.powf(mark.value)) } else { String::new() }
}
