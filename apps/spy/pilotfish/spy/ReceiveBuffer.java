package pilotfish.spy;

import java.lang.reflect.Field;
import java.net.DatagramSocket;
import lcm.lcm.LCM;
import lcm.lcm.UDPMulticastProvider;

/**
 * The kernel's buffer for datagrams that LCM has not yet read. Java's LCM leaves it at the kernel's default (208 kB),
 * which a raw picture of 640 x 480 px exceeds: of 30 such pictures a second 6 to 21 arrived. LCM has no setting for
 * it, so its socket is looked up by the name that it has in LCM 1.3.1 to 1.5.3; where that fails, pictures are lost
 * as before.
 */
final class ReceiveBuffer {
    private static final int BYTES = 4 << 20;  // the kernel grants no more than net.core.rmem_max

    private ReceiveBuffer() {}

    static void enlarge(LCM lcm) {
        try {
            for (Object provider : (Iterable<?>) fieldOf(LCM.class, "providers", lcm)) {
                if (!(provider instanceof UDPMulticastProvider)) continue;
                ((DatagramSocket) fieldOf(UDPMulticastProvider.class, "sock", provider)).setReceiveBufferSize(BYTES);
            }
        } catch (ReflectiveOperationException | java.net.SocketException | RuntimeException notThere) {
            System.err.println("pilotfish: the receive buffer stays small, large pictures may be lost: " + notThere);
        }
    }

    private static Object fieldOf(Class<?> type, String name, Object from) throws ReflectiveOperationException {
        Field field = type.getDeclaredField(name);
        field.setAccessible(true);
        return field.get(from);
    }
}
