package pilotfish.spy;

import java.awt.image.BufferedImage;
import java.io.ByteArrayInputStream;
import java.io.IOException;
import java.util.concurrent.atomic.AtomicReference;
import javax.imageio.IIOException;
import javax.imageio.ImageIO;
import javax.imageio.ImageReadParam;
import javax.imageio.ImageReader;
import javax.imageio.stream.MemoryCacheImageInputStream;

/**
 * The pixels of a JPEG. One that says another size than its message, or is damaged, is refused as the coordinator
 * does.
 */
final class JpegPixels {
    private JpegPixels() {}

    /** Of the `size` bytes from `offset`; every step-th pixel of every step-th row. */
    static BufferedImage decode(byte[] data, int offset, int size, int width, int height, int step)
            throws RefusedPicture {
        ImageReader reader = ImageIO.getImageReadersByFormatName("jpeg").next();
        AtomicReference<String> warning = new AtomicReference<>();
        try (MemoryCacheImageInputStream in =
                new MemoryCacheImageInputStream(new ByteArrayInputStream(data, offset, size))) {
            reader.setInput(in, true, true);
            reader.addIIOReadWarningListener((source, text) -> warning.compareAndSet(null, text));
            int actualWidth = reader.getWidth(0), actualHeight = reader.getHeight(0);
            if (actualWidth != width || actualHeight != height) {
                throw new RefusedPicture("its JPEG is " + actualWidth + " x " + actualHeight + " px, its message says "
                        + width + " x " + height);
            }
            ImageReadParam every = reader.getDefaultReadParam();
            every.setSourceSubsampling(step, step, 0, 0);
            BufferedImage image = reader.read(0, every);
            if (warning.get() != null) throw new RefusedPicture("a damaged JPEG: " + warning.get());
            return image;
        } catch (IIOException problem) {
            throw new RefusedPicture("a JPEG that cannot be read: " + problem.getMessage());
        } catch (IOException | RuntimeException problem) {  // Java's reader throws whatever damaged bytes lead to
            throw new RefusedPicture("a JPEG that cannot be read: " + problem);
        } finally {
            reader.dispose();
        }
    }
}
