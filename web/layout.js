// Structs and constants of include/posewise.h, as they lie in WebAssembly's memory.
// Generated. To change it, edit src/ffi and run
//     POSEWISE_BLESS=1 cargo test --release --test source

export const ABI = 1;

export const ALIGN = 64;

export const LANDMARKS = 68;

export const ANIMATIONS = 24;

export const EYE_LOOKS = 8;

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
  E_MONITOR: -26,
  E_MONITOR_CONFIG: -27,
  E_MONITOR_ZONES: -28,
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

/** Bits of the optional parts by name. */
export const PARTS = {
  'refiners': 1,
  'verifier': 2,
  'keyframes': 4,
  'monitor': 8,
  'default-model': 16,
};

/** @typedef {(typeof STATES)[number]} State */
export const STATES = /** @type {const} */ ([
  'searching', 'tracking', 'coasting',
]);

/** @typedef {(typeof LOSSES)[number]} Loss */
export const LOSSES = /** @type {const} */ ([
  'none', 'low-confidence', 'left-frame', 'no-pose',
  'excluded',
]);

/** @typedef {(typeof EVENTS)[number]} EventKind */
export const EVENTS = /** @type {const} */ ([
  'acquired', 'reacquired', 'coasting', 'lost',
  'suppressed', 'filter-on', 'filter-off', 'reset',
  'forgotten',
]);

/** @typedef {(typeof EYES)[number]} EyeStatus */
export const EYES = /** @type {const} */ ([
  'not-seen', 'known', 'turned', 'hidden',
  'small', 'blurred', 'glare', 'dark-glasses',
  'shut', 'uncertain',
]);

/** @typedef {(typeof LENSES)[number]} LensModel */
export const LENSES = /** @type {const} */ ([
  'pinhole', 'brown', 'fisheye',
]);

/** @typedef {(typeof TERMS)[number]} Terms */
export const TERMS = /** @type {const} */ ([
  'unknown', 'free', 'research',
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
/** @type {import('./struct.js').Layout} */
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
/** @type {import('./struct.js').Layout} */
export const LENS = {
  size: 24,
  fields: {
    model: { at: 0, type: 'u32', names: LENSES },
    coefficients: { at: 4, type: 'f32', count: 5 },
  },
};

/**
 * A region of interest: a rectangle of the upright image [px]. All four 0: the whole frame. This
 *   struct never grows.
 * @typedef {object} Roi
 * @property {number} x Upper left corner.
 * @property {number} y Upper left corner.
 * @property {number} width Width and height, at least 1; x + width and y + height are at most
 *   16384.
 * @property {number} height Width and height, at least 1; x + width and y + height are at most
 *   16384.
 */
/** @type {import('./struct.js').Layout} */
export const ROI = {
  size: 16,
  fields: {
    x: { at: 0, type: 'u32' },
    y: { at: 4, type: 'u32' },
    width: { at: 8, type: 'u32' },
    height: { at: 12, type: 'u32' },
  },
};

/**
 * Settings. A NULL pointer to this struct selects all defaults.
 * @typedef {object} Config
 * @property {number} [minFacePx] Least width of a face to search for [px], 24..4096. 0: the
 *   default, 40.
 * @property {number} [scanBudget] Work per step while searching, 100..10000000: 3000 is about a
 *   tracking step, 600 is one tile of the detector. A smaller budget shortens a step and delays
 *   detection. 0: the default, 3600.
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
 * @property {number} [gaze] POSEWISE_GAZE_ON: look at the eyes of the tracked face, which fills
 *   eye_open_probability to eye_look of posewise_result. It takes more time: a network for each
 *   eye. _OFF: those fields stay 0. _NATURAL: as _ON, for a person who looks straight ahead most of
 *   the time, as a driver does: part of the mean of the gaze in the head frame is taken off it, at
 *   most 8 degrees.
 * @property {Roi} [roi] Where faces are searched for; see posewise_set_roi(). All four 0: the whole
 *   frame.
 */
/** @type {import('./struct.js').Layout} */
export const CONFIG = {
  size: 84,
  fields: {
    structSize: { at: 0, type: 'u32', optional: true },
    flags: { at: 4, type: 'u32', optional: true },
    minFacePx: { at: 8, type: 'u32', optional: true },
    scanBudget: { at: 12, type: 'u32', optional: true },
    intrinsics: { at: 16, struct: INTRINSICS, optional: true },
    smoothingHz: { at: 32, type: 'f32', optional: true },
    smoothingBeta: { at: 36, type: 'f32', optional: true },
    lens: { at: 40, struct: LENS, optional: true },
    gaze: { at: 64, type: 'u32', optional: true },
    roi: { at: 68, struct: ROI, optional: true },
  },
};
/** @type {import('./struct.js').Layout} */
export const MODEL_DETAILS = {
  size: 184,
  fields: {
    structSize: { at: 0, type: 'u32' },
    formatVersion: { at: 4, type: 'u32' },
    length: { at: 8, type: 'u32' },
    checksum: { at: 12, type: 'u32' },
    terms: { at: 16, type: 'u32', names: TERMS },
    sectionCount: { at: 20, type: 'u32' },
    sections: { at: 24, type: 'u32', count: 32 },
    wrongSection: { at: 152, type: 'u32' },
    reserved: { at: 156, type: 'u32' },
    name: { at: 160, type: 'u32' },
    nameLen: { at: 164, type: 'u32' },
    sheet: { at: 168, type: 'u32' },
    sheetLen: { at: 172, type: 'u32' },
    check: { at: 176, type: 'u32' },
    checkLen: { at: 180, type: 'u32' },
  },
};
/** @type {import('./struct.js').Layout} */
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
 * @property {number} yawDeg The rotation as angles relative to the camera's axes [deg]. yaw > 0:
 *   the face turns to the image right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0:
 *   the face tilts clockwise in the image, -180..180.
 * @property {number} pitchDeg The rotation as angles relative to the camera's axes [deg]. yaw > 0:
 *   the face turns to the image right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0:
 *   the face tilts clockwise in the image, -180..180.
 * @property {number} rollDeg The rotation as angles relative to the camera's axes [deg]. yaw > 0:
 *   the face turns to the image right, -180..180. pitch > 0: the face turns up, -90..90. roll > 0:
 *   the face tilts clockwise in the image, -180..180.
 * @property {[number, number, number]} translationMm Origin of the head frame, midway between the
 *   eyeballs, in the camera frame [mm].
 * @property {[number, number]} eyeOpen Eye opening, the person's left and right eye: 0 shut .. 1
 *   open, -1 unknown because the eye is hidden or moves too fast.
 * @property {Loss} loss POSEWISE_LOSS_*: why tracking was lost, while coasting or searching.
 * @property {number} visibleShare Mean visibility of the landmarks, 0..1: low when much of the face
 *   is occluded.
 * @property {[number, number, number]} rotationSigmaDeg Standard deviations of the rotation about
 *   the camera's x, y and z axes [deg], as measured on rendered heads, by how the face is turned
 *   and how much of it is seen. At most 180. Without intrinsics they hold the unknown focal length.
 * @property {[number, number, number]} translationSigmaMm Standard deviations of translation_mm
 *   [mm], estimated likewise. At most 100000.
 * @property {[number, number]} eyeOpenProbability Calibrated probability that the person's left and
 *   right eye is open, 0..1, by a network that sees one eye at a time; -1 where eye_status is
 *   neither POSEWISE_EYE_KNOWN nor POSEWISE_EYE_UNCERTAIN. This and all below is 0 unless state is
 *   POSEWISE_TRACKING and posewise_config has gaze, and with a model without that network.
 * @property {[EyeStatus, EyeStatus]} eyeStatus POSEWISE_EYE_KNOWN where the lids of the left and
 *   right eye are known, else why they are not. With POSEWISE_EYE_UNCERTAIN there is a probability.
 * @property {[number, number]} irisLeft Middle of the iris [px of the upright image]: x, y; that of
 *   the landmarks of the eye where its gaze is unknown.
 * @property {[number, number]} irisRight Middle of the iris [px of the upright image]: x, y; that
 *   of the landmarks of the eye where its gaze is unknown.
 * @property {[EyeStatus, EyeStatus, EyeStatus]} gazeStatus POSEWISE_EYE_KNOWN where the gaze of the
 *   left eye, the right eye and both together is known, else why it is not. The numbers below are 0
 *   where it is unknown.
 * @property {[number, number, number]} gazeSigmaDeg Standard deviations of these gazes along each
 *   axis across them [deg].
 * @property {[number, number, number]} gazeLeft Unit directions in which the left eye, the right
 *   eye and both together look, camera frame.
 * @property {[number, number, number]} gazeRight Unit directions in which the left eye, the right
 *   eye and both together look, camera frame.
 * @property {[number, number, number]} gaze Unit directions in which the left eye, the right eye
 *   and both together look, camera frame.
 * @property {[number, number, number]} gazeHead That of both in the head frame: (0, 0, -1) is
 *   straight ahead.
 * @property {number} glasses Probability that the person wears glasses, 0..1; -1 where neither eye
 *   is seen.
 * @property {number} darkGlasses Probability that these are dark, 0..1; -1 where neither eye is
 *   seen.
 * @property {[number, number, number, number, number, number, number, number]} eyeLook ARKit's
 *   weights of the gaze, POSEWISE_EYE_LOOK_*, 0..1; 0 where it is unknown.
 * @property {number} facingYawDeg Facing: the rotation relative to the line from the face to the
 *   camera [deg]. All 0: the face looks into the lens, wherever in the picture it is. Signs and
 *   ranges as of yaw_deg, pitch_deg and roll_deg, which are relative to the camera's axes. These
 *   hardly depend on the focal length; use them where it is not known.
 * @property {number} facingPitchDeg Facing: the rotation relative to the line from the face to the
 *   camera [deg]. All 0: the face looks into the lens, wherever in the picture it is. Signs and
 *   ranges as of yaw_deg, pitch_deg and roll_deg, which are relative to the camera's axes. These
 *   hardly depend on the focal length; use them where it is not known.
 * @property {number} facingRollDeg Facing: the rotation relative to the line from the face to the
 *   camera [deg]. All 0: the face looks into the lens, wherever in the picture it is. Signs and
 *   ranges as of yaw_deg, pitch_deg and roll_deg, which are relative to the camera's axes. These
 *   hardly depend on the focal length; use them where it is not known.
 * @property {[number, number, number]} facingSigmaDeg Standard deviations of the facing yaw, pitch
 *   and roll [deg]. At most 180.
 * @property {number} focalPx Focal length along x with which the face was fitted [px].
 * @property {number} cameraAssumed 1: without intrinsics, 60 degrees across the frame were assumed.
 *   0: the tracker has them.
 */
/** @type {import('./struct.js').Layout} */
export const RESULT = {
  size: 304,
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
    eyeOpenProbability: { at: 128, type: 'f32', count: 2 },
    eyeStatus: { at: 136, type: 'u32', count: 2, names: EYES },
    irisLeft: { at: 144, type: 'f32', count: 2 },
    irisRight: { at: 152, type: 'f32', count: 2 },
    gazeStatus: { at: 160, type: 'u32', count: 3, names: EYES },
    gazeSigmaDeg: { at: 172, type: 'f32', count: 3 },
    gazeLeft: { at: 184, type: 'f32', count: 3 },
    gazeRight: { at: 196, type: 'f32', count: 3 },
    gaze: { at: 208, type: 'f32', count: 3 },
    gazeHead: { at: 220, type: 'f32', count: 3 },
    glasses: { at: 232, type: 'f32' },
    darkGlasses: { at: 236, type: 'f32' },
    eyeLook: { at: 240, type: 'f32', count: 8 },
    facingYawDeg: { at: 272, type: 'f32' },
    facingPitchDeg: { at: 276, type: 'f32' },
    facingRollDeg: { at: 280, type: 'f32' },
    facingSigmaDeg: { at: 284, type: 'f32', count: 3 },
    focalPx: { at: 296, type: 'f32' },
    cameraAssumed: { at: 300, type: 'u32' },
  },
};

/**
 * Where a face is expected, for posewise_step_at(): found by another detector, or by a tracker of
 *   another camera.
 * @typedef {object} Hint
 * @property {[number, number, number, number]} faceBox Box of the landmarks in the upright image:
 *   x, y, width, height [px]. It reaches from the brows to below the chin and from ear to ear;
 *   boxes of whole heads are larger. The longer side is at least 16.
 * @property {number} [yawDeg] As facing_yaw_deg of posewise_result [deg], 0 where it is not known.
 * @property {number} [rollDeg] Roll [deg] as in posewise_result, 0 where it is not known.
 */
/** @type {import('./struct.js').Layout} */
export const HINT = {
  size: 28,
  fields: {
    structSize: { at: 0, type: 'u32', optional: true },
    faceBox: { at: 4, type: 'f32', count: 4 },
    yawDeg: { at: 20, type: 'f32', optional: true },
    rollDeg: { at: 24, type: 'f32', optional: true },
  },
};

/**
 * A face of a frame, from posewise_detect(). This struct never grows.
 * @typedef {object} Face
 * @property {[number, number, number, number]} faceBox Box of the landmarks in the upright image:
 *   x, y, width, height [px].
 * @property {number} yawDeg As facing_yaw_deg of posewise_result [deg]; rough.
 * @property {number} rollDeg Roll [deg] as in posewise_result.
 * @property {number} confidence As in posewise_result. In a library built without the verifier:
 *   always 1.
 */
/** @type {import('./struct.js').Layout} */
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
/** @type {import('./struct.js').Layout} */
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
/** @type {import('./struct.js').Layout} */
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
 * Settings of a driver monitor. A NULL pointer to this struct selects all defaults; 0 in a field
 *   selects that of the preset, of which the comments have the general one. Times are at most 71
 *   minutes.
 * @typedef {object} Monitor_config
 * @property {number} preset POSEWISE_MONITOR_PRESET_*: the default of every other field, and the
 *   zones.
 * @property {number} gapUs How long an observation counts when no other follows, and how long what
 *   goes on survives unknown time [us], 100000..2000000. Default 300000, the gap that arbiters of
 *   driver monitors bridge.
 * @property {number} minConfidence Least confidence of a face that is observed, 0..1. Default 0.5,
 *   chosen.
 * @property {number} eyeYawDeg Largest angles from the line of sight at which eyes and mouth are
 *   known [deg], 10..90. Defaults 50 and 40, chosen: beyond, lids are seen too much from the side.
 * @property {number} eyePitchDeg Largest angles from the line of sight at which eyes and mouth are
 *   known [deg], 10..90. Defaults 50 and 40, chosen: beyond, lids are seen too much from the side.
 * @property {number} closedBelow Eyes close below the first openness and open above the second,
 *   0.05..0.95. Defaults 0.35 and 0.45, chosen on rendered clips.
 * @property {number} openAbove Eyes close below the first openness and open above the second,
 *   0.05..0.95. Defaults 0.35 and 0.45, chosen on rendered clips.
 * @property {number} blinkUs Shorter closures are no events [us]. Default 50000, chosen: a blink
 *   takes 100 to 400 ms.
 * @property {number} longClosureUs A longer closure is no blink [us]. Default 500000, as in studies
 *   of blinks.
 * @property {number} microsleepUs Closures of these lengths are a microsleep, sleep, an
 *   unresponsive driver [us]. Defaults 1000000, 3000000, 6000000: Euro NCAP 2026.
 * @property {number} sleepUs Closures of these lengths are a microsleep, sleep, an unresponsive
 *   driver [us]. Defaults 1000000, 3000000, 6000000: Euro NCAP 2026.
 * @property {number} unresponsiveUs Closures of these lengths are a microsleep, sleep, an
 *   unresponsive driver [us]. Defaults 1000000, 3000000, 6000000: Euro NCAP 2026.
 * @property {number} drowsyP8060 Drowsy from these P80 over 60 and 180 s, 0.01..1. Defaults 0.15
 *   (Wierwille 1994; NSTSCE 25-UI-177) and 0.12 (NHTSA and VTTI, DOT HS 811 117).
 * @property {number} drowsyP80180 Drowsy from these P80 over 60 and 180 s, 0.01..1. Defaults 0.15
 *   (Wierwille 1994; NSTSCE 25-UI-177) and 0.12 (NHTSA and VTTI, DOT HS 811 117).
 * @property {number} awakeShare Awake below this share of both, 0.1..1. Default 0.5: Wierwille
 *   1994, 7.5 and 15 %.
 * @property {number} minKnown Least known share of a window that decides, 0.05..1. Default 0.5,
 *   chosen.
 * @property {number} yawnAbove The mouth is open for a yawn above the first jaw_open and shut below
 *   the second, up to 0.95. Defaults 0.5 (studies of mouth ratios have 0.5 to 0.6) and 0.35,
 *   chosen.
 * @property {number} yawnBelow The mouth is open for a yawn above the first jaw_open and shut below
 *   the second, up to 0.95. Defaults 0.5 (studies of mouth ratios have 0.5 to 0.6) and 0.35,
 *   chosen.
 * @property {number} yawnUs Shortest and longest yawn [us]. Defaults 1500000 and 12000000, from
 *   studies of yawns.
 * @property {number} yawnMaxUs Shortest and longest yawn [us]. Defaults 1500000 and 12000000, from
 *   studies of yawns.
 * @property {number} nodDeg A nod is a drop of the pitch by nod_deg within a second, 5..60, and a
 *   return within nod_us, at least a second, with closed eyes. Defaults 12 [deg] and 3000000 [us],
 *   from studies.
 * @property {number} nodUs A nod is a drop of the pitch by nod_deg within a second, 5..60, and a
 *   return within nod_us, at least a second, with closed eyes. Defaults 12 [deg] and 3000000 [us],
 *   from studies.
 * @property {number} forwardYawDeg Direction of the road: yaw (-90..90) and pitch (-60..60) of a
 *   face that looks there, in the camera frame [deg]. Default 0 and 0.
 * @property {number} forwardPitchDeg Direction of the road: yaw (-90..90) and pitch (-60..60) of a
 *   face that looks there, in the camera frame [deg]. Default 0 and 0.
 * @property {number} naturalYawDeg How far the driver's natural pose may be from there [deg], up to
 *   50 and 30. Defaults 45 and 25, for cameras up to 40 degrees off the driver's axis.
 * @property {number} naturalPitchDeg How far the driver's natural pose may be from there [deg], up
 *   to 50 and 30. Defaults 45 and 25, for cameras up to 40 degrees off the driver's axis.
 * @property {number} zoneMarginDeg A zone is left this far outside of it [deg], up to 15. Default
 *   3, chosen: the error of a pose.
 * @property {number} longGlanceUs A glance away of this length is long [us]. Default 3000000: Euro
 *   NCAP 2026, 3 to 4 s.
 * @property {number} cumulativeUs So much of the last 30 s away is too much [us], up to 30000000.
 *   Default 10000000: Euro NCAP 2026.
 * @property {number} returnUs Time on the road that ends a glance [us]. Default 300000, as gap_us.
 * @property {number} clearUs Time on the road that clears the time away [us]. Default 2000000: Euro
 *   NCAP 2026.
 * @property {number} degradedUs Eyes that are unknown for this long are reported [us]. Default
 *   10000000: Euro NCAP 2026.
 */
/** @type {import('./struct.js').Layout} */
export const MONITOR_CONFIG = {
  size: 136,
  fields: {
    structSize: { at: 0, type: 'u32' },
    flags: { at: 4, type: 'u32' },
    preset: { at: 8, type: 'u32' },
    gapUs: { at: 12, type: 'u32' },
    minConfidence: { at: 16, type: 'f32' },
    eyeYawDeg: { at: 20, type: 'f32' },
    eyePitchDeg: { at: 24, type: 'f32' },
    closedBelow: { at: 28, type: 'f32' },
    openAbove: { at: 32, type: 'f32' },
    blinkUs: { at: 36, type: 'u32' },
    longClosureUs: { at: 40, type: 'u32' },
    microsleepUs: { at: 44, type: 'u32' },
    sleepUs: { at: 48, type: 'u32' },
    unresponsiveUs: { at: 52, type: 'u32' },
    drowsyP8060: { at: 56, type: 'f32' },
    drowsyP80180: { at: 60, type: 'f32' },
    awakeShare: { at: 64, type: 'f32' },
    minKnown: { at: 68, type: 'f32' },
    yawnAbove: { at: 72, type: 'f32' },
    yawnBelow: { at: 76, type: 'f32' },
    yawnUs: { at: 80, type: 'u32' },
    yawnMaxUs: { at: 84, type: 'u32' },
    nodDeg: { at: 88, type: 'f32' },
    nodUs: { at: 92, type: 'u32' },
    forwardYawDeg: { at: 96, type: 'f32' },
    forwardPitchDeg: { at: 100, type: 'f32' },
    naturalYawDeg: { at: 104, type: 'f32' },
    naturalPitchDeg: { at: 108, type: 'f32' },
    zoneMarginDeg: { at: 112, type: 'f32' },
    longGlanceUs: { at: 116, type: 'u32' },
    cumulativeUs: { at: 120, type: 'u32' },
    returnUs: { at: 124, type: 'u32' },
    clearUs: { at: 128, type: 'u32' },
    degradedUs: { at: 132, type: 'u32' },
  },
};

/**
 * What a driver monitor sees of one frame, from posewise_monitor_observe() or from elsewhere.
 *   Numbers that are not finite are unknown.
 * @typedef {object} Monitor_observation
 * @property {number} state As in posewise_result. Only POSEWISE_TRACKING is a face that is
 *   observed.
 * @property {number} confidence As in posewise_result.
 * @property {number} yawDeg As in posewise_result [deg].
 * @property {number} pitchDeg As in posewise_result [deg].
 * @property {[number, number, number]} translationMm As in posewise_result [mm].
 * @property {[number, number, number]} rotationSigmaDeg As in posewise_result [deg].
 * @property {[number, number]} eyeOpen Distance of the lids in that of open ones, of the person's
 *   left and right eye, 0 shut .. 1 open, -1 unknown; posewise_monitor_observe() computes it from
 *   posewise_result.eye_open and what the gaze says of the eyes.
 * @property {number} jawOpen The animation weight jawOpen, 0..1; -1: unknown, because the mouth is
 *   hidden.
 * @property {number} cameraAssumed As in posewise_result. 1: the natural pose is learnt, and angles
 *   from the road count, relative to the line of sight, which hardly depends on the focal length;
 *   not with POSEWISE_MONITOR_FIXED_POSE.
 */
/** @type {import('./struct.js').Layout} */
export const MONITOR_OBSERVATION = {
  size: 60,
  fields: {
    structSize: { at: 0, type: 'u32' },
    state: { at: 4, type: 'u32' },
    confidence: { at: 8, type: 'f32' },
    yawDeg: { at: 12, type: 'f32' },
    pitchDeg: { at: 16, type: 'f32' },
    translationMm: { at: 20, type: 'f32', count: 3 },
    rotationSigmaDeg: { at: 32, type: 'f32', count: 3 },
    eyeOpen: { at: 44, type: 'f32', count: 2 },
    jawOpen: { at: 52, type: 'f32' },
    cameraAssumed: { at: 56, type: 'u32' },
  },
};

/**
 * Measures of eye closure over a window of whole seconds. This struct never grows.
 * @typedef {object} Monitor_perclos
 * @property {number} p70 Shares of the known time with eyes closed by at least 70 and 80 %, 0..1.
 * @property {number} p80 Shares of the known time with eyes closed by at least 70 and 80 %, 0..1.
 * @property {number} em Mean square of the closure over the known time, 0..1.
 * @property {number} known Share of the window in which the eyes were known, 0..1.
 * @property {number} closures Closures that ended in the window, blinks too, and their mean length
 *   [us].
 * @property {number} meanClosureUs Closures that ended in the window, blinks too, and their mean
 *   length [us].
 */
/** @type {import('./struct.js').Layout} */
export const MONITOR_PERCLOS = {
  size: 24,
  fields: {
    p70: { at: 0, type: 'f32' },
    p80: { at: 4, type: 'f32' },
    em: { at: 8, type: 'f32' },
    known: { at: 12, type: 'f32' },
    closures: { at: 16, type: 'u32' },
    meanClosureUs: { at: 20, type: 'u32' },
  },
};

/**
 * What a driver monitor knows after an observation.
 * @typedef {object} Monitor_state
 * @property {number} eyes POSEWISE_MONITOR_EYES_*.
 * @property {number} timestampUs Timestamp of the last observation [us]; 0 before the first.
 * @property {number} eyesReason POSEWISE_MONITOR_REASON_*: why the eyes are unknown, _NONE where
 *   they are known.
 * @property {number} openness Both eyes, relative to this person's open ones: 0 shut .. 1 open, -1
 *   unknown.
 * @property {number} closureUs Known closed time of the closure that goes on [us].
 * @property {number} blinks Blinks, yawns and nods so far.
 * @property {number} yawns Blinks, yawns and nods so far.
 * @property {number} nods Blinks, yawns and nods so far.
 * @property {number} mouthOpenUs Known time for which the mouth is open as in a yawn [us].
 * @property {number} zone Index of the zone, POSEWISE_MONITOR_ZONE_OUTSIDE or
 *   POSEWISE_MONITOR_ZONE_UNKNOWN.
 * @property {number} zoneUs Time there [us].
 * @property {number} awayUs Known time away from the road, less the grace of zones, in this glance
 *   [us].
 * @property {number} away30Us The same in the last 30 s [us]: the current quarter of a second and
 *   the 119 before.
 * @property {number} naturalIsFinal 1: natural_deg is final, after a minute of known pose. Before
 *   the first 10 s of it, the zone is unknown.
 * @property {[number, number]} fromRoadDeg Yaw and pitch from the direction of the road [deg]; 0
 *   for an unknown zone.
 * @property {[number, number]} naturalDeg The natural pose: yaw and pitch from forward_yaw_deg and
 *   forward_pitch_deg [deg].
 * @property {[number, number]} openEye posewise_monitor_observation.eye_open of this person's open
 *   left and right eye; 1 until it is final.
 * @property {number} openEyeIsFinal 1: open_eye is final, after half a minute of known eyes while
 *   alert.
 * @property {number} drowsiness POSEWISE_MONITOR_DROWSINESS_*.
 * @property {number} degraded 1: the eyes have been unknown for degraded_us.
 * @property {[number, number, number, number, number, number, number, number]} zonesUs Known time
 *   in each zone so far [us].
 * @property {number} perclos60 Measures over the last 60 and 180 whole seconds since the first
 *   observation. They change once a second.
 * @property {number} perclos180 Measures over the last 60 and 180 whole seconds since the first
 *   observation. They change once a second.
 */
/** @type {import('./struct.js').Layout} */
export const MONITOR_STATE = {
  size: 216,
  fields: {
    structSize: { at: 0, type: 'u32' },
    eyes: { at: 4, type: 'u32' },
    timestampUs: { at: 8, type: 'i64' },
    eyesReason: { at: 16, type: 'u32' },
    openness: { at: 20, type: 'f32' },
    closureUs: { at: 24, type: 'u32' },
    blinks: { at: 28, type: 'u32' },
    yawns: { at: 32, type: 'u32' },
    nods: { at: 36, type: 'u32' },
    mouthOpenUs: { at: 40, type: 'u32' },
    zone: { at: 44, type: 'u32' },
    zoneUs: { at: 48, type: 'u32' },
    awayUs: { at: 52, type: 'u32' },
    away30Us: { at: 56, type: 'u32' },
    naturalIsFinal: { at: 60, type: 'u32' },
    fromRoadDeg: { at: 64, type: 'f32', count: 2 },
    naturalDeg: { at: 72, type: 'f32', count: 2 },
    openEye: { at: 80, type: 'f32', count: 2 },
    openEyeIsFinal: { at: 88, type: 'u32' },
    drowsiness: { at: 92, type: 'u32' },
    degraded: { at: 96, type: 'u32' },
    reserved: { at: 100, type: 'u32' },
    zonesUs: { at: 104, type: 'i64', count: 8 },
    perclos60: { at: 168, struct: MONITOR_PERCLOS },
    perclos180: { at: 192, struct: MONITOR_PERCLOS },
  },
};

/**
 * An event of posewise_monitor_events(). This struct never grows, so the layout of arrays stays the
 *   same. Later libraries may have kinds that this header lacks.
 * @typedef {object} Monitor_event
 * @property {number} timestampUs Timestamp of the observation at which it was noticed [us].
 * @property {number} startUs Timestamp at which what it is about began [us]. If the clock was set
 *   back since: for what ends with that, in the time before, so it may be after timestamp_us; for
 *   what lasts on, the first timestamp after it.
 * @property {number} durationUs Known duration of it so far [us], without what was unknown in
 *   between, and without the jump of a clock that was set back. At most 0xFFFFFFFF, 71 minutes.
 * @property {number} kind POSEWISE_MONITOR_EVENT_*.
 * @property {number} zone Zone of a glance, else POSEWISE_MONITOR_ZONE_UNKNOWN.
 * @property {number} value As the kind says, else 0.
 */
/** @type {import('./struct.js').Layout} */
export const MONITOR_EVENT = {
  size: 40,
  fields: {
    timestampUs: { at: 0, type: 'i64' },
    startUs: { at: 8, type: 'i64' },
    durationUs: { at: 16, type: 'u32' },
    kind: { at: 20, type: 'u32' },
    zone: { at: 24, type: 'u32' },
    flags: { at: 28, type: 'u32' },
    value: { at: 32, type: 'f32' },
    reserved: { at: 36, type: 'u32' },
  },
};

/**
 * A zone of a driver monitor. Where zones overlap, the first one counts. This struct never grows,
 *   so the layout of arrays stays the same.
 * @typedef {object} Monitor_zone
 * @property {number} kind POSEWISE_MONITOR_ZONE_ANGLES, _BOX or _PLANE.
 * @property {number} graceUs Time of a stay that does not count as away [us]; 0xFFFFFFFF: none of
 *   it does.
 * @property {[number, number, number, number, number, number, number, number, number]} numbers As
 *   the kind says, the rest 0. Angles are those from the direction of the road, within -180..180:
 *   yaw > 0 to the image right, pitch > 0 up. Boxes, along the axes, and planes, the parallelogram
 *   centre +- u +- v, are in the camera frame, within -20000..20000 mm. Each min is below its max.
 *   The cross product of u and v is at least 100 mm2, and at least 0.1 |u| |v|: they are at least
 *   5.74 degrees from parallel.
 */
/** @type {import('./struct.js').Layout} */
export const MONITOR_ZONE = {
  size: 48,
  fields: {
    kind: { at: 0, type: 'u32' },
    flags: { at: 4, type: 'u32' },
    graceUs: { at: 8, type: 'u32' },
    numbers: { at: 12, type: 'f32', count: 9 },
  },
};
