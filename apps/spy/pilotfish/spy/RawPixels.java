package pilotfish.spy;

import bot_core.image_t;
import java.awt.image.BufferedImage;
import java.awt.image.DataBufferInt;

/** The pixels of a raw picture: gray, RGB or BGR of 8 bits, with a row stride. */
final class RawPixels {
    private final byte[] data;
    private final int offset;
    private final int width;
    private final int height;
    private final int stride;
    private final int channels;
    /** Where red, green and blue are in a pixel. */
    private final int[] order;

    /** data: a message whose pixels are the `size` bytes from `offset`. */
    RawPixels(byte[] data, int offset, int size, int width, int height, int stride, int format) throws RefusedPicture {
        this.data = data;
        this.offset = offset;
        this.width = width;
        this.height = height;
        this.stride = stride;
        switch (format) {
            case image_t.PIXEL_FORMAT_GRAY: order = new int[] {0, 0, 0}; break;
            case image_t.PIXEL_FORMAT_RGB: order = new int[] {0, 1, 2}; break;
            case image_t.PIXEL_FORMAT_BGR: order = new int[] {2, 1, 0}; break;
            default: throw new RefusedPicture("pixel format " + fourcc(format) + " is none of GREY, RGB3, BGR3, MJPG");
        }
        channels = format == image_t.PIXEL_FORMAT_GRAY ? 1 : 3;
        long row = (long) width * channels;
        if (stride < row) throw new RefusedPicture("its row stride of " + stride + " bytes is shorter than a row");
        long needed = (long) stride * (height - 1) + row;
        if (size < needed) throw new RefusedPicture("it has " + size + " bytes where its size needs " + needed);
    }

    /** Every step-th pixel of every step-th row. */
    BufferedImage decode(int step) {
        int columns = -Math.floorDiv(-width, step), rows = -Math.floorDiv(-height, step);
        BufferedImage image = new BufferedImage(columns, rows, BufferedImage.TYPE_INT_RGB);
        int[] out = ((DataBufferInt) image.getRaster().getDataBuffer()).getData();
        int red = order[0], green = order[1], blue = order[2];
        for (int y = 0, to = 0; y < rows; y++) {
            int from = offset + y * step * stride;
            for (int x = 0; x < columns; x++, from += step * channels) {
                out[to++] = (data[from + red] & 255) << 16 | (data[from + green] & 255) << 8 | data[from + blue] & 255;
            }
        }
        return image;
    }

    /** "YUYV" of its number; the number, where it has no letters. */
    private static String fourcc(int format) {
        StringBuilder letters = new StringBuilder();
        for (int shift = 0; shift < 32; shift += 8) {
            int letter = format >> shift & 255;
            if (letter < 32 || letter > 126) return Integer.toString(format);
            letters.append((char) letter);
        }
        return letters.toString();
    }
}
