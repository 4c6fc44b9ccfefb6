//! A structure that does not fit says what would, and that does.

mod common;

use boxwood::accel::{BuildCx, BuildError, Fit, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::task::Budget;
use common::{geometry_of, scene_of, soup};

#[test]
fn what_a_refusal_names_fits_the_budget() {
    let geometry = geometry_of(&scene_of(&soup(60_000, 0.02, 72)));
    let (mut named, mut grids) = (0, 0);
    for bytes_per_triangle in [8, 50, 100, 200, 230, 290] {
        for entry in registry::ALL {
            let cx = || BuildCx { budget: Budget::new(bytes_per_triangle * 60_000), ..BuildCx::unattended(2) };
            let built = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx());
            let Err(error) = built else { continue };
            let text = error.to_string();
            let BuildError::Memory { fits, over, .. } = error else { panic!("{text}") };
            assert!(text.contains("MiB") && over.limit == bytes_per_triangle * 60_000, "{text}");
            for Fit { structure, bytes } in fits.0 {
                assert!(bytes <= over.limit && text.contains(&structure), "{text}");
                let (id, density) = structure.split_once(" with density=").unwrap_or((&structure, ""));
                let other = registry::find(id).expect("registered");
                let mut params = other.defaults();
                if !density.is_empty() {
                    params.set("density", density).expect("in range");
                    grids += 1;
                }
                assert_ne!((id, density), (entry.id, ""), "{text}");
                let fitting = other.build(&geometry, TestKind::Watertight, &params, &cx());
                assert!(fitting.is_ok(), "{structure} after {text}: {:?}", fitting.err());
                named += 1;
            }
        }
    }
    assert!(named > 10 && grids > 2, "{named}, {grids}");
}
