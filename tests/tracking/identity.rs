//! A person's head is remembered: the record, what it does to a tracker, and how that wears off.

use crate::common::{demo, grey, model, root, tracker};
use posewise::{Config, IDENTITY_RECORD_BYTES, Likeness, Model, RecordError, State, Tracker};
use posewise_format::AlignedBytes;

/// Shows the demo clip, drawn so many times as wide, back and forth.
fn watch(tracker: &mut Tracker, model: &Model<'_>, frames: usize, width: f64) {
    let clip = demo();
    let last = clip.luma.len() - 1;
    let wide = (clip.width as f64 * width) as usize / 2 * 2;
    for i in 0..frames {
        let at = last - last.abs_diff(i % (2 * last));
        let luma = &clip.luma[at];
        let columns = (0..wide).map(|x| (x * clip.width / wide).min(clip.width - 1));
        let columns: Vec<usize> = columns.collect();
        let rows = luma.chunks_exact(clip.width);
        let drawn: Vec<u8> = rows
            .flat_map(|row| columns.iter().map(|x| row[*x]))
            .collect();
        let step = tracker.step(model, &grey(wide, clip.height, &drawn), clip.time_us(i));
        step.expect("in order");
    }
    assert_eq!(tracker.result().state, State::Tracking);
}

/// The record of the head of the demo clip, drawn so many times as wide.
fn record(model: &Model<'_>, width: f64) -> [u8; IDENTITY_RECORD_BYTES] {
    let mut tracker = tracker(&Config::default());
    assert_eq!(tracker.save_identity(model), None, "no face was seen");
    watch(&mut tracker, model, 120, width);
    tracker.save_identity(model).expect("a face was trusted")
}

/// The weights of a record.
fn weights(record: &[u8; IDENTITY_RECORD_BYTES]) -> Vec<f32> {
    let words = record[24..152].as_chunks::<4>().0.iter();
    words.map(|word| f32::from_le_bytes(*word)).collect()
}

fn distance(a: &[u8; IDENTITY_RECORD_BYTES], b: &[u8; IDENTITY_RECORD_BYTES]) -> f32 {
    let (a, b) = (weights(a), weights(b));
    let squares = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f32>().sqrt()
}

#[test]
fn the_record_of_another_head_wears_off() {
    let model = model();
    let (own, other) = (record(&model, 1.0), record(&model, 1.3));
    let apart = distance(&own, &other);
    assert!(apart > 1.0, "{apart}");

    let mut guessing = tracker(&Config::default());
    guessing.restore_identity(&model, &other).expect("a record");
    assert_eq!(
        guessing.compare_identity(&model, &other),
        Ok(Likeness::Unknown)
    );
    watch(&mut guessing, &model, 6, 1.0);
    let soon = guessing.save_identity(&model).expect("a face");
    assert!(distance(&soon, &other) < 0.8 * apart, "it counts at first");
    // Ten seconds of the clip.
    let mut guessing = tracker(&Config::default());
    guessing.restore_identity(&model, &other).expect("a record");
    watch(&mut guessing, &model, 200, 1.0);
    let later = guessing.save_identity(&model).expect("a face");
    let mut without = tracker(&Config::default());
    watch(&mut without, &model, 200, 1.0);
    let expected = without.save_identity(&model).expect("a face");
    let off = distance(&later, &expected);
    println!("records are {apart:.2} apart, after ten seconds {off:.3} is left");
    assert!(off < 0.1 * apart, "{off} of {apart} is left");
}

#[test]
fn a_head_is_told_from_a_wider_one() {
    let model = model();
    let (own, other) = (record(&model, 1.0), record(&model, 1.3));
    let mut again = tracker(&Config::default());
    watch(&mut again, &model, 120, 1.0);
    assert_eq!(again.compare_identity(&model, &own), Ok(Likeness::Same));
    assert_eq!(again.compare_identity(&model, &other), Ok(Likeness::Other));
    // A guess plays no part in what is compared.
    let mut guessing = tracker(&Config::default());
    guessing.restore_identity(&model, &other).expect("a record");
    watch(&mut guessing, &model, 120, 1.0);
    assert_ne!(
        guessing.compare_identity(&model, &other),
        Ok(Likeness::Same)
    );
}

#[test]
fn guesses_end() {
    let model = model();
    let (own, other) = (record(&model, 1.0), record(&model, 1.3));
    let mut guessing = tracker(&Config::default());
    guessing.restore_identity(&model, &other).expect("a record");
    guessing.reset();
    assert_eq!(guessing.save_identity(&model), None);
    watch(&mut guessing, &model, 120, 1.0);
    assert_eq!(
        guessing.save_identity(&model),
        Some(own),
        "nothing is left of the guess"
    );
}

#[test]
fn wrong_records_change_nothing() {
    let model = model();
    let own = record(&model, 1.0);
    let mut guessing = tracker(&Config::default());
    for i in 0..own.len() {
        let mut wrong = own;
        wrong[i] ^= 1;
        let expected = match i {
            0..8 => RecordError::Kind,
            8..12 => RecordError::Version,
            _ => RecordError::Checksum,
        };
        assert_eq!(guessing.restore_identity(&model, &wrong), Err(expected));
        assert_eq!(guessing.compare_identity(&model, &wrong), Err(expected));
        let cut = guessing.restore_identity(&model, &own[..i]);
        assert_eq!(cut, Err(RecordError::Size));
    }
    // The other model has another 3D face.
    let research = std::fs::read(root().join("models/research.posewise")).expect("a model");
    let research = AlignedBytes::new(&research);
    let research = Model::load(&research).expect("a model");
    let refused = guessing.restore_identity(&research, &own);
    assert_eq!(refused, Err(RecordError::Model));
    watch(&mut guessing, &model, 120, 1.0);
    assert_eq!(guessing.save_identity(&model), Some(own));
}
