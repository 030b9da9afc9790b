export const ABI: 1;
export const ALIGN: 64;
export const LANDMARKS: 68;
export const ANIMATIONS: 24;
export const UNREAD_EVENTS: 64;
export namespace STATUS {
    let OK: number;
    let E_ARG: number;
    let E_MEMORY: number;
    let E_MODEL: number;
    let E_FRAME: number;
    let E_TIME: number;
    let E_FORMAT: number;
    let E_MODEL_ALIGN: number;
    let E_MODEL_TRUNCATED: number;
    let E_MODEL_MAGIC: number;
    let E_MODEL_VERSION: number;
    let E_MODEL_CHECKSUM: number;
    let E_NULL: number;
    let E_POINTER_ALIGN: number;
    let E_STRUCT_SIZE: number;
    let E_TRACKER: number;
    let E_OVERLAP: number;
    let E_FLAGS: number;
    let E_INTRINSICS: number;
    let E_MIN_FACE: number;
    let E_SCAN_BUDGET: number;
    let E_SMOOTHING: number;
    let E_HINT: number;
    let E_ROI: number;
    let E_EXCLUDED: number;
    let E_LENS: number;
}
export namespace FORMATS {
    let GREY: number;
    let Y10: number;
    let Y16: number;
    let YUYV: number;
    let UYVY: number;
    let NV12: number;
    let NV21: number;
    let YU12: number;
    let RGB3: number;
    let BGR3: number;
    let XB24: number;
    let AB24: number;
    let XR24: number;
    let AR24: number;
    let BX24: number;
    let BA24: number;
    let RX24: number;
    let RA24: number;
}
/** @typedef {(typeof STATES)[number]} State */
export const STATES: readonly ["searching", "tracking", "coasting"];
/** @typedef {(typeof LOSSES)[number]} Loss */
export const LOSSES: readonly ["none", "low_confidence", "left_frame", "no_pose", "excluded"];
/** @typedef {(typeof EVENTS)[number]} EventKind */
export const EVENTS: readonly ["acquired", "reacquired", "coasting", "lost", "suppressed", "filter_on", "filter_off", "reset", "forgotten"];
/** @typedef {(typeof LENSES)[number]} LensModel */
export const LENSES: readonly ["pinhole", "brown", "fisheye"];
export namespace INTRINSICS {
    let size: number;
    namespace fields {
        namespace fx {
            let at: number;
            let type: string;
        }
        namespace fy {
            let at_1: number;
            export { at_1 as at };
            let type_1: string;
            export { type_1 as type };
        }
        namespace cx {
            let at_2: number;
            export { at_2 as at };
            let type_2: string;
            export { type_2 as type };
        }
        namespace cy {
            let at_3: number;
            export { at_3 as at };
            let type_3: string;
            export { type_3 as type };
        }
    }
}
export namespace LENS {
    let size_1: number;
    export { size_1 as size };
    export namespace fields_1 {
        namespace model {
            let at_4: number;
            export { at_4 as at };
            let type_4: string;
            export { type_4 as type };
            export { LENSES as names };
        }
        namespace coefficients {
            let at_5: number;
            export { at_5 as at };
            let type_5: string;
            export { type_5 as type };
            export let count: number;
        }
    }
    export { fields_1 as fields };
}
export namespace CONFIG {
    let size_2: number;
    export { size_2 as size };
    export namespace fields_2 {
        namespace structSize {
            let at_6: number;
            export { at_6 as at };
            let type_6: string;
            export { type_6 as type };
        }
        namespace flags {
            let at_7: number;
            export { at_7 as at };
            let type_7: string;
            export { type_7 as type };
        }
        namespace minFacePx {
            let at_8: number;
            export { at_8 as at };
            let type_8: string;
            export { type_8 as type };
        }
        namespace scanBudget {
            let at_9: number;
            export { at_9 as at };
            let type_9: string;
            export { type_9 as type };
        }
        namespace intrinsics {
            let at_10: number;
            export { at_10 as at };
            export { INTRINSICS as struct };
        }
        namespace smoothingHz {
            let at_11: number;
            export { at_11 as at };
            let type_10: string;
            export { type_10 as type };
        }
        namespace smoothingBeta {
            let at_12: number;
            export { at_12 as at };
            let type_11: string;
            export { type_11 as type };
        }
        namespace lens {
            let at_13: number;
            export { at_13 as at };
            export { LENS as struct };
        }
    }
    export { fields_2 as fields };
}
export namespace FRAME {
    let size_3: number;
    export { size_3 as size };
    export namespace fields_3 {
        export namespace structSize_1 {
            let at_14: number;
            export { at_14 as at };
            let type_12: string;
            export { type_12 as type };
        }
        export { structSize_1 as structSize };
        export namespace format {
            let at_15: number;
            export { at_15 as at };
            let type_13: string;
            export { type_13 as type };
        }
        export namespace timestampUs {
            let at_16: number;
            export { at_16 as at };
            let type_14: string;
            export { type_14 as type };
        }
        export namespace width {
            let at_17: number;
            export { at_17 as at };
            let type_15: string;
            export { type_15 as type };
        }
        export namespace height {
            let at_18: number;
            export { at_18 as at };
            let type_16: string;
            export { type_16 as type };
        }
        export namespace stride {
            let at_19: number;
            export { at_19 as at };
            let type_17: string;
            export { type_17 as type };
        }
        export namespace rotationDeg {
            let at_20: number;
            export { at_20 as at };
            let type_18: string;
            export { type_18 as type };
        }
        export namespace flags_1 {
            let at_21: number;
            export { at_21 as at };
            let type_19: string;
            export { type_19 as type };
        }
        export { flags_1 as flags };
        export namespace reserved {
            let at_22: number;
            export { at_22 as at };
            let type_20: string;
            export { type_20 as type };
        }
        export namespace dataLen {
            let at_23: number;
            export { at_23 as at };
            let type_21: string;
            export { type_21 as type };
        }
        export namespace data {
            let at_24: number;
            export { at_24 as at };
            let type_22: string;
            export { type_22 as type };
        }
    }
    export { fields_3 as fields };
}
export namespace RESULT {
    let size_4: number;
    export { size_4 as size };
    export namespace fields_4 {
        export namespace structSize_2 {
            let at_25: number;
            export { at_25 as at };
            let type_23: string;
            export { type_23 as type };
        }
        export { structSize_2 as structSize };
        export namespace state {
            let at_26: number;
            export { at_26 as at };
            let type_24: string;
            export { type_24 as type };
            export { STATES as names };
        }
        export namespace timestampUs_1 {
            let at_27: number;
            export { at_27 as at };
            let type_25: string;
            export { type_25 as type };
        }
        export { timestampUs_1 as timestampUs };
        export namespace ageUs {
            let at_28: number;
            export { at_28 as at };
            let type_26: string;
            export { type_26 as type };
        }
        export namespace landmarkCount {
            let at_29: number;
            export { at_29 as at };
            let type_27: string;
            export { type_27 as type };
        }
        export namespace confidence {
            let at_30: number;
            export { at_30 as at };
            let type_28: string;
            export { type_28 as type };
        }
        export namespace faceBox {
            let at_31: number;
            export { at_31 as at };
            let type_29: string;
            export { type_29 as type };
            let count_1: number;
            export { count_1 as count };
        }
        export namespace rotation {
            let at_32: number;
            export { at_32 as at };
            let type_30: string;
            export { type_30 as type };
            let count_2: number;
            export { count_2 as count };
        }
        export namespace yawDeg {
            let at_33: number;
            export { at_33 as at };
            let type_31: string;
            export { type_31 as type };
        }
        export namespace pitchDeg {
            let at_34: number;
            export { at_34 as at };
            let type_32: string;
            export { type_32 as type };
        }
        export namespace rollDeg {
            let at_35: number;
            export { at_35 as at };
            let type_33: string;
            export { type_33 as type };
        }
        export namespace translationMm {
            let at_36: number;
            export { at_36 as at };
            let type_34: string;
            export { type_34 as type };
            let count_3: number;
            export { count_3 as count };
        }
        export namespace eyeOpen {
            let at_37: number;
            export { at_37 as at };
            let type_35: string;
            export { type_35 as type };
            let count_4: number;
            export { count_4 as count };
        }
        export namespace loss {
            let at_38: number;
            export { at_38 as at };
            let type_36: string;
            export { type_36 as type };
            export { LOSSES as names };
        }
        export namespace visibleShare {
            let at_39: number;
            export { at_39 as at };
            let type_37: string;
            export { type_37 as type };
        }
        export namespace rotationSigmaDeg {
            let at_40: number;
            export { at_40 as at };
            let type_38: string;
            export { type_38 as type };
            let count_5: number;
            export { count_5 as count };
        }
        export namespace translationSigmaMm {
            let at_41: number;
            export { at_41 as at };
            let type_39: string;
            export { type_39 as type };
            let count_6: number;
            export { count_6 as count };
        }
    }
    export { fields_4 as fields };
}
export namespace HINT {
    let size_5: number;
    export { size_5 as size };
    export namespace fields_5 {
        export namespace structSize_3 {
            let at_42: number;
            export { at_42 as at };
            let type_40: string;
            export { type_40 as type };
        }
        export { structSize_3 as structSize };
        export namespace faceBox_1 {
            let at_43: number;
            export { at_43 as at };
            let type_41: string;
            export { type_41 as type };
            let count_7: number;
            export { count_7 as count };
        }
        export { faceBox_1 as faceBox };
        export namespace yawDeg_1 {
            let at_44: number;
            export { at_44 as at };
            let type_42: string;
            export { type_42 as type };
        }
        export { yawDeg_1 as yawDeg };
        export namespace rollDeg_1 {
            let at_45: number;
            export { at_45 as at };
            let type_43: string;
            export { type_43 as type };
        }
        export { rollDeg_1 as rollDeg };
    }
    export { fields_5 as fields };
}
export namespace FACE {
    let size_6: number;
    export { size_6 as size };
    export namespace fields_6 {
        export namespace faceBox_2 {
            let at_46: number;
            export { at_46 as at };
            let type_44: string;
            export { type_44 as type };
            let count_8: number;
            export { count_8 as count };
        }
        export { faceBox_2 as faceBox };
        export namespace yawDeg_2 {
            let at_47: number;
            export { at_47 as at };
            let type_45: string;
            export { type_45 as type };
        }
        export { yawDeg_2 as yawDeg };
        export namespace rollDeg_2 {
            let at_48: number;
            export { at_48 as at };
            let type_46: string;
            export { type_46 as type };
        }
        export { rollDeg_2 as rollDeg };
        export namespace confidence_1 {
            let at_49: number;
            export { at_49 as at };
            let type_47: string;
            export { type_47 as type };
        }
        export { confidence_1 as confidence };
    }
    export { fields_6 as fields };
}
export namespace LANDMARK {
    let size_7: number;
    export { size_7 as size };
    export namespace fields_7 {
        export namespace x {
            let at_50: number;
            export { at_50 as at };
            let type_48: string;
            export { type_48 as type };
        }
        export namespace y {
            let at_51: number;
            export { at_51 as at };
            let type_49: string;
            export { type_49 as type };
        }
        export namespace confidence_2 {
            let at_52: number;
            export { at_52 as at };
            let type_50: string;
            export { type_50 as type };
        }
        export { confidence_2 as confidence };
        export namespace visibility {
            let at_53: number;
            export { at_53 as at };
            let type_51: string;
            export { type_51 as type };
        }
        export namespace xMm {
            let at_54: number;
            export { at_54 as at };
            let type_52: string;
            export { type_52 as type };
        }
        export namespace yMm {
            let at_55: number;
            export { at_55 as at };
            let type_53: string;
            export { type_53 as type };
        }
        export namespace zMm {
            let at_56: number;
            export { at_56 as at };
            let type_54: string;
            export { type_54 as type };
        }
    }
    export { fields_7 as fields };
}
export namespace EVENT {
    let size_8: number;
    export { size_8 as size };
    export namespace fields_8 {
        export namespace timestampUs_2 {
            let at_57: number;
            export { at_57 as at };
            let type_55: string;
            export { type_55 as type };
        }
        export { timestampUs_2 as timestampUs };
        export namespace kind {
            let at_58: number;
            export { at_58 as at };
            let type_56: string;
            export { type_56 as type };
            export { EVENTS as names };
        }
        export namespace loss_1 {
            let at_59: number;
            export { at_59 as at };
            let type_57: string;
            export { type_57 as type };
            export { LOSSES as names };
        }
        export { loss_1 as loss };
        export namespace faceBox_3 {
            let at_60: number;
            export { at_60 as at };
            let type_58: string;
            export { type_58 as type };
            let count_9: number;
            export { count_9 as count };
        }
        export { faceBox_3 as faceBox };
        export namespace confidence_3 {
            let at_61: number;
            export { at_61 as at };
            let type_59: string;
            export { type_59 as type };
        }
        export { confidence_3 as confidence };
        export namespace reserved_1 {
            let at_62: number;
            export { at_62 as at };
            let type_60: string;
            export { type_60 as type };
        }
        export { reserved_1 as reserved };
    }
    export { fields_8 as fields };
}
export namespace ROI {
    let size_9: number;
    export { size_9 as size };
    export namespace fields_9 {
        export namespace x_1 {
            let at_63: number;
            export { at_63 as at };
            let type_61: string;
            export { type_61 as type };
        }
        export { x_1 as x };
        export namespace y_1 {
            let at_64: number;
            export { at_64 as at };
            let type_62: string;
            export { type_62 as type };
        }
        export { y_1 as y };
        export namespace width_1 {
            let at_65: number;
            export { at_65 as at };
            let type_63: string;
            export { type_63 as type };
        }
        export { width_1 as width };
        export namespace height_1 {
            let at_66: number;
            export { at_66 as at };
            let type_64: string;
            export { type_64 as type };
        }
        export { height_1 as height };
    }
    export { fields_9 as fields };
}
export type State = (typeof STATES)[number];
export type Loss = (typeof LOSSES)[number];
export type EventKind = (typeof EVENTS)[number];
export type LensModel = (typeof LENSES)[number];
/**
 * A camera without its lens, in pixels of the upright image. All four 0 select the default: a
 *   horizontal field of view of 60 degrees and the principal point at the image centre. This struct
 *   never grows.
 */
export type Intrinsics = {
    /**
     * Focal lengths [px], 1..1000000; fy is 0.1..10 times fx.
     */
    fx: number;
    /**
     * Focal lengths [px], 1..1000000; fy is 0.1..10 times fx.
     */
    fy: number;
    /**
     * Principal point [px], -100000..100000.
     */
    cx: number;
    /**
     * Principal point [px], -100000..100000.
     */
    cy: number;
};
/**
 * The distortion of a lens. Landmarks and boxes stay in the picture as the lens shows it; pose and
 *   points in mm are those without it. This struct never grows.
 */
export type Lens = {
    /**
     * POSEWISE_LENS_*.
     */
    model: LensModel;
    /**
     * With POSEWISE_LENS_BROWN,
     * Brown-Conrady, x and y at unit depth and s = x^2 + y^2: x times (1 + k1 s + k2 s^2 + k3 s^3)
     * plus 2 p1 x y + p2 (s + 2 x^2), y likewise with p1 and p2 swapped; k1, k2, k3 are
     * -10000..10000, p1, p2 -0.1..0.1. With POSEWISE_LENS_FISHEYE, Kannala-Brandt, a point at the
     * angle t from the axis is at t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8); all are -10..10. The
     * picture must not turn back within 1 degree of the axis.
     */
    coefficients: [number, number, number, number, number];
};
/**
 * Settings. A NULL pointer to this struct selects all defaults.
 */
export type Config = {
    /**
     * Least width of a face to search for [px], 24..4096. 0: the
     * default, 40.
     */
    minFacePx?: number | undefined;
    /**
     * Work per step while searching, 100..10000000. One detector window
     * takes about 2 units, 6 in a frame of noise. A smaller budget shortens a step and delays
     * detection. 0: the default, 3000.
     */
    scanBudget?: number | undefined;
    /**
     * The camera; see posewise_set_intrinsics().
     */
    intrinsics?: Intrinsics | undefined;
    /**
     * Parameters of the One-Euro filter behind posewise_smoothed()
     * (Casiez et al., CHI 2012). smoothing_hz: cutoff frequency at rest [Hz], 0.01..100; lower values
     * reduce jitter. smoothing_beta: increase of the cutoff per unit of speed, up to 1000; higher
     * values reduce lag. Speed is in face widths, radians or weights per second. 0: the defaults, 1
     * and 12.
     */
    smoothingHz?: number | undefined;
    /**
     * Parameters of the One-Euro filter behind posewise_smoothed()
     * (Casiez et al., CHI 2012). smoothing_hz: cutoff frequency at rest [Hz], 0.01..100; lower values
     * reduce jitter. smoothing_beta: increase of the cutoff per unit of speed, up to 1000; higher
     * values reduce lag. Speed is in face widths, radians or weights per second. 0: the defaults, 1
     * and 12.
     */
    smoothingBeta?: number | undefined;
    /**
     * The lens of the camera; other than POSEWISE_LENS_PINHOLE only with
     * intrinsics.
     */
    lens?: Lens | undefined;
};
/**
 * The result of one frame. Every number is finite.
 */
export type Result = {
    /**
     * POSEWISE_SEARCHING, POSEWISE_TRACKING or POSEWISE_COASTING.
     */
    state: State;
    /**
     * Capture time of the frame [us], as given in posewise_frame.
     */
    timestampUs: number;
    /**
     * Time since the frame of the last fit [us]; 0 while tracking.
     */
    ageUs: number;
    /**
     * Number of landmarks that posewise_landmarks() gives: 68; 0 while
     * searching.
     */
    landmarkCount: number;
    /**
     * Calibrated probability that this is a face whose landmarks are
     * right, 0..1. Right: the mean error is below a tenth of the distance between the outer eye
     * corners. In a library built without the verifier: goodness of fit of the 3D face, 0..1, not a
     * probability.
     */
    confidence: number;
    /**
     * Bounding box of the landmarks: x, y, width,
     * height [px].
     */
    faceBox: [number, number, number, number];
    /**
     * Head-to-camera rotation as a unit
     * quaternion x, y, z, w.
     */
    rotation: [number, number, number, number];
    /**
     * The same rotation as angles [deg]. yaw > 0: the face turns to the image
     * right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0: the face tilts clockwise in
     * the image, -180..180.
     */
    yawDeg: number;
    /**
     * The same rotation as angles [deg]. yaw > 0: the face turns to the
     * image right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0: the face tilts
     * clockwise in the image, -180..180.
     */
    pitchDeg: number;
    /**
     * The same rotation as angles [deg]. yaw > 0: the face turns to the
     * image right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0: the face tilts
     * clockwise in the image, -180..180.
     */
    rollDeg: number;
    /**
     * Origin of the head frame, midway between the
     * eyeballs, in the camera frame [mm].
     */
    translationMm: [number, number, number];
    /**
     * Eye opening, the person's left and right eye: 0 shut .. 1
     * open, -1 unknown because the eye is hidden or moves too fast.
     */
    eyeOpen: [number, number];
    /**
     * POSEWISE_LOSS_*: why tracking was lost, while coasting or searching.
     */
    loss: Loss;
    /**
     * Mean visibility of the landmarks, 0..1: low when much of the face
     * is occluded.
     */
    visibleShare: number;
    /**
     * Standard deviations of the rotation about
     * the camera's x, y and z axes [deg], estimated from the distances between the landmarks of this
     * frame and the 3D face. At most 180.
     */
    rotationSigmaDeg: [number, number, number];
    /**
     * Standard deviations of translation_mm
     * [mm], estimated likewise. At most 100000.
     */
    translationSigmaMm: [number, number, number];
};
/**
 * Where a face is expected, for posewise_step_at(): found by another detector, or by a tracker of
 *   another camera.
 */
export type Hint = {
    /**
     * Box of the landmarks in the upright image:
     * x, y, width, height [px]. It reaches from the brows to below the chin and from ear to ear;
     * boxes of whole heads are larger. The longer side is at least 16.
     */
    faceBox: [number, number, number, number];
    /**
     * Yaw [deg] as in posewise_result, 0 where it is not known.
     */
    yawDeg?: number | undefined;
    /**
     * Roll [deg] as in posewise_result, 0 where it is not known.
     */
    rollDeg?: number | undefined;
};
/**
 * A face of a frame, from posewise_detect(). This struct never grows.
 */
export type Face = {
    /**
     * Box of the landmarks in the upright image:
     * x, y, width, height [px].
     */
    faceBox: [number, number, number, number];
    /**
     * Yaw [deg] as in posewise_result; rough.
     */
    yawDeg: number;
    /**
     * Roll [deg] as in posewise_result.
     */
    rollDeg: number;
    /**
     * As in posewise_result. In a library built without the verifier:
     * always 1.
     */
    confidence: number;
};
/**
 * One landmark. This struct never grows, so the layout of arrays stays the same.
 */
export type Landmark = {
    /**
     * Position in the upright image [px]. Points 0..16 follow the visible contour
     * of the jaw. The others are images of x_mm, y_mm, z_mm; hidden ones are estimated from the rest.
     */
    x: number;
    /**
     * Position in the upright image [px]. Points 0..16 follow the visible contour
     * of the jaw. The others are images of x_mm, y_mm, z_mm; hidden ones are estimated from the rest.
     */
    y: number;
    /**
     * Calibrated probability that the error of (x, y) is below a tenth of
     * the distance between the outer eye corners of the same face seen from the front, 0..1.
     */
    confidence: number;
    /**
     * Calibrated probability that the landmark is visible, 0..1: neither
     * the head itself nor anything in front of it hides it. In a library built without the verifier:
     * 0 where the head itself hides it, else 1; the landmark's confidence is then that of the face.
     */
    visibility: number;
    /**
     * Point of the 3D face in the camera frame [mm]; for points 0..16 a fixed
     * point of the jaw.
     */
    xMm: number;
    /**
     * Point of the 3D face in the camera frame [mm]; for points 0..16 a fixed
     * point of the jaw.
     */
    yMm: number;
    /**
     * Point of the 3D face in the camera frame [mm]; for points 0..16 a fixed
     * point of the jaw.
     */
    zMm: number;
};
/**
 * An event of the log that posewise_events() reads. confidence and face_box are those of the fit
 *   that was accepted, or the last ones of the face that is lost; 0 where there is no face. This
 *   struct never grows, so the layout of arrays stays the same. Later libraries may have kinds that
 *   this header lacks.
 */
export type FaceEvent = {
    /**
     * Capture time of the frame [us]; of a call between two frames, that
     * of the first.
     */
    timestampUs: number;
    /**
     * POSEWISE_EVENT_*.
     */
    kind: EventKind;
    /**
     * POSEWISE_LOSS_*: why the face is lost; while searching, why the last one
     * was.
     */
    loss: Loss;
    /**
     * Bounding box of the landmarks: x, y, width,
     * height [px].
     */
    faceBox: [number, number, number, number];
    /**
     * As in posewise_result.
     */
    confidence: number;
};
/**
 * A region of interest for posewise_set_roi(): a rectangle of the upright image [px]. All four 0:
 *   the whole frame. This struct never grows.
 */
export type Roi = {
    /**
     * Upper left corner.
     */
    x: number;
    /**
     * Upper left corner.
     */
    y: number;
    /**
     * Width and height, at least 1; x + width and y + height are at most
     * 16384.
     */
    width: number;
    /**
     * Width and height, at least 1; x + width and y + height are at most
     * 16384.
     */
    height: number;
};
