use super::*;

fn truth(yaw: f64) -> Truth {
    // Box 100 × 64: its size is 80.
    let mut points = [[50.0, 32.0]; 68];
    points[0] = [0.0, 0.0];
    points[1] = [100.0, 64.0];
    Truth {
        angles: [yaw, 0.0, 0.0],
        eye_mid: [0.0, 0.0, 600.0],
        in_frame: 1.0,
        points,
        visible: [true; 68],
        covered: None,
        under: [false; 68],
        occluder: None,
    }
}

fn tracked(truth: &Truth, angles: [f64; 3]) -> Tracked {
    Tracked {
        angles: std::array::from_fn(|i| truth.angles[i] + angles[i]),
        translation: [3.0, 0.0, 604.0],
        points: truth.points,
        confidence: None,
    }
}

#[test]
fn angles_wrap() {
    assert_eq!(angle_difference(179.0, -179.0), -2.0);
    assert_eq!(angle_difference(-179.0, 179.0), 2.0);
    assert_eq!(angle_difference(10.0, 4.0), 6.0);
}

#[test]
fn landmarks_by_hand() {
    let mut t = truth(0.0);
    let mut found = tracked(&t, [0.0; 3]);
    // The jaw does not count, nor does what is hidden.
    found.points[5] = [500.0, 500.0];
    found.points[20] = [900.0, 0.0];
    t.visible[20] = false;
    (21..31).for_each(|i| found.points[i][0] += 8.0);
    let error = landmark_error(&t, &found).unwrap();
    assert!((error - 10.0 * 8.0 / 50.0 / 80.0).abs() < 1e-12, "{error}");
    t.visible = [false; 68];
    assert_eq!(landmark_error(&t, &found), None);
}

#[test]
fn covered_frames_are_told_apart() {
    let outcome = |covered: Option<bool>, error: f64| {
        let t = Truth {
            covered,
            ..truth(0.0)
        };
        let found = tracked(&t, [error; 3]);
        FrameOutcome::new(&t, Some(&found))
    };
    assert!(summarize_covered(&[outcome(None, 1.0)], false).is_none());
    let some = [
        outcome(Some(true), 4.0),
        outcome(Some(false), 1.0),
        outcome(Some(false), 2.0),
    ];
    let covered = |is: bool| summarize_covered(&some, is).unwrap();
    assert_eq!(covered(true).mean_angle(), Some(4.0));
    assert_eq!(covered(false).mean_angle(), Some(1.5));
    assert_eq!((covered(true).counted, covered(false).counted), (1, 2));
}

#[test]
fn shrinkage_has_a_sign_and_occluded_frames_an_area() {
    // 10° too little on either side, then 30° too much.
    let cases = [(80.0, -10.0), (-80.0, 10.0), (65.0, 30.0)];
    let mut outcomes: Vec<FrameOutcome> = cases
        .iter()
        .map(|(yaw, error)| {
            let t = truth(*yaw);
            FrameOutcome::new(&t, Some(&tracked(&t, [*error, 0.0, 0.0])))
        })
        .collect();
    let steps = summarize_steps(&outcomes);
    let of = |name: &str| &steps.iter().find(|(n, _)| n == name).unwrap().1;
    assert_eq!(
        (of("80-90").shrinkage, of("80-90").off),
        (Some(10.0), Some(0.0))
    );
    assert_eq!(
        (of("60-70").shrinkage, of("60-70").off),
        (Some(-30.0), Some(1.0))
    );
    assert_eq!((of("60-95").counted, of("0-60").counted), (3, 0));
    assert!(summarize_occluded(&outcomes).is_none());
    let mut t = truth(0.0);
    (17..40).for_each(|i| (t.visible[i], t.under[i]) = (false, true));
    // Hidden by the head: neither seen nor covered.
    t.visible[60] = false;
    t.occluder = Some(true);
    let mut found = tracked(&t, [0.0; 3]);
    let seen = |i: usize| f64::from(u8::from(!(17..40).contains(&i)));
    found.confidence = Some(std::array::from_fn(|i| [seen(i), 0.5]));
    outcomes.push(FrameOutcome::new(&t, Some(&found)));
    let occluded = summarize_occluded(&outcomes).unwrap();
    assert_eq!((occluded.counted, occluded.covered_auc), (1, Some(1.0)));
    assert!(occluded.seen_auc[0].unwrap() < 1.0);
}

#[test]
fn summary_by_hand() {
    let frames = [
        (truth(10.0), Some([2.0, -1.0, 0.0])),
        (truth(-40.0), Some([4.0, 3.0, 6.0])),
        (truth(50.0), None),
        (truth(80.0), Some([-170.0, 0.0, 0.0])),
        (truth(70.0), None),
    ];
    let mut outcomes: Vec<FrameOutcome> = frames
        .iter()
        .map(|(t, e)| FrameOutcome::new(t, e.map(|e| tracked(t, e)).as_ref()))
        .collect();
    let mut gone = truth(0.0);
    gone.in_frame = 0.0;
    outcomes.push(FrameOutcome::new(&gone, Some(&tracked(&gone, [0.0; 3]))));
    let s = summarize(outcomes.iter());
    assert_eq!((s.frames, s.counted, s.tracked), (6, 5, 3));
    assert_eq!(s.success(), Some(0.6));
    let angles = s.angles.unwrap();
    assert!((angles[0] - (2.0 + 4.0 + 170.0) / 3.0).abs() < 1e-9);
    assert!((angles[1] - 4.0 / 3.0).abs() < 1e-9);
    assert!((angles[2] - 2.0).abs() < 1e-9);
    assert_eq!(s.translation, Some((5.0, 4.0)));
    assert_eq!((s.wrong, s.lost_within_60), (1, 1));
    assert_eq!((s.sign_flips, s.false_tracks), (1, 1));
    let near = summarize_band(&outcomes, 0.0, 30.0);
    assert_eq!((near.counted, near.mean_angle()), (1, Some(1.0)));
    assert_eq!(summarize_band(&outcomes, 60.0, f64::INFINITY).counted, 2);
}
