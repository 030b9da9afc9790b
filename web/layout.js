// Structs and constants of include/posewise.h, as they lie in WebAssembly's memory.
// Generated. To change it, edit src/ffi and run
//     POSEWISE_BLESS=1 cargo test --release --test header --test web

export const ABI = 1;

export const ALIGN = 64;

export const LANDMARKS = 68;

export const ANIMATIONS = 24;

export const UNREAD_EVENTS = 64;

/** Status codes by name. */
export const STATUS = {
  OK: 0,
  E_ARG: -1,
  E_MEMORY: -2,
  E_MODEL: -3,
  E_FRAME: -4,
  E_TIME: -5,
  E_FORMAT: -6,
  E_MODEL_ALIGN: -7,
  E_MODEL_TRUNCATED: -8,
  E_MODEL_MAGIC: -9,
  E_MODEL_VERSION: -10,
  E_MODEL_CHECKSUM: -11,
  E_NULL: -12,
  E_POINTER_ALIGN: -13,
  E_STRUCT_SIZE: -14,
  E_TRACKER: -15,
  E_OVERLAP: -16,
  E_FLAGS: -17,
  E_INTRINSICS: -18,
  E_MIN_FACE: -19,
  E_SCAN_BUDGET: -20,
  E_SMOOTHING: -21,
  E_HINT: -22,
  E_ROI: -23,
  E_EXCLUDED: -24,
  E_LENS: -25,
};

/** Pixel formats by name. */
export const FORMATS = {
  GREY: 0x59455247,
  Y10: 0x20303159,
  Y16: 0x20363159,
  YUYV: 0x56595559,
  UYVY: 0x59565955,
  NV12: 0x3231564e,
  NV21: 0x3132564e,
  YU12: 0x32315559,
  RGB3: 0x33424752,
  BGR3: 0x33524742,
  XB24: 0x34324258,
  AB24: 0x34324241,
  XR24: 0x34325258,
  AR24: 0x34325241,
  BX24: 0x34325842,
  BA24: 0x34324142,
  RX24: 0x34325852,
  RA24: 0x34324152,
};

/** @typedef {(typeof STATES)[number]} State */
export const STATES = /** @type {const} */ ([
  'searching', 'tracking', 'coasting',
]);

/** @typedef {(typeof LOSSES)[number]} Loss */
export const LOSSES = /** @type {const} */ ([
  'none', 'low_confidence', 'left_frame', 'no_pose',
  'excluded',
]);

/** @typedef {(typeof EVENTS)[number]} EventKind */
export const EVENTS = /** @type {const} */ ([
  'acquired', 'reacquired', 'coasting', 'lost',
  'suppressed', 'filter_on', 'filter_off', 'reset',
  'forgotten',
]);

/** @typedef {(typeof LENSES)[number]} LensModel */
export const LENSES = /** @type {const} */ ([
  'pinhole', 'brown', 'fisheye',
]);

/**
 * A camera without its lens, in pixels of the upright image. All four 0 select the default: a
 *   horizontal field of view of 60 degrees and the principal point at the image centre. This struct
 *   never grows.
 * @typedef {object} Intrinsics
 * @property {number} fx Focal lengths [px], 1..1000000; fy is 0.1..10 times fx.
 * @property {number} fy Focal lengths [px], 1..1000000; fy is 0.1..10 times fx.
 * @property {number} cx Principal point [px], -100000..100000.
 * @property {number} cy Principal point [px], -100000..100000.
 */
export const INTRINSICS = {
  size: 16,
  fields: {
    fx: { at: 0, type: 'f32' },
    fy: { at: 4, type: 'f32' },
    cx: { at: 8, type: 'f32' },
    cy: { at: 12, type: 'f32' },
  },
};

/**
 * The distortion of a lens. Landmarks and boxes stay in the picture as the lens shows it; pose and
 *   points in mm are those without it. This struct never grows.
 * @typedef {object} Lens
 * @property {LensModel} model POSEWISE_LENS_*.
 * @property {[number, number, number, number, number]} coefficients With POSEWISE_LENS_BROWN,
 *   Brown-Conrady, x and y at unit depth and s = x^2 + y^2: x times (1 + k1 s + k2 s^2 + k3 s^3)
 *   plus 2 p1 x y + p2 (s + 2 x^2), y likewise with p1 and p2 swapped; k1, k2, k3 are
 *   -10000..10000, p1, p2 -0.1..0.1. With POSEWISE_LENS_FISHEYE, Kannala-Brandt, a point at the
 *   angle t from the axis is at t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8); all are -10..10. The
 *   picture must not turn back within 1 degree of the axis.
 */
export const LENS = {
  size: 24,
  fields: {
    model: { at: 0, type: 'u32', names: LENSES },
    coefficients: { at: 4, type: 'f32', count: 5 },
  },
};

/**
 * Settings. A NULL pointer to this struct selects all defaults.
 * @typedef {object} Config
 * @property {number} [minFacePx] Least width of a face to search for [px], 24..4096. 0: the
 *   default, 40.
 * @property {number} [scanBudget] Work per step while searching, 100..10000000. One detector window
 *   takes about 2 units, 6 in a frame of noise. A smaller budget shortens a step and delays
 *   detection. 0: the default, 3000.
 * @property {Intrinsics} [intrinsics] The camera; see posewise_set_intrinsics().
 * @property {number} [smoothingHz] Parameters of the One-Euro filter behind posewise_smoothed()
 *   (Casiez et al., CHI 2012). smoothing_hz: cutoff frequency at rest [Hz], 0.01..100; lower values
 *   reduce jitter. smoothing_beta: increase of the cutoff per unit of speed, up to 1000; higher
 *   values reduce lag. Speed is in face widths, radians or weights per second. 0: the defaults, 1
 *   and 12.
 * @property {number} [smoothingBeta] Parameters of the One-Euro filter behind posewise_smoothed()
 *   (Casiez et al., CHI 2012). smoothing_hz: cutoff frequency at rest [Hz], 0.01..100; lower values
 *   reduce jitter. smoothing_beta: increase of the cutoff per unit of speed, up to 1000; higher
 *   values reduce lag. Speed is in face widths, radians or weights per second. 0: the defaults, 1
 *   and 12.
 * @property {Lens} [lens] The lens of the camera; other than POSEWISE_LENS_PINHOLE only with
 *   intrinsics.
 */
export const CONFIG = {
  size: 64,
  fields: {
    structSize: { at: 0, type: 'u32' },
    flags: { at: 4, type: 'u32' },
    minFacePx: { at: 8, type: 'u32' },
    scanBudget: { at: 12, type: 'u32' },
    intrinsics: { at: 16, struct: INTRINSICS },
    smoothingHz: { at: 32, type: 'f32' },
    smoothingBeta: { at: 36, type: 'f32' },
    lens: { at: 40, struct: LENS },
  },
};
export const FRAME = {
  size: 48,
  fields: {
    structSize: { at: 0, type: 'u32' },
    format: { at: 4, type: 'u32' },
    timestampUs: { at: 8, type: 'i64' },
    width: { at: 16, type: 'u32' },
    height: { at: 20, type: 'u32' },
    stride: { at: 24, type: 'u32' },
    rotationDeg: { at: 28, type: 'u32' },
    flags: { at: 32, type: 'u32' },
    reserved: { at: 36, type: 'u32' },
    dataLen: { at: 40, type: 'u32' },
    data: { at: 44, type: 'u32' },
  },
};

/**
 * The result of one frame. Every number is finite.
 * @typedef {object} Result
 * @property {State} state POSEWISE_SEARCHING, POSEWISE_TRACKING or POSEWISE_COASTING.
 * @property {number} timestampUs Capture time of the frame [us], as given in posewise_frame.
 * @property {number} ageUs Time since the frame of the last fit [us]; 0 while tracking.
 * @property {number} landmarkCount Number of landmarks that posewise_landmarks() gives: 68; 0 while
 *   searching.
 * @property {number} confidence Calibrated probability that this is a face whose landmarks are
 *   right, 0..1. Right: the mean error is below a tenth of the distance between the outer eye
 *   corners. In a library built without the verifier: goodness of fit of the 3D face, 0..1, not a
 *   probability.
 * @property {[number, number, number, number]} faceBox Bounding box of the landmarks: x, y, width,
 *   height [px].
 * @property {[number, number, number, number]} rotation Head-to-camera rotation as a unit
 *   quaternion x, y, z, w.
 * @property {number} yawDeg The same rotation as angles [deg]. yaw > 0: the face turns to the image
 *   right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0: the face tilts clockwise in
 *   the image, -180..180.
 * @property {number} pitchDeg The same rotation as angles [deg]. yaw > 0: the face turns to the
 *   image right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0: the face tilts
 *   clockwise in the image, -180..180.
 * @property {number} rollDeg The same rotation as angles [deg]. yaw > 0: the face turns to the
 *   image right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0: the face tilts
 *   clockwise in the image, -180..180.
 * @property {[number, number, number]} translationMm Origin of the head frame, midway between the
 *   eyeballs, in the camera frame [mm].
 * @property {[number, number]} eyeOpen Eye opening, the person's left and right eye: 0 shut .. 1
 *   open, -1 unknown because the eye is hidden or moves too fast.
 * @property {Loss} loss POSEWISE_LOSS_*: why tracking was lost, while coasting or searching.
 * @property {number} visibleShare Mean visibility of the landmarks, 0..1: low when much of the face
 *   is occluded.
 * @property {[number, number, number]} rotationSigmaDeg Standard deviations of the rotation about
 *   the camera's x, y and z axes [deg], estimated from the distances between the landmarks of this
 *   frame and the 3D face. At most 180.
 * @property {[number, number, number]} translationSigmaMm Standard deviations of translation_mm
 *   [mm], estimated likewise. At most 100000.
 */
export const RESULT = {
  size: 128,
  fields: {
    structSize: { at: 0, type: 'u32' },
    state: { at: 4, type: 'u32', names: STATES },
    timestampUs: { at: 8, type: 'i64' },
    ageUs: { at: 16, type: 'i64' },
    landmarkCount: { at: 24, type: 'u32' },
    confidence: { at: 28, type: 'f32' },
    faceBox: { at: 32, type: 'f32', count: 4 },
    rotation: { at: 48, type: 'f32', count: 4 },
    yawDeg: { at: 64, type: 'f32' },
    pitchDeg: { at: 68, type: 'f32' },
    rollDeg: { at: 72, type: 'f32' },
    translationMm: { at: 76, type: 'f32', count: 3 },
    eyeOpen: { at: 88, type: 'f32', count: 2 },
    loss: { at: 96, type: 'u32', names: LOSSES },
    visibleShare: { at: 100, type: 'f32' },
    rotationSigmaDeg: { at: 104, type: 'f32', count: 3 },
    translationSigmaMm: { at: 116, type: 'f32', count: 3 },
  },
};

/**
 * Where a face is expected, for posewise_step_at(): found by another detector, or by a tracker of
 *   another camera.
 * @typedef {object} Hint
 * @property {[number, number, number, number]} faceBox Box of the landmarks in the upright image:
 *   x, y, width, height [px]. It reaches from the brows to below the chin and from ear to ear;
 *   boxes of whole heads are larger. The longer side is at least 16.
 * @property {number} [yawDeg] Yaw [deg] as in posewise_result, 0 where it is not known.
 * @property {number} [rollDeg] Roll [deg] as in posewise_result, 0 where it is not known.
 */
export const HINT = {
  size: 28,
  fields: {
    structSize: { at: 0, type: 'u32' },
    faceBox: { at: 4, type: 'f32', count: 4 },
    yawDeg: { at: 20, type: 'f32' },
    rollDeg: { at: 24, type: 'f32' },
  },
};

/**
 * A face of a frame, from posewise_detect(). This struct never grows.
 * @typedef {object} Face
 * @property {[number, number, number, number]} faceBox Box of the landmarks in the upright image:
 *   x, y, width, height [px].
 * @property {number} yawDeg Yaw [deg] as in posewise_result; rough.
 * @property {number} rollDeg Roll [deg] as in posewise_result.
 * @property {number} confidence As in posewise_result. In a library built without the verifier:
 *   always 1.
 */
export const FACE = {
  size: 28,
  fields: {
    faceBox: { at: 0, type: 'f32', count: 4 },
    yawDeg: { at: 16, type: 'f32' },
    rollDeg: { at: 20, type: 'f32' },
    confidence: { at: 24, type: 'f32' },
  },
};

/**
 * One landmark. This struct never grows, so the layout of arrays stays the same.
 * @typedef {object} Landmark
 * @property {number} x Position in the upright image [px]. Points 0..16 follow the visible contour
 *   of the jaw. The others are images of x_mm, y_mm, z_mm; hidden ones are estimated from the rest.
 * @property {number} y Position in the upright image [px]. Points 0..16 follow the visible contour
 *   of the jaw. The others are images of x_mm, y_mm, z_mm; hidden ones are estimated from the rest.
 * @property {number} confidence Calibrated probability that the error of (x, y) is below a tenth of
 *   the distance between the outer eye corners of the same face seen from the front, 0..1.
 * @property {number} visibility Calibrated probability that the landmark is visible, 0..1: neither
 *   the head itself nor anything in front of it hides it. In a library built without the verifier:
 *   0 where the head itself hides it, else 1; the landmark's confidence is then that of the face.
 * @property {number} xMm Point of the 3D face in the camera frame [mm]; for points 0..16 a fixed
 *   point of the jaw.
 * @property {number} yMm Point of the 3D face in the camera frame [mm]; for points 0..16 a fixed
 *   point of the jaw.
 * @property {number} zMm Point of the 3D face in the camera frame [mm]; for points 0..16 a fixed
 *   point of the jaw.
 */
export const LANDMARK = {
  size: 28,
  fields: {
    x: { at: 0, type: 'f32' },
    y: { at: 4, type: 'f32' },
    confidence: { at: 8, type: 'f32' },
    visibility: { at: 12, type: 'f32' },
    xMm: { at: 16, type: 'f32' },
    yMm: { at: 20, type: 'f32' },
    zMm: { at: 24, type: 'f32' },
  },
};

/**
 * An event of the log that posewise_events() reads. confidence and face_box are those of the fit
 *   that was accepted, or the last ones of the face that is lost; 0 where there is no face. This
 *   struct never grows, so the layout of arrays stays the same. Later libraries may have kinds that
 *   this header lacks.
 * @typedef {object} FaceEvent
 * @property {number} timestampUs Capture time of the frame [us]; of a call between two frames, that
 *   of the first.
 * @property {EventKind} kind POSEWISE_EVENT_*.
 * @property {Loss} loss POSEWISE_LOSS_*: why the face is lost; while searching, why the last one
 *   was.
 * @property {[number, number, number, number]} faceBox Bounding box of the landmarks: x, y, width,
 *   height [px].
 * @property {number} confidence As in posewise_result.
 */
export const EVENT = {
  size: 40,
  fields: {
    timestampUs: { at: 0, type: 'i64' },
    kind: { at: 8, type: 'u32', names: EVENTS },
    loss: { at: 12, type: 'u32', names: LOSSES },
    faceBox: { at: 16, type: 'f32', count: 4 },
    confidence: { at: 32, type: 'f32' },
    reserved: { at: 36, type: 'u32' },
  },
};

/**
 * A region of interest for posewise_set_roi(): a rectangle of the upright image [px]. All four 0:
 *   the whole frame. This struct never grows.
 * @typedef {object} Roi
 * @property {number} x Upper left corner.
 * @property {number} y Upper left corner.
 * @property {number} width Width and height, at least 1; x + width and y + height are at most
 *   16384.
 * @property {number} height Width and height, at least 1; x + width and y + height are at most
 *   16384.
 */
export const ROI = {
  size: 16,
  fields: {
    x: { at: 0, type: 'u32' },
    y: { at: 4, type: 'u32' },
    width: { at: 8, type: 'u32' },
    height: { at: 12, type: 'u32' },
  },
};
