// SPDX-License-Identifier: Apache-2.0
// One WebSocket to one server of the control protocol (docs/formats/web.md). It connects again by itself; a call whose
// answer is lost is rejected, because an act must not be sent twice.
import type { RpcError } from "./protocol";

export type DoorState = "connecting" | "open" | "lost" | "gone" | "refused";

/** Close codes of docs/formats/web.md. */
export const CLOSE = { oldLink: 4401, notRunning: 4404, silent: 4408, full: 4429, ended: 4502 } as const;

/** Time between two tries to connect, in milliseconds: short at first, because a manager is back within a second. */
const RETRY_MS = [50, 100, 200, 400, 800, 1000];
/** A connection that was open for this time was a good one: the next tries begin at the shortest time again. */
const STEADY_MS = 2000;

export class Refusal extends Error {
  constructor(readonly error: RpcError) { super(error.message); }
}

/** The connection was lost before the answer came: the request may have been carried out. */
export class Lost extends Error {}

interface Call { resolve: (result: any) => void; reject: (why: Error) => void }

export interface DoorEvents {
  /** A new connection, before any other call: asks for all that a page needs to go on. */
  opened: (door: Door) => void;
  changed: (state: DoorState, sentence: string) => void;
  note: (method: string, parameters: any) => void;
}

export class Door {
  state: DoorState = "connecting";
  private socket: WebSocket | null = null;
  private calls = new Map<number, Call>();
  private lastId = 0;
  private failures = 0;
  private openSince = 0;
  private timer = 0;
  private isClosed = false;

  constructor(readonly path: string, private readonly key: string, private readonly events: DoorEvents) {
    this.connect();
  }

  call(method: string, params: object = {}): Promise<any> {
    const socket = this.socket;
    if (socket?.readyState !== WebSocket.OPEN) return Promise.reject(new Lost("there is no connection"));
    const id = ++this.lastId;
    socket.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
    return new Promise((resolve, reject) => this.calls.set(id, { resolve, reject }));
  }

  /** Tries again at once. */
  retry(): void {
    if (this.isClosed || (this.socket?.readyState ?? WebSocket.CLOSED) < WebSocket.CLOSING) return;
    window.clearTimeout(this.timer);
    this.connect();
  }

  close(): void {
    this.isClosed = true;
    window.clearTimeout(this.timer);
    this.socket?.close(1000);
    this.fail("the page closed it");
  }

  private connect(): void {
    if (this.key === "") return this.set("refused", "this link has no key: open the one that `chimera web` prints");
    const socket = new WebSocket(`ws://${location.host}${this.path}`);
    this.socket = socket;
    socket.onopen = () => {
      if (this.socket !== socket || this.isClosed) return;
      socket.send(this.key);
      this.events.opened(this);
    };
    socket.onmessage = (message) => { if (this.socket === socket) this.take(String(message.data)); };
    socket.onclose = (event) => { if (this.socket === socket) this.lose(event.code, event.reason); };
  }

  private take(line: string): void {
    const message = JSON.parse(line);
    if (this.state !== "open") {  // not before: the key may be old, the subsystem not there
      this.openSince = performance.now();
      this.set("open", "");
    }
    if (message.method !== undefined) return this.events.note(message.method, message.params);
    const call = this.calls.get(message.id);
    if (!call) return;
    this.calls.delete(message.id);
    if (message.error) call.reject(new Refusal(message.error));
    else call.resolve(message.result);
  }

  private lose(code: number, reason: string): void {
    if (this.isClosed) return;
    this.fail("the connection was lost before the answer came");
    if (this.state === "open" && performance.now() - this.openSince > STEADY_MS) this.failures = 0;
    if (code === CLOSE.oldLink) return this.set("refused", reason);
    this.set(code === CLOSE.notRunning ? "gone" : "lost", reason);
    const wait = RETRY_MS[Math.min(this.failures++, RETRY_MS.length - 1)] ?? 1000;
    this.timer = window.setTimeout(() => this.connect(), code === CLOSE.full ? 5000 : wait);
  }

  private fail(why: string): void {
    const calls = [...this.calls.values()];
    this.calls.clear();
    for (const call of calls) call.reject(new Lost(why));
  }

  private set(state: DoorState, sentence: string): void {
    this.state = state;
    this.events.changed(state, sentence);
  }
}
