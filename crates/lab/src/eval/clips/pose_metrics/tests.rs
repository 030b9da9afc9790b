use super::*;

fn truth(yaw: f64) -> Truth {
    // Box 100 × 64: its size is 80.
    let mut points = [[50.0, 32.0]; 68];
    points[0] = [0.0, 0.0];
    points[1] = [100.0, 64.0];
    Truth {
        eye_mid: Some([0.0, 0.0, 600.0]),
        ..Truth::new([yaw, 0.0, 0.0], points)
    }
}

fn tracked(truth: &Truth, angles: [f64; 3]) -> Frame {
    Frame {
        tracked: Some(Tracked {
            angles: std::array::from_fn(|i| truth.angles[i] + angles[i]),
            points: truth.points,
        }),
        translation: Some([3.0, 0.0, 604.0]),
        ..Frame::default()
    }
}

#[test]
fn covered_frames_are_told_apart() {
    let outcome = |covered: Option<bool>, error: f64| {
        let t = Truth {
            covered: covered.map(|all| [all; 68]),
            ..truth(0.0)
        };
        let found = tracked(&t, [error; 3]);
        FrameOutcome::new(&t, &found)
    };
    assert!(summarize_covered(&[outcome(None, 1.0)], false).is_none());
    let some = [
        outcome(Some(true), 4.0),
        outcome(Some(false), 1.0),
        outcome(Some(false), 2.0),
    ];
    let covered = |is: bool| summarize_covered(&some, is).unwrap();
    assert_eq!(covered(true).e_m_deg, Some(4.0));
    assert_eq!(covered(false).e_m_deg, Some(1.5));
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
            FrameOutcome::new(&t, &tracked(&t, [*error, 0.0, 0.0]))
        })
        .collect();
    let steps = summarize_steps(&outcomes);
    let of = |name: &str| &steps.iter().find(|(n, _)| n == name).unwrap().1;
    assert_eq!(
        (of("80-90").shrinkage_deg, of("80-90").off),
        (Some(10.0), Some(0.0))
    );
    assert_eq!(
        (of("60-70").shrinkage_deg, of("60-70").off),
        (Some(-30.0), Some(1.0))
    );
    assert_eq!((of("60-95").counted, of("0-60").counted), (3, 0));
    assert!(summarize_occluded(&outcomes).is_none());
    let mut t = truth(0.0);
    t.covered = Some(std::array::from_fn(|i| (17..40).contains(&i)));
    (17..40).for_each(|i| t.visible[i] = false);
    // Hidden by the head: neither seen nor covered.
    t.visible[60] = false;
    t.occluder = Some(true);
    let mut found = tracked(&t, [0.0; 3]);
    let seen = |i: usize| f64::from(u8::from(!(17..40).contains(&i)));
    found.confidence = Some(Confidence {
        face: 1.0,
        landmarks: [0.5; 68],
        visibility: Some(std::array::from_fn(seen)),
    });
    outcomes.push(FrameOutcome::new(&t, &found));
    let occluded = summarize_occluded(&outcomes).unwrap();
    assert_eq!((occluded.counted, occluded.covered_auc), (1, Some(1.0)));
    assert!(occluded.visibility_auc.unwrap() < 1.0);
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
        .map(|(t, e)| FrameOutcome::new(t, &e.map_or(Frame::default(), |e| tracked(t, e))))
        .collect();
    let mut gone = truth(0.0);
    gone.in_frame = 0.0;
    outcomes.push(FrameOutcome::new(&gone, &tracked(&gone, [0.0; 3])));
    let s = summarize(outcomes.iter());
    assert_eq!((s.frames, s.counted, s.tracked), (6, 5, 3));
    assert_eq!(s.p_s, Some(0.6));
    let near = |found: Option<f64>, error: f64| (found.unwrap() - error).abs() < 1e-9;
    assert!(near(s.e_yaw_deg, (2.0 + 4.0 + 170.0) / 3.0));
    assert!(near(s.e_pitch_deg, 4.0 / 3.0) && near(s.e_roll_deg, 2.0));
    assert_eq!((s.translation_mm, s.depth_mm), (Some(5.0), Some(4.0)));
    assert_eq!((s.wrong, s.lost_within_60), (1, 1));
    assert_eq!((s.sign_flips, s.false_tracks), (1, 1));
    let near = summarize_band(&outcomes, 0.0, 30.0);
    assert_eq!((near.counted, near.e_m_deg), (1, Some(1.0)));
    assert_eq!(summarize_band(&outcomes, 60.0, f64::INFINITY).counted, 2);
}
