//! No step does much more than another, whatever happens to the face: the work of all parts of a
//! step, counted by the tracker in units of which a step that tracks has 2,600.

use crate::common::check_page;
use crate::common::scenes::{KINDS, step, watch_scenes};

#[test]
fn the_work_of_a_step_is_bounded_in_every_state() {
    let mut most = [0; 4];
    watch_scenes(step, |_, kind, units| most[kind] = most[kind].max(units));
    println!("tracking, acquiring, searching, coasting: {most:?} units at most");
    for (row, units) in KINDS.into_iter().zip(most) {
        check_page("docs/performance.md", row, units as usize, 0.0);
    }
}
