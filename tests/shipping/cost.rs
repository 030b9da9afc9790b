//! What a step costs in instructions, which the noise of a machine does not move.
//!
//! Callgrind counts those of this program's steps: it starts itself under valgrind, once for each
//! kernel and kind of step. A plugin of QEMU counts those of the static library on AArch64.
//! docs/performance.md is the reference: a change that costs 2 % more or less must change the page.
//! Bytes of code, tracker and stack are compared with docs/memory.md by `targets`.

use crate::common::c::require;
use crate::common::random::Random;
use crate::common::scenes;
use crate::common::skip::skipped;
use crate::common::{demo, grey, model, scratch, tracker};
use posewise::ffi::types::POSEWISE_CPU_DOTPROD;
use posewise::network::{KernelName, select_kernel};
use posewise::{Config, Frame, Group, Model, State, Tracker};
use std::process::Command;
use xtask::{COUNTING_EMULATOR, Library};

/// Part of a figure in docs/performance.md by which a measured one may be off.
const TOLERANCE: f64 = 0.02;

/// Steps of each kind that are counted.
const STEPS: usize = 24;

/// Frames whose steps are counted on AArch64; in the clip the face is found before.
const FRAMES: std::ops::Range<usize> = 20..20 + STEPS;

/// Side of the blocks that are put in a random order, which is clutter without a face \[px\].
const BLOCK: usize = 16;

/// Which kernel and kind of step the program that runs under valgrind takes.
const WANTED: &str = "POSEWISE_COUNTED";

const KERNELS: [(KernelName, &str); 3] = [
    (KernelName::Scalar, "portable"),
    (KernelName::Sse2, "SSE2"),
    (KernelName::Avx2, "AVX2"),
];

const KINDS: [&str; 2] = ["tracking", "searching"];

/// Faces of a group, in the quarters of a picture.
const FACES: usize = 4;

/// With the kernel of most machines.
#[test]
fn steps_take_as_many_instructions_as_documented() {
    check(|kernel| kernel == KernelName::Avx2);
}

#[test]
#[ignore = "minutes under valgrind: .ci/nightly"]
fn steps_take_as_many_instructions_as_documented_with_other_kernels() {
    check(|kernel| kernel != KernelName::Avx2);
}

/// Compares the steps with the kernels that are wanted with docs/performance.md.
fn check(is_wanted: impl Fn(KernelName) -> bool) {
    if !cfg!(target_arch = "x86_64") || !require("valgrind") {
        return;
    }
    for (kernel, name) in KERNELS {
        if !is_wanted(kernel) {
            continue;
        }
        if !kernel.is_available() {
            skipped(&format!("{name} here"));
            continue;
        }
        let group = (kernel == KernelName::Avx2).then_some("four-face");
        for kind in KINDS.into_iter().chain(group) {
            let instructions = instructions(kernel, kind) / STEPS;
            println!("{name}: a {kind} step takes {instructions} instructions");
            let row = format!("a {kind} step, {name}");
            crate::common::check_page("docs/performance.md", &row, instructions, TOLERANCE);
        }
    }
}

/// The step of the most units of each kind, with the kernel of most machines.
#[test]
#[ignore = "minutes under valgrind: .ci/nightly"]
fn the_longest_steps_take_as_many_instructions_as_documented() {
    let kernel = KernelName::Avx2;
    if !cfg!(target_arch = "x86_64") || !require("valgrind") {
        return;
    }
    if !kernel.is_available() {
        skipped("AVX2 here");
        return;
    }
    let mut most = [(0, 0); 4];
    scenes::watch_scenes(scenes::step, |number, kind, units| {
        if units > most[kind].1 {
            most[kind] = (number, units);
        }
    });
    for (kind, (number, units)) in scenes::KINDS.into_iter().zip(most) {
        let instructions = instructions(kernel, &format!("scene {number}"));
        println!("the longest step, {kind}: {units} units, {instructions} instructions");
        let row = format!("the longest step, {kind}");
        crate::common::check_page("docs/performance.md", &row, instructions, TOLERANCE);
    }
}

#[test]
#[ignore = "minutes of emulation: .ci/nightly"]
fn steps_take_as_many_instructions_as_documented_on_aarch64() {
    let target = "aarch64-unknown-linux-gnu";
    let library = Library {
        target: Some(target.into()),
        without: Vec::new(),
        // The folder that `targets` uses too.
        target_dir: scratch("dist"),
    };
    let programs = ["make", "aarch64-linux-gnu-gcc", COUNTING_EMULATOR];
    if !programs.iter().all(|program| require(program))
        || !(library.can_be_built() || require(&format!("Rust for {target}")))
    {
        return;
    }
    let folder = scratch("cost");
    let face = xtask::demo_clip(&folder).expect("tests/data/demo.y4m.gz");
    let clip = demo();
    let clutter = folder.join("clutter.y4m");
    let mut y4m = format!("YUV4MPEG2 W{} H{} F30:1 Cmono\n", clip.width, clip.height).into_bytes();
    for frame in 0..FRAMES.end {
        y4m.extend_from_slice(b"FRAME\n");
        y4m.extend(shuffled(clip, frame));
    }
    std::fs::write(&clutter, y4m).expect("target/ is writable");
    for (cpu, name) in [(0, "NEON"), (POSEWISE_CPU_DOTPROD, "NEON with dot product")] {
        for (kind, video) in KINDS.iter().zip([&face, &clutter]) {
            let count = xtask::instructions_per_step(&library, video, FRAMES, cpu);
            let count = count.unwrap_or_else(|error| panic!("{error:#}"));
            println!("{name}: a {kind} step takes {count} instructions");
            let row = format!("a {kind} step, {name}");
            crate::common::check_page("docs/performance.md", &row, count as usize, TOLERANCE);
        }
    }
}

/// Instructions of all counted steps of a kind.
fn instructions(kernel: KernelName, kind: &str) -> usize {
    let program = std::env::current_exe().expect("this program");
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]);
    valgrind
        .args(["--toggle-collect=*counted_step*"])
        .arg(program);
    valgrind.args(["--ignored", "--exact", "cost::steps_for_valgrind"]);
    valgrind.env(WANTED, format!("{} {kind}", kernel.name()));
    let output = valgrind.output().expect("valgrind runs");
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{messages}");
    let collected = messages.split("Collected : ").nth(1);
    let digits = collected.and_then(|rest| rest.split_whitespace().next());
    digits
        .and_then(|digits| digits.parse().ok())
        .unwrap_or_else(|| panic!("no count in {messages}"))
}

#[test]
#[ignore = "run by the other test, under valgrind"]
fn steps_for_valgrind() {
    let wanted = std::env::var(WANTED).unwrap_or_default();
    let Some((kernel, kind)) = wanted.split_once(' ') else {
        return;
    };
    let kernel = KernelName::ALL.into_iter().find(|k| k.name() == kernel);
    assert!(kernel.is_some_and(select_kernel), "{wanted}");
    let clip = demo();
    if let Some(number) = kind.strip_prefix("scene ") {
        return count_scene(number.parse().expect("a number"));
    }
    match kind {
        "tracking" => take_steps(clip, State::Tracking, |n| clip.luma[n].clone()),
        "four-face" => take_group_steps(clip),
        _ => take_steps(clip, State::Searching, |n| shuffled(clip, n)),
    }
}

/// Takes steps on pictures, those that begin and end in a state as [`counted_step`].
fn take_steps(clip: &crate::common::Clip, state: State, picture: impl Fn(usize) -> Vec<u8>) {
    let (model, mut tracker) = (model(), tracker(&Config::default()));
    let mut counted = 0;
    for n in 0..clip.luma.len() {
        if counted == STEPS {
            return;
        }
        let luma = picture(n);
        let frame = grey(clip.width, clip.height, &luma);
        let timestamp_us = clip.time_us(n);
        if tracker.result().state == state {
            counted_step(&mut tracker, &model, &frame, timestamp_us);
            assert_eq!(tracker.result().state, state, "step {n}");
            counted += 1;
        } else {
            tracker
                .step(&model, &frame, timestamp_us)
                .expect("in order");
        }
    }
    panic!("{counted} of {STEPS} steps in the state {state:?}");
}

/// Steps of a group whose trackers all have a face, before and after.
fn take_group_steps(clip: &crate::common::Clip) {
    let (model, mut group) = (model(), Group::new());
    let mut trackers: Vec<_> = (0..FACES).map(|_| tracker(&Config::default())).collect();
    let mut counted = 0;
    for n in 0..clip.luma.len() {
        let luma = quarters(clip, n);
        let frame = grey(2 * clip.width, 2 * clip.height, &luma);
        let all = |trackers: &[Box<Tracker>]| {
            (trackers.iter()).all(|tracker| tracker.result().state == State::Tracking)
        };
        let was_tracking = all(&trackers);
        counted_group_step(was_tracking, || {
            let stepped = group.step(&model, &mut trackers, &frame, clip.time_us(n));
            stepped.expect("in order");
        });
        if was_tracking {
            assert!(all(&trackers), "step {n}");
            counted += 1;
        }
        if counted == STEPS {
            return;
        }
    }
    panic!("{counted} of {STEPS} steps with all faces");
}

/// Takes the steps up to that of a scene, which is counted.
fn count_scene(counted: usize) {
    scenes::watch_scenes(
        |number, tracker, model, frame, time_us| {
            if number == counted {
                counted_step(tracker, model, frame, time_us);
                return false;
            }
            scenes::step(number, tracker, model, frame, time_us)
        },
        |_, _, _| {},
    );
}

/// A step, which valgrind counts if it is wanted.
fn counted_group_step(is_wanted: bool, step: impl FnOnce()) {
    #[inline(never)]
    fn counted_step(step: impl FnOnce()) {
        step();
    }
    match is_wanted {
        true => counted_step(step),
        false => step(),
    }
}

/// Four frames of the clip side by side, ten apart.
fn quarters(clip: &crate::common::Clip, first: usize) -> Vec<u8> {
    let (width, height) = (clip.width, clip.height);
    let pixel = |i: usize| {
        let (x, y) = (i % (2 * width), i / (2 * width));
        let quarter = x / width + 2 * (y / height);
        let luma = &clip.luma[(first + 10 * quarter) % clip.luma.len()];
        luma[y % height * width + x % width]
    };
    (0..4 * width * height).map(pixel).collect()
}

/// Valgrind counts what is called from here.
#[inline(never)]
fn counted_step(tracker: &mut Tracker, model: &Model<'_>, frame: &Frame<'_>, timestamp_us: i64) {
    let result = tracker.step(model, frame, timestamp_us);
    std::hint::black_box(result.expect("in order"));
}

/// A frame of the clip, its blocks in a random order.
fn shuffled(clip: &crate::common::Clip, frame: usize) -> Vec<u8> {
    let (across, down) = (clip.width / BLOCK, clip.height / BLOCK);
    let mut order: Vec<usize> = (0..across * down).collect();
    let mut random = Random(frame as u64);
    for last in (1..order.len()).rev() {
        order.swap(last, random.below(last + 1));
    }
    let (width, luma) = (clip.width, &clip.luma[frame]);
    let pixel = |i: usize| {
        let (x, y) = (i % width, i / width);
        let Some(from) = order.get(y / BLOCK * across + x / BLOCK) else {
            return luma[i];
        };
        luma[(from / across * BLOCK + y % BLOCK) * width + from % across * BLOCK + x % BLOCK]
    };
    (0..luma.len()).map(pixel).collect()
}
