//! Takes steps on the first frames of the demo clip, for `cargo xtask cores`, which counts their
//! instructions and measures their time: `steps KERNEL FRAMES [FIRST ROUNDS]`. Prints how many are
//! tracked; in rounds, also the mean of the shortest times of the steps from FIRST on, and the time
//! of a cycle \[ns\].

mod clip;

use clip::clip;
use posewise::network::{KernelName, select_kernel};
use posewise::{Config, Frame, FrameLayout, Model, State, Tracker};
use std::time::{Duration, Instant};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut kernels = KernelName::ALL.into_iter();
    let kernel = kernels.find(|k| arguments.first().is_some_and(|name| name == k.name()));
    let Some(kernel) = kernel else {
        return; // `cargo bench` runs this too, with other arguments.
    };
    assert!(select_kernel(kernel), "not on this machine");
    let numbers: Vec<usize> = arguments[1..]
        .iter()
        .map(|number| number.parse().expect("a number"))
        .collect();
    let clip = clip();
    match numbers[..] {
        [frames] => println!("{}", track(&clip, &mut vec![Duration::MAX; frames])),
        [frames, first, rounds] => {
            let (mut steps, mut cycle) = (vec![Duration::MAX; frames], f64::INFINITY);
            for _ in 0..rounds {
                track(&clip, &mut steps);
                cycle = cycle.min(cycle_ns());
            }
            let times = &steps[first..];
            let sum: Duration = times.iter().sum();
            let mean = sum.as_nanos() as f64 / times.len() as f64;
            println!("{}\n{mean} {cycle}", track(&clip, &mut steps));
        }
        _ => panic!("steps KERNEL FRAMES [FIRST ROUNDS]"),
    }
}

/// Takes a step on as many frames as there are times, shortens the times that were longer, and
/// counts the frames that are tracked.
fn track((width, height, frames): &(usize, usize, Vec<Vec<u8>>), steps: &mut [Duration]) -> usize {
    let model = Model::load(posewise::DEFAULT_MODEL).expect("the default model is valid");
    let mut tracker = Box::new(Tracker::new(&Config::default()).expect("defaults"));
    let layout = FrameLayout::grey(*width as u32, *height as u32);
    let mut tracked = 0;
    for (n, (luma, shortest)) in frames.iter().zip(steps).enumerate() {
        let frame = Frame::new(&layout, luma).expect("a frame");
        let start = Instant::now();
        let result = tracker.step(&model, &frame, n as i64 * 33_333);
        *shortest = start.elapsed().min(*shortest);
        tracked += usize::from(result.expect("in order").state == State::Tracking);
    }
    tracked
}

/// Time of an addition that needs the one before, which is a cycle \[ns\].
#[cfg(target_arch = "x86_64")]
fn cycle_ns() -> f64 {
    let (start, mut sum) = (Instant::now(), 1_u64);
    // Unrolled further, they would not fit the cache.
    for _ in 0..std::hint::black_box(640) {
        // SAFETY: only one register changes.
        unsafe {
            std::arch::asm!(
                ".rept 100",
                "add {sum}, {addend}",
                ".endr",
                sum = inout(reg) sum,
                addend = in(reg) 3_u64,
                options(nomem, nostack),
            );
        }
    }
    start.elapsed().as_nanos() as f64 / 64_000.0
}

#[cfg(not(target_arch = "x86_64"))]
fn cycle_ns() -> f64 {
    f64::NAN
}
