import dev.posewise.Tracker;

import java.io.DataInputStream;
import java.io.EOFException;
import java.io.FileInputStream;
import java.io.IOException;
import java.nio.ByteBuffer;

/** Tracks raw grey frames: {@code TrackFile FILE WIDTH HEIGHT FRAME_US}; one line per frame. */
public final class TrackFile {
    public static void main(String[] arguments) throws IOException {
        int width = Integer.parseInt(arguments[1]);
        int height = Integer.parseInt(arguments[2]);
        double frameUs = Double.parseDouble(arguments[3]);
        byte[] pixels = new byte[width * height];
        ByteBuffer luma = ByteBuffer.allocateDirect(pixels.length);
        Tracker tracker = new Tracker();
        try (DataInputStream in = new DataInputStream(new FileInputStream(arguments[0]))) {
            for (int i = 0;; i++) {
                in.readFully(pixels);
                luma.clear();
                luma.put(pixels);
                tracker.step(luma, width, height, width, 0, false, (long) (i * frameUs));
                System.out.println(i + " " + tracker.state + " " + tracker.yawDeg + " "
                        + tracker.pitchDeg + " " + tracker.rollDeg + " " + tracker.landmarks[60]
                        + " " + tracker.landmarks[61]);
            }
        } catch (EOFException end) {
            // End of the file.
        }
        try {
            tracker.step(luma, width + 1, height, width, 0, false, Long.MAX_VALUE);
            throw new AssertionError("a stride shorter than a row was accepted");
        } catch (IllegalArgumentException expected) {
            System.err.println(expected.getMessage());
        }
    }
}
