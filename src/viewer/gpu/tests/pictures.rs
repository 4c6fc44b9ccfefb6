//! Traced pictures on the screen.

use std::sync::Arc;

use super::device::Headless;
use super::{list, picture, wall};
use crate::viewer::gpu::Base;

/// Red, green above blue, white.
fn quarters(generation: u64) -> Base {
    let rgba = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]].concat();
    Base::Picture(Arc::new(picture(generation, 2, 2, rgba, vec![1.0; 4])))
}

#[test]
fn a_coarse_picture_fills_the_target_the_right_way_up() {
    let Some(mut gpu) = Headless::new("a coarse picture") else { return };
    let image = gpu.shot("coarse", &list(64, quarters(1)));
    let corner = |x, y| image.get_pixel(x, y).0;
    assert_eq!(corner(0, 0), [255, 0, 0, 255]);
    assert_eq!(corner(63, 0), [0, 255, 0, 255]);
    assert_eq!(corner(0, 63), [0, 0, 255, 255]);
    assert_eq!(corner(63, 63), [255, 255, 255, 255]);
    let [r, g, b, _] = corner(32, 32);
    assert!([r, g, b].iter().all(|v| (100..=155).contains(v)), "smooth in between: {r} {g} {b}");
}

#[test]
fn a_picture_of_the_same_size_is_kept_to_the_bit() {
    let Some(mut gpu) = Headless::new("a picture to the bit") else { return };
    let rgba: Vec<u8> = (0..64 * 64 * 4).map(|i| if i % 4 == 3 { 255 } else { (i * 7 % 256) as u8 }).collect();
    let depth = vec![f32::INFINITY; 64 * 64];
    let same_size = picture(1, 64, 64, rgba.clone(), depth);
    let list = list(64, Base::Picture(Arc::new(same_size)));
    assert_eq!(gpu.shot("same_size", &list).into_raw(), rgba);
    assert_eq!(gpu.painted(&list, [64, 64]).into_raw(), rgba, "and in the window");
}

#[test]
fn the_background_shows_where_the_picture_lets_it() {
    let Some(mut gpu) = Headless::new("the background") else { return };
    let clear = picture(1, 1, 1, vec![0; 4], vec![f32::INFINITY]);
    let mut list = list(8, Base::Picture(Arc::new(clear)));
    assert_eq!(gpu.shot("miss", &list).get_pixel(4, 4).0, list.background);
    list.base = Base::Nothing;
    assert_eq!(gpu.shot("nothing", &list).get_pixel(4, 4).0, list.background);
    let broken = picture(2, 9, 9, Vec::new(), Vec::new());
    list.base = Base::Picture(Arc::new(broken));
    assert_eq!(gpu.shot("broken", &list).get_pixel(4, 4).0, list.background);
}

#[test]
fn only_what_changed_is_drawn_anew() {
    let Some(mut gpu) = Headless::new("drawing anew") else { return };
    let mut list = list(16, quarters(1));
    assert!(gpu.frame(&list));
    assert!(!gpu.frame(&list));
    list.base = quarters(2);
    assert!(gpu.frame(&list));
    list.size_px = [20, 16];
    assert!(gpu.frame(&list));
    list.view.eye.x += 0.1;
    assert!(gpu.frame(&list));
    assert!(!gpu.frame(&list));
    list.base = wall(16);
    assert!(gpu.frame(&list));
}
