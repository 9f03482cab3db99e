// SPDX-License-Identifier: Apache-2.0
// What the page knows of one subsystem. There is one way back from every loss: hello, describe, subscriptions, events
// from the last number on.
import { Door, DoorState, Refusal } from "./door";
import type { Description, Event, Hello, Reading, Role, Status } from "./protocol";
import { variablesOf } from "./sequence";
import { Store } from "./store";
import { LiveValues } from "./values";

const STATUS_MS = 200, VALUES_MS = 100;
const SILENT_MS = 2000;  // without a status for this time, the manager hangs
const MOST_EVENTS = 2000;
const EVENTS_MS = 250;  // events of this time are drawn together: there may be hundreds in a second
const MOST_ELEMENTS = 16, MOST_VALUES = 600;

/** What a person is to know now: an act that was refused, or one whose answer was lost. */
export interface Message {
  text: string;
  remedy: string;
  /** Tasks that can be turned ON together instead. */
  tasks: string[];
  isError: boolean;
}

export interface MachineState {
  name: string;
  door: DoorState;
  doorSentence: string;
  hello: Hello | null;
  description: Description | null;
  /** The configuration whose tasks alone are drawn; "": all tasks. */
  drawn: string;
  version: number;
  status: Status | null;
  previous: Status | null;  // the status before, for loads
  events: Event[];
  gaps: number;             // events that no message brought
  message: Message | null;
  isBusy: boolean;
  /** The connection is open, but the manager says nothing. */
  isSilent: boolean;
}

const EMPTY: Omit<MachineState, "name"> = {
  door: "connecting", doorSentence: "", hello: null, description: null, drawn: "", version: 0, status: null,
  previous: null, events: [], gaps: 0, message: null, isBusy: false, isSilent: false,
};

const RANK: Record<Role, number> = { nothing: 0, observe: 1, operate: 2, configure: 3 };

/** Why a person with `role` may not do what needs `needed`; "" if they may. */
export function forbidden(role: Role | undefined, needed: Role): string {
  if (role === undefined) return "no connection to the subsystem";
  return RANK[role] >= RANK[needed] ? "" : `this needs the role '${needed}'; your role here is '${role}'`;
}

/** Number of elements of a variable; a shape that is not known before the run counts its greatest size. */
export function elements(shape: string): number {
  return [...shape.matchAll(/(?:<=|\[|x|,)\s*(\d+)(?=\s*[\]x,])/g)].reduce((product, m) => product * Number(m[1]), 1);
}

/** Longest period of a producer of each variable, in nanoseconds; those without a rate do not count. */
function periodsOf(description: Description): Map<string, number> {
  const periods = new Map<string, number>();
  for (const task of description.tasks)
    for (const port of task.ports)
      if (port.kind === "out-var" && task.rate_hz > 0)
        periods.set(port.variable, Math.max(periods.get(port.variable) ?? 0, 1e9 / task.rate_hz));
  return periods;
}

export class Machine {
  readonly state: Store<MachineState>;
  readonly values = new LiveValues();
  private door: Door;
  private run = "";  // start of the run whose events are kept
  private fresh: Event[] = [];
  private lost = 0;
  private timer = 0;  // of the next drawing of events; 0: none waits
  private heardAt = 0;
  private watch = window.setInterval(() => this.listen(), 500);

  constructor(readonly name: string, key: string) {
    this.state = new Store<MachineState>({ ...EMPTY, name });
    this.door = new Door(`/machine/${encodeURIComponent(name)}`, key, {
      opened: (door) => void this.begin(door),
      changed: (door, doorSentence) => this.state.set({ door, doorSentence }),
      note: (method, parameters) => this.take(method, parameters),
    });
  }

  close(): void {
    window.clearTimeout(this.timer);
    window.clearInterval(this.watch);
    this.door.close();
  }

  retry(): void {
    this.door.retry();
  }

  /** Asks without a change of the machine; null if it was refused or lost, which is then said. */
  async ask(method: string, params: object = {}): Promise<any> {
    try {
      return await this.door.call(method, params);
    } catch (why) {
      this.tell(why);
      return null;
    }
  }

  /** Asks what another version may not know: nothing is said of a refusal. */
  find(method: string): Promise<any> {
    return this.door.call(method).catch(() => null);
  }

  /** The same for an act. */
  async act(method: string, params: object): Promise<any> {
    this.state.set({ isBusy: true, message: null });
    const answer = await this.ask(method, params);
    this.state.set({ isBusy: false });
    return answer;
  }

  say(text: string): void {
    this.state.set({ message: { text, remedy: "", tasks: [], isError: false } });
  }

  dismiss(): void {
    this.state.set({ message: null });
  }

  async draw(configuration: string): Promise<void> {
    const parameters = configuration === "" ? { picture: true } : { picture: true, configuration };
    const description: Description | null = await this.ask("describe", parameters);
    if (description) this.state.set({ description, drawn: configuration, version: this.state.get().version + 1 });
  }

  private tell(why: unknown): void {
    const { message, data } = why instanceof Refusal ? why.error
      : { message: `${(why as Error).message}; the act may have been carried out: see Events`, data: undefined };
    this.state.set({ message: { text: message, remedy: data?.remedy ?? "", tasks: data?.tasks ?? [], isError: true } });
  }

  private async begin(door: Door): Promise<void> {
    try {
      const hello: Hello = await door.call("hello");
      const status: Status = await door.call("status");
      const run = `${hello.keeper_pid} ${status.origin_ns}`;
      if (this.timer !== 0) this.showEvents();
      if (run !== this.run) this.state.set({ events: [], gaps: 0, drawn: "", message: null });
      this.run = run;
      const { drawn } = this.state.get();
      const parameters = drawn === "" ? { picture: true } : { picture: true, configuration: drawn };
      const description: Description = await door.call("describe", parameters);
      this.heardAt = performance.now();
      this.values.setPeriods(periodsOf(description));
      this.state.set({ hello, description, status, previous: null, version: this.state.get().version + 1 });
      await door.call("subscribe", { to: "status", period_ms: STATUS_MS });
      const small = description.variables
        .filter((v) => !v.constant && elements(v.shape) <= MOST_ELEMENTS).map((v) => v.variable);
      const variables = [...new Set([...variablesOf(description.sequence), ...small])].slice(0, MOST_VALUES);
      if (variables.length > 0) await door.call("subscribe", { to: "values", period_ms: VALUES_MS, variables });
      const known = this.state.get().events;
      await door.call("subscribe", { to: "events", since: known.length > 0 ? known[known.length - 1]!.number + 1 : 1 });
    } catch (why) {
      if (why instanceof Refusal) this.tell(why);  // a connection that was lost begins again by itself
    }
  }

  private take(method: string, parameters: any): void {
    this.heardAt = performance.now();
    if (method === "status") {
      this.state.set({ previous: this.state.get().status, status: parameters as Status });
    } else if (method === "values") {
      this.values.take(parameters.values as Record<string, Reading>);
    } else if (method === "events") {
      this.takeEvents(parameters.events as Event[], parameters.lost as number);
    }
  }

  private listen(): void {
    const { door, status, isSilent } = this.state.get();
    const isSilentNow = door === "open" && status !== null && performance.now() - this.heardAt > SILENT_MS;
    if (isSilentNow !== isSilent) this.state.set({ isSilent: isSilentNow });
  }

  private takeEvents(events: Event[], lost: number): void {
    this.fresh.push(...events);
    this.lost += lost;
    if (this.timer === 0) this.timer = window.setTimeout(() => this.showEvents(), EVENTS_MS);
  }

  private showEvents(): void {
    const { events: known, gaps } = this.state.get();
    const last = known.length > 0 ? known[known.length - 1]!.number : 0;
    const fresh = this.fresh.filter((event) => event.number > last);
    this.state.set({ events: [...known, ...fresh].slice(-MOST_EVENTS), gaps: gaps + (last > 0 ? this.lost : 0) });
    [this.fresh, this.lost, this.timer] = [[], 0, 0];
  }
}
