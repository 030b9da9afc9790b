/* posewise.h - one camera frame in; head pose, 68 landmarks and facial animation out.
 * C99 and C++11. No heap, no globals, no clock, no threads, no I/O.
 *
 * Owner    Every byte is the caller's: nothing here allocates, so nothing here frees.
 * Stack    A call takes less than 32 KiB.
 * Threads  One tracker is used by one thread at a time. Trackers share only the model, which is
 *          read-only.
 * Pixels   x right, y down; (0, 0) is the centre of the top-left pixel of the upright picture.
 * Camera   Millimetres; +x image right, +y down, +z away from the camera; origin at its centre.
 * Head     Origin midway between the eyeballs; axes parallel to the camera's when the subject looks
 *          straight into it: +x to the subject's left, +y to the chin, +z to the back of the head.
 *          A head point p is at R p + translation_mm in the camera frame.
 * Angles   R = Ry(-yaw) Rx(-pitch) Rz(roll), column vectors, right-handed turns about each axis.
 *          yaw > 0 turns the face to the image right, pitch > 0 turns it up, roll > 0 tilts it
 *          clockwise in the image. For d = R (0, 0, -1), where the nose points:
 *          yaw = atan2(d.x, -d.z), pitch = asin(-d.y).
 * Sides    Left and right are the subject's, but for "image right".
 * Growth   Set struct_size = sizeof(the struct); 0 in any other field means its default. A struct of
 *          an older header is taken as if zeros followed; a tail that the library does not know
 *          must be 0 going in and comes back as 0.
 * Failure  A status below 0: the tracker and all outputs are then as before the call. Every pointer
 *          is checked for NULL and alignment. Status numbers are never reused.
 *
 * Written by cbindgen from src/ffi: to change it, edit there and run
 *     POSEWISE_BLESS=1 cargo test --test header
 */

#ifndef POSEWISE_H
#define POSEWISE_H

#include <stddef.h>
#include <stdint.h>

#define POSEWISE_VERSION           0x000100u    // 0xMMmmpp; compare with posewise_version()
#define POSEWISE_ABI               1u           // Grows when programs must be compiled anew
#define POSEWISE_ALIGN             64u          // Of the tracker's memory and of the model [bytes]
#define POSEWISE_MEMORY_SIZE       (208 * 1024) // Enough for any posewise_config [bytes]
#define POSEWISE_LANDMARKS         68u          // iBUG 68
#define POSEWISE_ANIMATIONS        24u          // Weights; see posewise_animation_name()

#define POSEWISE_OK                0            // Success
#define POSEWISE_E_ARG             (-1)         // Wrong pointer, struct_size, flag or setting
#define POSEWISE_E_MEMORY          (-2)         // Tracker memory too small or misaligned
#define POSEWISE_E_MODEL           (-3)         // A section of the model is missing or wrong
#define POSEWISE_E_FRAME           (-4)         // Size, stride, rotation, data_len disagree
#define POSEWISE_E_TIME            (-5)         // Not after the timestamp of the frame before
#define POSEWISE_E_FORMAT          (-6)         // None of POSEWISE_FMT_*
#define POSEWISE_E_MODEL_ALIGN     (-7)         // Model not at a multiple of POSEWISE_ALIGN
#define POSEWISE_E_MODEL_TRUNCATED (-8)         // The model's bytes end too early
#define POSEWISE_E_MODEL_MAGIC     (-9)         // Not a .posewise model
#define POSEWISE_E_MODEL_VERSION   (-10)        // A format version that is not read here
#define POSEWISE_E_MODEL_CHECKSUM  (-11)        // Checksum wrong: the model was changed

#define POSEWISE_FMT_GREY          0x59455247u  // 8-bit grey
#define POSEWISE_FMT_Y10           0x20303159u  // 10-bit grey in 16-bit little-endian words
#define POSEWISE_FMT_Y16           0x20363159u  // 16-bit grey, little-endian
#define POSEWISE_FMT_YUYV          0x56595559u  // 4:2:2 packed, Y first
#define POSEWISE_FMT_UYVY          0x59565955u  // 4:2:2 packed, U first
#define POSEWISE_FMT_NV12          0x3231564Eu  // 4:2:0; pass the Y plane, chroma is not read
#define POSEWISE_FMT_NV21          0x3132564Eu  // 4:2:0; pass the Y plane, chroma is not read
#define POSEWISE_FMT_YU12          0x32315559u  // I420; pass the Y plane, chroma is not read
#define POSEWISE_FMT_RGB3          0x33424752u  // 24-bit R, G, B in memory
#define POSEWISE_FMT_BGR3          0x33524742u  // 24-bit B, G, R in memory
#define POSEWISE_FMT_XB24          0x34324258u  // 32-bit R, G, B, unused in memory
#define POSEWISE_FMT_AB24          0x34324241u  // 32-bit R, G, B, alpha in memory
#define POSEWISE_FMT_XR24          0x34325258u  // 32-bit B, G, R, unused in memory
#define POSEWISE_FMT_AR24          0x34325241u  // 32-bit B, G, R, alpha in memory
#define POSEWISE_FMT_BX24          0x34325842u  // 32-bit unused, R, G, B in memory
#define POSEWISE_FMT_BA24          0x34324142u  // 32-bit alpha, R, G, B in memory
#define POSEWISE_FMT_RX24          0x34325852u  // 32-bit unused, B, G, R in memory
#define POSEWISE_FMT_RA24          0x34324152u  // 32-bit alpha, B, G, R in memory

#define POSEWISE_FRAME_MIRRORED    1u           // Stored left to right reversed ("selfie")

#define POSEWISE_SEARCHING         0u           // No face; fields below timestamp_us are 0, but for loss
#define POSEWISE_TRACKING          1u           // Fitted on this frame

#define POSEWISE_COASTING          2u           // Not fitted: the last fit, age_us old
#define POSEWISE_LOSS_NONE         0u           // It is tracked, or there was none yet
#define POSEWISE_LOSS_LOW_CONFIDENCE 1u           // It no longer looked like a face with landmarks where they should be
#define POSEWISE_LOSS_LEFT_FRAME   2u           // Its middle left the frame
#define POSEWISE_LOSS_NO_POSE      3u           // No head pose explains the landmarks

// A tracker: opaque, it starts where the caller's memory starts. It holds no pointer into itself,
// so a memcpy of posewise_memory_size() bytes to memory of the same alignment is a second tracker
// that goes on independently.
typedef struct posewise_tracker posewise_tracker;

// What a function answers: POSEWISE_OK, or a negative POSEWISE_E_* that says what is wrong.
// Not an enum, because the width of an enum is a build option on ARM.
typedef int32_t posewise_status;

// A pinhole camera without distortion, in pixels of the upright frame. All four 0: a camera with
// a 60 degree horizontal field of view and the principal point in the middle. This struct is
// complete and never grows.
typedef struct posewise_intrinsics {
    // Focal lengths [px], finite, > 0.
    float fx;
    float fy;
    // Principal point [px], finite.
    float cx;
    float cy;
} posewise_intrinsics;

// Settings. NULL in place of this struct means all defaults.
typedef struct posewise_config {
    // sizeof(posewise_config).
    uint32_t struct_size;
    // 0; no flags yet.
    uint32_t flags;
    // Narrowest face searched for [px], 24..4096. 0: the default, 40.
    uint32_t min_face_px;
    // Work per step while searching, 100..10000000; a window is about two, six in a frame full
    // of noise. Bounds the time of a step, at the price of finding a face later. 0: the default, 3000.
    uint32_t scan_budget;
    // The camera; see posewise_set_intrinsics().
    posewise_intrinsics intrinsics;
    // How posewise_smoothed() filters (One-Euro): the cutoff for a face that does not move [Hz],
    // 0.01..100, lower is steadier; and how much it rises per unit of speed, up to 1000, higher is
    // prompter (units: widths of the face, radians, whole weights per second). 0: the defaults,
    // 1 and 12.
    float smoothing_hz;
    float smoothing_beta;
} posewise_config;

// One camera frame, borrowed for the one call.
typedef struct posewise_frame {
    // sizeof(posewise_frame).
    uint32_t struct_size;
    // POSEWISE_FMT_*: the values of V4L2_PIX_FMT_*. Only luma is read.
    uint32_t format;
    // When the frame was taken [us], on any monotonic clock; must increase from step to step.
    int64_t timestamp_us;
    // Stored size [px], 1..16384.
    uint32_t width;
    uint32_t height;
    // Bytes from row to row (V4L2: bytesperline); at least a row of pixels.
    uint32_t stride;
    // Clockwise turn that makes the stored picture upright: 0, 90, 180 or 270. Results are in
    // pixels of the upright picture.
    uint32_t rotation_deg;
    // 0 or POSEWISE_FRAME_MIRRORED. Mirroring is undone before the turn.
    uint32_t flags;
    // 0; keeps the struct free of padding.
    uint32_t reserved;
    // Bytes readable at data. The last row need not be padded to the stride.
    size_t data_len;
    // The first byte of the top row, as stored.
    const uint8_t *data;
} posewise_frame;

// The answer to one frame. Every number is finite.
typedef struct posewise_result {
    // sizeof(posewise_result), set by the caller.
    uint32_t struct_size;
    // POSEWISE_SEARCHING, POSEWISE_TRACKING or POSEWISE_COASTING.
    uint32_t state;
    // Of the frame that this answers [us].
    int64_t timestamp_us;
    // Time since the frame that the fit belongs to [us]; 0 while tracking.
    int64_t age_us;
    // Landmarks that posewise_landmarks() has: 68; 0 while searching.
    uint32_t landmark_count;
    // Calibrated probability that this is a face and that the landmarks are right (on average to
    // a tenth of the distance between the eyes' outer corners), 0..1. In a library built
    // without the verifier: how well the 3D face fits, from 1 to 0, no probability.
    float confidence;
    // Box of the landmarks: x, y, width, height [px].
    float face_box[4];
    // Head-to-camera rotation as a unit quaternion x, y, z, w.
    float rotation[4];
    // The same rotation as angles [deg]. yaw > 0: the face turns to the image right, -180..180.
    // pitch > 0: it turns up, -90..90. roll > 0: it tilts clockwise in the image, -180..180.
    float yaw_deg;
    float pitch_deg;
    float roll_deg;
    // The head's origin, midway between the eyeballs, in the camera frame [mm].
    float translation_mm[3];
    // The subject's left and right eye: 0 shut .. 1 open, -1 unknown (hidden, or too fast to tell).
    float eye_open[2];
    // POSEWISE_LOSS_*: why the face that is now coasted or searched for was lost.
    uint32_t loss;
    // Mean visibility of the landmarks, 0..1: low when much of the face is covered.
    float visible_share;
    // Standard deviations of the rotation about the camera's x, y and z axes [deg], from how far
    // the landmarks of this frame lie from the 3D face.
    float rotation_sigma_deg[3];
    // Standard deviations of translation_mm [mm], likewise.
    float translation_sigma_mm[3];
} posewise_result;

// One landmark. This struct is complete and never grows, so that arrays of it stay the same.
typedef struct posewise_landmark {
    // Place in the upright picture [px]. Points 0..16 follow the jaw's visible contour; the
    // others are the places of x_mm, y_mm, z_mm, estimated from the rest where they are hidden.
    float x;
    float y;
    // Calibrated probability that (x, y) is right to a tenth of the distance between the eyes'
    // outer corners, as it is on a face that looks into the camera, 0..1.
    float confidence;
    // Calibrated probability that the camera sees it: that neither the head itself nor anything
    // before it hides it, 0..1. In a library built without the verifier: 1 unless the head itself
    // hides it, else 0; the landmark's confidence is then the face's.
    float visibility;
    // The point of the 3D face, camera frame [mm]; for points 0..16 a fixed place on the jaw.
    float x_mm;
    float y_mm;
    float z_mm;
} posewise_landmark;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// POSEWISE_VERSION of the library that is linked.
uint32_t posewise_version(void);

// POSEWISE_ABI of the library that is linked.
uint32_t posewise_abi(void);

// One English line on a status; static, never NULL.
const char *posewise_strerror(posewise_status status);

// Writes the default settings with their real values (0 in a field means the same). As for every
// struct, out->struct_size must be set.
posewise_status posewise_config_default(posewise_config *out);

// Bytes of memory that posewise_init() needs for these settings (NULL: defaults), at most
// POSEWISE_MEMORY_SIZE; 0 if the settings are wrong.
size_t posewise_memory_size(const posewise_config *config);

// POSEWISE_ALIGN of the library that is linked.
size_t posewise_memory_align(void);

// The model built into the library, aligned, its length [bytes] in *len; NULL and 0 if the library
// was built without one.
const void *posewise_default_model(size_t *len);

// Checks a whole model as posewise_init() does: POSEWISE_OK, or what is wrong with it.
posewise_status posewise_model_check(const void *model, size_t model_len);

// Checks the model and the settings (NULL: defaults), then builds a tracker at memory. Memory and
// model must outlive the tracker; the model is not copied and may be shared. There is nothing to
// free: the memory is the caller's to use again at any time.
posewise_status posewise_init(posewise_tracker **out,
                              void *memory,
                              size_t memory_len,
                              const void *model,
                              size_t model_len,
                              const posewise_config *config);

// One frame in, one answer out. The work is bounded whatever the frame shows; nothing blocks.
posewise_status posewise_step(posewise_tracker *tracker,
                              const posewise_frame *frame,
                              posewise_result *out);

// Writes the first min(capacity, POSEWISE_LANDMARKS) landmarks of the last step; all zero while
// searching.
posewise_status posewise_landmarks(const posewise_tracker *tracker,
                                   posewise_landmark *out,
                                   size_t capacity);

// Writes the first min(capacity, POSEWISE_ANIMATIONS) animation weights of the last step, 0..1; all
// zero while searching.
posewise_status posewise_animation(const posewise_tracker *tracker,
                                   float *out,
                                   size_t capacity);

// The answer to the last step again, smoothed over time by a One-Euro filter: steadier to look at,
// but late by a frame or so. Pose, box and eye_open are smoothed, the rest is as it was.
posewise_status posewise_smoothed(const posewise_tracker *tracker,
                                  posewise_result *out);

// As posewise_landmarks(), smoothed likewise; confidence and visibility are as they were.
posewise_status posewise_smoothed_landmarks(const posewise_tracker *tracker,
                                            posewise_landmark *out,
                                            size_t capacity);

// As posewise_animation(), smoothed likewise.
posewise_status posewise_smoothed_animation(const posewise_tracker *tracker,
                                            float *out,
                                            size_t capacity);

// What the animation weight at this index is: ARKit's name of the blendshape ("jawOpen"). Static;
// NULL from POSEWISE_ANIMATIONS on.
const char *posewise_animation_name(uint32_t index);

// Forgets the face, its identity and the clock; model and settings stay.
posewise_status posewise_reset(posewise_tracker *tracker);

// Forgets the identity, as when somebody else takes the seat: the shape of the head is learnt anew
// from the next frames. The face goes on being tracked, and the answer to the last step stays.
posewise_status posewise_forget_identity(posewise_tracker *tracker);

// Changes the camera (zoom, another resolution) from the next step on. NULL or all zero: the
// default, a 60 degree horizontal field of view.
posewise_status posewise_set_intrinsics(posewise_tracker *tracker,
                                        const posewise_intrinsics *intrinsics);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* POSEWISE_H */
