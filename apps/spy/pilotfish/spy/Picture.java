package pilotfish.spy;

import java.awt.image.BufferedImage;

/** A decoded picture. What is shown may be smaller than the camera's picture, which the corners of tags refer to. */
final class Picture {
    /** Of the exposure [us]. */
    final long utime;
    final BufferedImage image;
    /** Of the camera's picture [px]. */
    final int sourceWidth;
    final int sourceHeight;

    Picture(long utime, BufferedImage image, int sourceWidth, int sourceHeight) {
        this.utime = utime;
        this.image = image;
        this.sourceWidth = sourceWidth;
        this.sourceHeight = sourceHeight;
    }
}
