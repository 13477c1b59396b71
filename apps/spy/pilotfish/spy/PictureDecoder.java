package pilotfish.spy;

import bot_core.image_t;
import java.nio.ByteBuffer;
import java.nio.charset.StandardCharsets;

/**
 * A bot_core.image_t as it came from the bus, decoded. Every size in it is compared with what is there before memory is
 * taken for it: the type's generated decoder takes what the message asks for.
 */
final class PictureDecoder {
    static final int MAX_SIDE_PX = 8192;
    /** Of what is shown: beyond it pixels are left out, because no screen has them and memory is short. */
    static final int MAX_SHOWN_PX = 1920;

    /** Fingerprint and utime of 8 bytes; width, height, row_stride, pixelformat and size of 4. */
    private static final int HEAD_BYTES = 2 * 8 + 5 * 4;
    /** The extra of a preview: so many times smaller than the camera's picture on each side. */
    private static final String SHRINK = "pilotfish_shrink";
    private static final int MAX_SHRINK = 1000;

    private PictureDecoder() {}

    /** When the picture was taken [us]; 0 for what is no image. */
    static long utimeOf(byte[] message) {
        return message.length < HEAD_BYTES ? 0 : ByteBuffer.wrap(message).getLong(8);
    }

    /** The picture, in at most MAX_SHOWN_PX on each side. */
    static Picture decode(byte[] message) throws RefusedPicture {
        ByteBuffer in = ByteBuffer.wrap(message);
        if (message.length < HEAD_BYTES) throw new RefusedPicture("an image message of " + message.length + " bytes");
        if (in.getLong() != image_t.LCM_FINGERPRINT) throw new RefusedPicture("a message of another type or version");
        long utime = in.getLong();
        int width = in.getInt(), height = in.getInt(), stride = in.getInt(), format = in.getInt(), size = in.getInt();
        if (width < 1 || height < 1 || width > MAX_SIDE_PX || height > MAX_SIDE_PX) {
            throw new RefusedPicture("a picture of " + width + " x " + height + " px");
        }
        if (size < 0 || size > in.remaining()) {
            throw new RefusedPicture("it is cut short: " + in.remaining() + " of " + size + " bytes");
        }
        int step = -Math.floorDiv(-Math.max(width, height), MAX_SHOWN_PX);
        if (format == image_t.PIXEL_FORMAT_MJPEG) {
            int shrink = shrinkOf(in, in.position() + size);
            return new Picture(utime, JpegPixels.decode(message, HEAD_BYTES, size, width, height, step),
                    width * shrink, height * shrink);
        }
        RawPixels raw = new RawPixels(message, HEAD_BYTES, size, width, height, stride, format);
        return new Picture(utime, raw.decode(step), width, height);
    }

    /** 1 unless the extras behind the bytes of the picture say otherwise. */
    private static int shrinkOf(ByteBuffer in, int at) {
        try {
            in.position(at);
            for (int left = in.getInt(); left > 0; left--) {
                String key = text(in, in.getInt());
                String value = text(in, in.getInt());
                if (!key.equals(SHRINK) || !value.matches("[0-9]{1,4}")) continue;
                int shrink = Integer.parseInt(value);
                if (shrink >= 1 && shrink <= MAX_SHRINK) return shrink;
            }
        } catch (RuntimeException cutShort) {  // BufferUnderflowException and what negative sizes lead to
            return 1;
        }
        return 1;
    }

    private static String text(ByteBuffer in, int size) {
        if (size < 0 || size > in.remaining()) throw new IllegalArgumentException();
        byte[] bytes = new byte[size];
        in.get(bytes);
        return new String(bytes, StandardCharsets.US_ASCII).replace("\0", "");
    }
}
