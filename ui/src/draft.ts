// SPDX-License-Identifier: Apache-2.0
// What the page knows of the draft. There is one way back from every loss: the whole draft, then its subscription.
// Acts go one after the other, each on the version that the page shows.
import { Door, Refusal } from "./door";
import { History, Step, stepped } from "./history";
import { withLessons } from "./lesson_values";
import type { DraftAnswer, DraftNews, EditAct, LibraryComponent, Offer, Outline, Picture } from "./protocol";
import { Store } from "./store";

export interface DraftState extends History {
  /** null: not known yet, or chimera-web has no FILE. */
  draft: DraftAnswer | null;
  /** Those of the last text that was a tree. */
  picture: Picture | null;
  outline: Outline | null;
  offers: Offer[];
  library: LibraryComponent[];
  /** Text of the machine that runs FILE; null: none does. */
  running: string | null;
  /** Places where the draft differs from FILE and from `running`; null: not known. */
  fromFile: string[] | null;
  fromMachine: string[] | null;
  message: { text: string; isError: boolean } | null;
  output: { pid: number; ended: string | null; text: string } | null;
}

const EMPTY: DraftState = {
  draft: null, picture: null, outline: null, offers: [], library: [], running: null, fromFile: null, fromMachine: null,
  message: null, output: null, past: [], future: [],
};

const OUTPUT_MS = 500;
export const OFFERS_MS = 200;  // acts and typed letters that follow each other need no offers in between

/** What a person reads of a refused act. */
export function sentenceOf(why: unknown): string {
  if (!(why instanceof Refusal)) return `${(why as Error).message}; the act may have been carried out`;
  const { message, data } = why.error;
  const where = data?.where && !message.includes(data.where) ? `${data.where}: ` : "";
  return `${where}${message}${data?.remedy ? `; ${data.remedy}` : ""}`;
}

/** The lamps: is the draft that of FILE, and that of the machine that runs FILE? Other comments do not count there. */
export function lamps({ draft, running, fromMachine }: DraftState):
  { file: "same" | "differs" | "outside"; machine: "same" | "differs" | "none" } {
  const isSame = running === draft?.analysis.text || fromMachine?.length === 0;
  return {
    file: draft?.outside ? "outside" : draft?.touched ? "differs" : "same",
    machine: running === null ? "none" : isSame ? "same" : "differs",
  };
}

/** The names in paths that differ: "tasks/pid" and "operator/kp" as "pid" and "kp". */
export const namesOf = (paths: string[]): string[] => [...new Set(paths.map((path) => path.split("/").pop() ?? path))];

export class Draft {
  readonly state = new Store<DraftState>(EMPTY);
  private door: Door | null = null;
  private turn: Promise<unknown> = Promise.resolve();
  private offering = 0;  // timer

  async begin(door: Door): Promise<void> {
    this.door = door;
    try {
      await this.inTurn(async () => this.take(await door.call("draft"), "act"));  // acts wait for the version
      await door.call("subscribe", { to: "draft" });
      const library = await door.call("library").catch(() => null);
      if (library) this.state.set({ library: library.components });
      const output = await door.call("output").catch(() => null);
      if (output?.pid && output.ended === null) void this.watch(output);
    } catch (why) {
      if (why instanceof Refusal) this.say(sentenceOf(why), true);  // a lost connection begins again by itself
    }
  }

  /** News that an own act made are known already when its answer comes. */
  note(news: DraftNews): void {
    void this.inTurn(async () => {
      const { draft } = this.state.get();
      if (!draft || news.version > draft.version) return this.follow();
      if (news.version === draft.version) {
        this.state.set({ draft: { ...draft, ...news } });
        this.compare();
      }
    });
  }

  /** Carries acts out; the sentence of a refusal, or "". */
  edit = (acts: EditAct[]): Promise<string> => (
    acts.length === 0 ? Promise.resolve("") : this.change("edit", () => ({ acts })));

  /** The text was typed over that of the version `base`. */
  replace = (text: string, base: number): Promise<string> => 
    this.change("replace", () => ({ text, version: base }));

  /** Until all that was begun is done: the first answer of the draft, then each act. */
  settled = (): Promise<void> => this.inTurn(async () => undefined);

  /** An act of a button: its refusal is said above the picture. */
  press = async (acts: EditAct[]): Promise<void> => {
    this.report(await this.edit(acts));
  };

  async undo(step: "undo" | "redo"): Promise<void> {
    this.report(await this.change("replace", () => {
      const { past, future } = this.state.get();
      const text = step === "undo" ? past[past.length - 1] : future[0];
      return text === undefined ? null : { text };
    }, step));
  }

  write(): void {
    void this.inTurn(async () => {
      const version = this.state.get().draft?.version;
      const answer = await this.ask("write", { version });
      if (answer) this.say(answer.changed ? `Saved ${answer.file}.` : `${answer.file} holds this text already.`);
    });
  }

  async keep(what: "draft" | "file"): Promise<void> {
    this.report(await this.change("keep", () => ({ what })));
  }

  async start(): Promise<void> {
    const answer = await this.ask("start", {});
    if (!answer) return;
    this.state.set({ message: null });
    void this.watch({ pid: answer.pid, ended: null, text: "" });
  }

  /** Reads what the started run prints, until it ends or the connection is lost. */
  private async watch(output: DraftState["output"]): Promise<void> {
    this.state.set({ output });
    while (this.state.get().output?.ended === null) {
      await new Promise((resolve) => window.setTimeout(resolve, OUTPUT_MS));
      const latest = await this.door?.call("output").catch(() => null);
      if (!latest) return;
      this.state.set({ output: latest });
    }
  }

  /** The text of the machine that runs FILE; null: none does. */
  runs(text: string | null): void {
    if (text === this.state.get().running) return;
    this.state.set({ running: text });
    this.compare();
  }

  say(text: string, isError = false): void {
    this.state.set({ message: { text, isError } });
  }

  dismiss(): void {
    this.state.set({ message: null });
  }

  private inTurn<T>(act: () => Promise<T>): Promise<T> {
    const next = this.turn.then(act);
    this.turn = next.catch(() => undefined);
    return next;
  }

  private async ask(method: string, parameters: object): Promise<any> {
    try {
      return await this.call(method, parameters);
    } catch (why) {
      this.say(sentenceOf(why), true);
      return null;
    }
  }

  private call(method: string, parameters: object): Promise<any> {
    return this.door ? this.door.call(method, parameters) : Promise.reject(new Error("there is no connection"));
  }

  private report(sentence: string): void {
    if (sentence !== "") this.say(sentence, true);
  }

  /** `make`: the parameters when its turn comes; null: nothing is to be done any more. */
  private change(method: string, make: () => object | null, step: Step = "act"): Promise<string> {
    return this.inTurn(async () => {
      const parameters = make();
      if (parameters === null) return "";
      this.state.set({ message: null });
      try {
        const version = method === "keep" ? {} : { version: this.state.get().draft?.version };
        this.take(await this.call(method, { ...version, ...parameters }), step);
        return "";
      } catch (why) {
        if (!(why instanceof Refusal) || why.error.data?.kind !== "stale") return sentenceOf(why);
        await this.follow();
        return "The draft was changed in another window before this act came: it was not carried out. Look at the " +
          "draft, then repeat the act if it still fits.";
      }
    });
  }

  private async follow(): Promise<void> {
    const answer = await this.door?.call("draft").catch(() => null);
    if (answer) this.take(answer, "act");
  }

  private take(answer: DraftAnswer, step: Step): void {
    const { draft, picture, outline, past, future } = this.state.get();
    const { analysis } = answer;
    const isBlank = analysis.text.trim() === "";
    const before = draft?.analysis.text ?? analysis.text;
    this.state.set({
      draft: answer, offers: [],
      picture: analysis.picture ?? (isBlank ? null : picture), outline: analysis.outline ?? (isBlank ? null : outline),
      ...stepped({ past, future }, step, before, analysis.text),
    });
    this.compare();
    window.clearTimeout(this.offering);
    if (analysis.report.faults.length > 0)
      this.offering = window.setTimeout(() => void this.offer(answer.version), OFFERS_MS);
  }

  private async offer(version: number): Promise<void> {
    const answer = await this.door?.call("remedies", { version }).catch(() => null);  // stale: the next version asks
    const { draft, outline } = this.state.get();
    if (!answer || !draft || draft.version !== version) return;
    const offers = await withLessons(answer.offers, draft.analysis.report.faults, outline, (port) =>
      this.call("values", port).then(({ values }) => values, () => []));
    if (this.state.get().draft?.version === version) this.state.set({ offers });
  }

  /** Asks where the draft differs from FILE and from what runs. */
  private compare(): void {
    const { draft, running } = this.state.get();
    if (!draft) return;
    const differences = async (parameters: object, take: (paths: string[] | null) => void) => {
      const answer = await this.door?.call("differences", parameters).catch(() => null);  // no tree, or no FILE
      if (this.state.get().draft?.version === draft.version) take(answer?.paths ?? null);
    };
    if (draft.touched) void differences({}, (fromFile) => this.state.set({ fromFile }));
    if (running !== null && running !== draft.analysis.text)
      void differences({ text: running }, (fromMachine) => this.state.set({ fromMachine }));
  }
}

export const draft = new Draft();
