// The WebSocket: reconnects, acknowledges, and knows how old a message was when it came.
//
// Server and page have different clocks. The least (arrival here - sending there) of this connection is the difference of
// the clocks and the shortest way; what a message took beyond it is added to the ages in it.

const RETRY_MS = [200, 400, 800, 1500, 2000];
const SILENT_MS = 2500; // the server sends twice a second at least
const NO_SUCH_ROBOT = 4404;

export class Connection {
  constructor(robot, handlers) {
    this.robot = robot;
    this.handlers = handlers;
    this.tries = 0;
    this.stops = []; // who waits for the outcome of a STOP
    this.open();
    setInterval(() => this.watch(), 500);
  }

  open() {
    this.leastMs = Infinity;
    this.heardMs = performance.now();
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(`${scheme}//${location.host}/ws?robot=${encodeURIComponent(this.robot)}`);
    socket.binaryType = "arraybuffer";
    socket.onmessage = (event) => this.receive(socket, event.data);
    socket.onclose = (event) => this.closed(socket, event.code);
    this.socket = socket;
  }

  // Asks for STOP on the connection that is open: under load a new one may take long. Its outcome, as the server says it.
  stop(token) {
    if (this.socket?.readyState !== WebSocket.OPEN) return Promise.resolve(null);
    this.socket.send(JSON.stringify({ stop: token }));
    return new Promise((resolve) => this.stops.push(resolve));
  }

  tell(outcome) {
    for (const resolve of this.stops.splice(0)) resolve(outcome);
  }

  watch() {
    if (this.socket && performance.now() - this.heardMs > SILENT_MS) this.closed(this.socket, 0);
  }

  closed(socket, code) {
    if (socket !== this.socket) return;
    this.socket = null;
    socket.onclose = null;
    socket.close();
    this.tell(null);
    this.handlers.onLost(code === NO_SUCH_ROBOT ? "no robot heard on the bus yet" : null);
    setTimeout(() => this.open(), RETRY_MS[Math.min(this.tries++, RETRY_MS.length - 1)]);
  }

  receive(socket, data) {
    if (socket !== this.socket) return;
    this.heardMs = performance.now();
    const acknowledge = (kind) => socket.readyState === WebSocket.OPEN && socket.send(kind);
    if (data instanceof ArrayBuffer) {
      const length = new DataView(data).getUint32(0);
      const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
      const jpeg = new Blob([new Uint8Array(data, 4 + length)], { type: "image/jpeg" });
      header.ageThenS = header.age_s;
      header.receivedMs = this.heardMs;
      this.handlers.onPicture(header, jpeg).finally(() => acknowledge("picture"));
      return;
    }
    const message = JSON.parse(data);
    if (message.kind === "hello") {
      this.tries = 0;
      this.handlers.onHello(message);
      return;
    }
    if (message.kind === "outcome") {
      this.tell(message);
      return;
    }
    const tookMs = this.heardMs - message.sent_s * 1e3;
    this.leastMs = Math.min(this.leastMs, tookMs);
    message.receivedMs = this.heardMs;
    message.delayS = (tookMs - this.leastMs) / 1e3;
    message.serverS = () => message.sent_s + message.delayS + (performance.now() - message.receivedMs) / 1e3;
    message.age = (kind) => {
      const then = message.ages_s[kind];
      return then === undefined ? Infinity : then + message.delayS + (performance.now() - message.receivedMs) / 1e3;
    };
    this.handlers.onState(message);
    acknowledge("state");
  }
}
