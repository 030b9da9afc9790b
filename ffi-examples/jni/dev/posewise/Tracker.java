package dev.posewise;

import java.nio.ByteBuffer;

/**
 * Tracks one face of one camera. Units, signs and landmark order are those of posewise.h.
 *
 * <p>The memory is a direct buffer of this object: nothing needs closing. One thread at a time may
 * use a tracker.
 */
public final class Tracker {
    public static final int LANDMARKS = 68;

    /** Values of {@link #state}. */
    public static final int SEARCHING = 0, TRACKING = 1, COASTING = 2;

    public int state;
    public float confidence;
    public float yawDeg, pitchDeg, rollDeg;
    public final float[] translationMm = new float[3];
    /** x0, y0, x1, y1, … [px]. */
    public final float[] landmarks = new float[2 * LANDMARKS];

    private final ByteBuffer memory = ByteBuffer.allocateDirect(memorySize());
    private final float[] pose = new float[7];

    static {
        System.loadLibrary("posewise_jni");
    }

    public Tracker() {
        check(init(memory));
    }

    /**
     * Processes one frame; the result is in the fields. On Android, pass plane 0 of a YUV_420_888
     * image with its row stride, and its timestamp / 1000.
     *
     * @param luma direct buffer of 8-bit luma, read from its start
     * @param rotationDeg clockwise rotation that makes the image upright: 0, 90, 180, 270
     * @param timestampUs capture time [us]; must increase
     */
    public void step(ByteBuffer luma, int width, int height, int stride, int rotationDeg,
            boolean mirrored, long timestampUs) {
        if (!luma.isDirect()) {
            throw new IllegalArgumentException("luma is not a direct buffer");
        }
        state = check(step(memory, luma, width, height, stride, rotationDeg, mirrored, timestampUs,
                pose, landmarks));
        yawDeg = pose[0];
        pitchDeg = pose[1];
        rollDeg = pose[2];
        System.arraycopy(pose, 3, translationMm, 0, 3);
        confidence = pose[6];
    }

    /** Forgets the face, its identity and the last timestamp. */
    public void reset() {
        check(reset(memory));
    }

    private static int check(int status) {
        if (status < 0) {
            throw new IllegalArgumentException(strerror(status));
        }
        return status;
    }

    private static native int memorySize();

    private static native int init(ByteBuffer memory);

    private static native int step(ByteBuffer memory, ByteBuffer luma, int width, int height,
            int stride, int rotationDeg, boolean mirrored, long timestampUs, float[] pose,
            float[] landmarks);

    private static native int reset(ByteBuffer memory);

    private static native String strerror(int status);
}
