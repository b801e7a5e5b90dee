// Connection to the server: messages both ways, and again after an interruption.

/** @import { Message } from "./types.d.ts" */

/** Pauses between attempts to connect [ms]. */
const PAUSES = [300, 1000, 3000];

export class Link {
  /** @param {(message: Message) => void} receive @param {(connected: boolean) => void} onState */
  constructor(receive, onState) {
    this.receive = receive;
    this.onState = onState;
    this.attempts = 0;
    this.stopped = false;
    /** Whether a program answers that does not know the address of this page. */
    this.outdated = false;
    /** Whether nothing answers at the address. */
    this.ended = false;
    /** @type {WebSocket | null} */
    this.socket = null;
    this.connect();
  }

  connect() {
    const address = new URL("socket", location.href);
    address.protocol = "ws:";
    const socket = new WebSocket(address);
    socket.addEventListener("open", () => {
      this.attempts = 0;
      this.ended = false;
      this.onState(true);
    });
    socket.addEventListener("message", ({ data }) => this.receive(JSON.parse(data)));
    socket.addEventListener("close", () => {
      this.onState(false);
      if (!this.stopped) setTimeout(() => this.connect(), PAUSES[Math.min(this.attempts++, PAUSES.length - 1)]);
      if (this.attempts > 1) void this.checkAddress();
    });
    this.socket = socket;
  }

  /** End the attempts if the program was started again under another address; note if nothing answers. */
  async checkAddress() {
    const reply = await fetch(location.href, { method: "HEAD", cache: "no-store" }).catch(() => null);
    if (reply?.ok || this.stopped || this.connected) return;
    this.ended = !reply;
    this.stopped = this.outdated = Boolean(reply);
    this.onState(false);
  }

  get connected() { return this.socket?.readyState === WebSocket.OPEN; }

  /** Send a request; returns whether it was sent. @param {Record<string, unknown>} request */
  send(request) {
    if (!this.socket || !this.connected) return false;
    this.socket.send(JSON.stringify(request));
    return true;
  }
}
