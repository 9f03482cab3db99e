// SPDX-License-Identifier: Apache-2.0
// The objects of docs/formats/control.md and docs/formats/web.md, as far as the page reads them.

export type Role = "nothing" | "observe" | "operate" | "configure";
export type State = "NOT-CREATED" | "OFF" | "ON" | "ERROR";

export interface Hello {
  program: string;
  subsystem: string;
  role: Role;
  file: string;
  folder: string;
  keeper_pid: number;
  manager: { pid: number; starts: number };
}

export interface BenchHello {
  program: string;
  role: Role;
  user: string;
  host: string;
  file: string | null;
  folder: string;
  pid: number;
}

export interface MachineName {
  name: string;
  service: boolean;
}

export interface Port {
  port: string;
  kind: "in-var" | "out-var" | "in-const" | "out-const" | "resource";
  variable: string;
  type: string;
  unit: string;
  shape: string;
}

export interface DescribedTask {
  task: string;
  component: string;
  doc: string;
  rtpu: string;
  rate_hz: number;
  hardware: boolean;
  standby_for: string;
  ports: Port[];
}

export interface Variable {
  variable: string;
  constant: boolean;
  given: boolean;
  operator?: boolean;
  least?: number | null;
  most?: number | null;
  type: string;
  unit: string;
  shape: string;
  producers: { task: string; port: string }[];
  consumers: { task: string; port: string }[];
}

export interface PictureBox { task: string; x: number; y: number; width: number; height: number }
export interface PicturePort {
  task: string; port: string; kind: Port["kind"]; variable: string | null; x: number; y: number;
}
export interface PictureLine {
  variable: string; x1: number; y1: number; x2: number; y2: number; arrow: "" | "end" | "start" | "both";
}
export interface PictureDot { variable: string; x: number; y: number }
export interface PictureLabel {
  text: string; x: number; y: number;
  style: "title" | "name" | "soft" | "port" | "given";
  anchor: "start" | "middle" | "end";
  task: string | null;
  variable: string | null;
}
/** The layout of docs/formats/web.md, "The picture"; lengths in pixels. */
export interface Picture {
  title: string; width: number; height: number;
  boxes: PictureBox[]; ports: PicturePort[]; lines: PictureLine[]; dots: PictureDot[]; labels: PictureLabel[];
}

/** A step of a sequence: the words that the text gives; null: it gives none. Times and conditions are not read. */
export interface Step {
  number: number; name: string | null; switch: string | null; until: string | null; for: string | null;
  within: string | null; else: string | null; confirm: boolean; reentry: boolean;
}
export interface Sequence { line: number; path: "sequence" | "sequence/steps"; repeat: boolean; steps: Step[] }

export interface Description {
  tasks: DescribedTask[];
  variables: Variable[];
  configurations: { name: string; tasks: string[] }[];
  start: string;
  picture?: Picture;
  sequence?: Sequence | null;
}

export interface RtpuStatus {
  name: string; cpu: number; policy: string; executor: string; pid: number; alive: boolean; phase: string;
  hang: string | null; restarts: number; last_end: string | null; given_up: boolean; remedy: string | null;
  running: string | null; not_real_time: string | null; lost_rights: string | null; unguarded: string | null;
  flag: boolean;
}

export interface CpuStatus { cpu: number; budgets: number; capacity: number }

export interface TaskStatus {
  task: string; component: string; rtpu: string; state: State; in_service: boolean; incarnation: number;
  rate_hz: number; period_ns: number; budget_ns: number; busy_ns: number; on_ns: number; cycles: number;
  execution_ns: { mean: number; max: number }; response_ns: { max: number }; jitter_ns: number;
  server: { capacity_ns: number; period_ns: number } | null; has_doorbell: boolean;
  missed: number; overrun: number; dropped: number; stale: number; rejected: number; demoted: number;
  fault: string | null; faults: number; standby_for: string | null;
  inputs: { port: string; variable: string; age_ns: number | null }[];
}

export interface Status {
  subsystem: string; configuration: string; now_ns: number; origin_ns: number; started_ns: number | null;
  ending: boolean;
  flag: { up: boolean; by: string[] };
  keeper: { pid: number; hang: string | null };
  guard: { pid: number; lack: string | null; hang: string | null } | null;
  switch?: { to: string | null; progress: string } | null;
  cpus: CpuStatus[];
  rtpus: RtpuStatus[];
  tasks: TaskStatus[];
}

export interface Reading {
  value: unknown; text: string; unit: string; type: string; shape: string; producer: string; state: string;
  published_ns: number; age_ns: number; sequence: number; valid: boolean;
}

export interface Event {
  number: number; origin_ns: number; at_ns: number; wall_ns: number; kind: string; text: string;
  task?: string; rtpu?: string; by?: string;
}

export interface WhyLink {
  depth: number; variable: string; producer: string | null; component: string | null; rtpu: string | null;
  state: string | null; period_ns: number; age_ns: number | null; valid: boolean; value: string; verdict: string;
  timing: string; late: string; inputs: string[];
}

export interface Plan {
  from: string | null; to: string | null; end: "possible" | "nothing-to-do" | "refused"; reason: string | null;
  why: string | null; remedy: string | null; way: "fast" | "slow"; slow_why: string | null; expected_ns: number;
  arrives: string[]; leaves: string[]; stays: string[];
  variables: { variable: string; from: string | null; to: string }[];
}

export interface Receipt {
  number?: number; from?: string | null; to?: string | null; way?: string; end: string; why?: string | null;
  slow_why?: string | null; tries?: number; wall_ns?: number; asked_by?: Record<string, unknown>;
  took_ns?: Record<string, number>;
  tasks?: { task: string; move: string; lost: number; delay_ns: number | null }[];
  variables?: { variable: string; from: string | null; to: string | null; step: number | null; unit: string;
    limit: number | null; beyond: boolean }[];
}

export interface TaskProfile {
  task: string; state: State; rtpu: string; cycles: number; missed: number; overrun: number; dropped: number;
  stale: number; rejected: number; faults: number; period_ns: number;
  execution_ns: Record<string, { count: number; mean: number; max: number }>;
  response_ns: { count: number; mean: number; max: number };
}

/** A refusal: what a person reads, and what a program may do about it. */
export interface RpcError {
  code: number;
  message: string;
  data?: { kind?: string; where?: string; remedy?: string; nearest?: string; needs?: string; has?: string;
    tasks?: string[]; resources?: { task: string; port: string; text: string }[] };
}

// ---- The draft: docs/formats/web.md, "The draft" and "The outline"; docs/formats/edit.md.

export interface TaskPort { task: string; port: string }

export type EditAct =
  | { act: "set"; path: string; value: string }
  | { act: "remove"; path: string }
  | { act: "rename"; path: string; to: string }
  | { act: "add_task"; name: string; component: string; subsystem: string }
  | { act: "link"; task: string; port: string; variable: string; instance: number | null }
  | { act: "join"; variable: string; by: "mean" | "priority" | "select" };

export interface Fault {
  rule: string; severity: "error" | "warning"; line: number; column: number; found: string; expected: string;
  nearest: string; message: string; remedy: string; set: string; task: string; port: string; path: string;
}

export interface OutlinePort {
  port: string; declared: string; kind: Port["kind"]; type: string; unit: string; shape: string; solved: boolean;
  shared: boolean; variable: string | null; parted: boolean; value: string | null; default: string | null; doc: string;
}

export interface OutlineTask {
  task: string; line: number; component: string; known: boolean; doc: string; rtpu: string; rate_hz: number | null;
  own_rate: boolean; budget_ns: number | null; criticality: string; standby_for: string | null;
  ports: OutlinePort[];
  repeated: { port: string; kind: Port["kind"]; instances: number; max_instances: number; doc: string }[];
}

export interface OutlineVariable {
  variable: string; constant: boolean; origin: "operator" | "constants" | "default" | null; value: string | null;
  type: string; unit: string; shape: string; producers: TaskPort[]; consumers: TaskPort[];
}

export interface Outline {
  subsystem: string; start: string; tasks: OutlineTask[]; variables: OutlineVariable[];
  configurations: { configuration: string; tasks: string[]; safe_when: string | null }[];
  rtpus: { rtpu: string; cpu: number; policy: string; executor: string }[];
  sequence: Sequence | null;
}

export interface ScheduledTask { task: string; guarantee: "yes" | "no" | "not-stated" | "not-decided" }

export interface ScheduledCpu {
  cpu: number; fits: boolean; utilisation: number; limit: number; tasks: ScheduledTask[]; give_way: string[];
  remedies: { label: string; acts: EditAct[] }[];
}

/** What `chimera check --modes --json` prints: docs/formats/run.md. */
export interface Transition {
  from: string; to: string; way: "fast" | "slow-unless-same" | "slow" | "takeover";
  cpus: { cpu: number; schedulable: "yes" | "no" | "not-stated" | "not-decided"; task: string | null }[];
  constants: { constant: string; before: string; after: string; tasks: string[] }[];
  resources: { resource: string; before: string; after: string }[];
  initialised_anew: string[];
}
export interface Modes { transitions: Transition[] }

export interface Schedule { fits: boolean; sets: { name: string; fits: boolean; cpus: ScheduledCpu[] }[] }

export interface Analysis {
  version: number; text: string; report: { legal: boolean; errors: number; warnings: number; faults: Fault[] };
  outline: Outline | null; picture: Picture | null; schedule: Schedule | null;
}

/** What a notification of the draft brings. */
export interface DraftNews {
  version: number; file: string; exists: boolean; touched: boolean; outside: boolean; problem: string | null;
}

export interface DraftAnswer extends DraftNews { analysis: Analysis }

/** An edit that was tried: after it the fault is gone. The page adds edits with values of lessons. */
export interface Offer { fault: number; label: string; acts: EditAct[]; origin?: string }

export interface LibraryComponent { name: string; doc: string; file: string }

// ---- Trials: docs/formats/web.md, "Trials"; docs/formats/run.md.

/** What `chimera run --json` prints, or the report of what it refused. */
export interface RunAnswer {
  ran_ns?: number;
  tasks?: TaskProfile[];
  expectations?: { text: string; holds: boolean; said: string }[];
  receipts?: Receipt[];
  verdict?: { clean: boolean; missed: number; dropped: number; faults: number; remarks: string[]; failures: string[] };
  error?: { where: string; message: string };
  faults?: Fault[];
}

export interface TrialResult {
  number: number; ended: null | { code: number } | { signal: string }; why: string | null; ran_ms: number;
  output: unknown; error: string | null; csv: string | null; svg: string | null;
}

/** Scheduling records of one rtpu: docs/formats/control.md, "Notifications". */
export interface TapNote { rtpu: string; lost: number; records?: [number, string, string | null, number, number][] }
