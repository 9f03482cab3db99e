// SPDX-License-Identifier: Apache-2.0
// The chosen task of the draft: its keys, ports and configurations, each a field.
import { memo } from "react";
import { Button } from "./controls";
import { draft } from "./draft";
import { instanceActs, instanceOf, linkActs, memberActs, quoted, removedInstance, removedTask, valueActs, valuePath,
  } from "./edits";
import { AddForm, EditChoice, EditField, MoreOf } from "./edit_field";
import { faultsAt } from "./faults";
import type { Fault, Outline, OutlinePort, OutlineTask, Port } from "./protocol";
import { rate } from "./text";
import { wordsAt } from "./text_places";
import { choose } from "./view";

interface Props { outline: Outline; task: OutlineTask; text: string; why: string; faults: Fault[] }

/** Keys that are typed as the text has them; what they mean: docs/formats/description.md. */
const KEYS: [key: string, label: string, help: string][] = [
  ["deadline", "deadline", "duration from release to end of the cycle; none: the period"],
  ["offset", "offset", "duration before the first release"],
  ["on_miss", "on a miss", "continue, hold, skip, abort, demote, error, flag, stop or {switch: CONFIGURATION}"],
  ["on_overrun", "on an overrun", "the same reactions, when a cycle exceeds its budget"],
  ["on_fault", "on a fault", "error, flag, stop, {switch: CONFIGURATION} or {restart: N, within: T, then: REACTION}"],
  ["max_consecutive", "misses in a row", "then the task goes to ERROR; 0: no limit"],
  ["stale_after", "stale after", "an older input is not valid"],
  ["safe_after", "safe after", "periods without a publication, then the rtpu is replaced"],
];

const EXAMPLES: Record<string, string> = { on_miss: "reactions", on_overrun: "reactions", on_fault: "fault-reactions" };

/** A key of the task, as the text writes it. A value on several lines is changed there. */
function KeyField({ task, text, why, name, label, help, placeholder, note }:
  Omit<Props, "outline" | "faults"> & { name: string; label: string; help: string; placeholder?: string;
    note?: string }) {
  const path = `tasks/${task.task}/${name}`;
  const words = wordsAt(text, path);
  const isLong = words?.startsWith("\n") ?? false;
  return <EditField label={label} name={`${label} of ${task.task}`} mark={["field", `${task.task} ${name}`]}
                    present={isLong ? "…" : words ?? ""} placeholder={placeholder} note={note} title={help}
                    list={EXAMPLES[name]} why={why || (isLong ? "stands on several lines: change it in the text" : "")}
                    commit={(typed) => draft.edit(valueActs(path, typed, words !== null))} />;
}

const kindWords: Record<Port["kind"], string> = { "in-var": "Inputs", "out-var": "Outputs", "in-const": "Constants",
  "out-const": "Constants for others", resource: "Resources" };

/** The value of a constant, a resource, or of an output at first. */
function ValueField({ task, port, outline, why, label }: Omit<Props, "text" | "faults"> &
  { port: OutlinePort; label: string }) {
  const path = valuePath(task.task, port);
  const variable = outline.variables.find((one) => one.variable === port.variable && one.constant);
  const isResource = port.kind === "resource";
  if (path === "") return null;
  return <EditField label={label} why={why}
                    note={isResource ? "file, device or address" : label === "own value" ? "" : noteOf(port)}
                    name={`value of ${task.task} ${port.port}`} present={port.value ?? ""} title={port.doc}
                    mark={["field", `${task.task} ${path.split("/").slice(2).join("/")}`]}
                    placeholder={variable?.value ?? port.default ?? (port.kind === "out-var" ? "none" : "required")}
                    commit={(words) => draft.edit(
                      valueActs(path, isResource ? quoted(words) : words, port.value !== null))} />;
}

const noteOf = ({ type, shape, unit }: OutlinePort) =>
  `${type}${shape}${unit === "1" || unit === "" ? "" : ` ${unit}`}`;

function PortFields({ text: _, ...props }: Props & { port: OutlinePort }) {
  const { task, port, why, faults } = props;
  const mark = `${task.task} ${port.port}`;
  const fault = faultsAt(faults, task.task, port.port);
  const isLinked = port.kind.endsWith("var") || port.variable !== null;
  return (
    <li className={fault ? "faulty" : ""}>
      {isLinked && (
        <div className="row">
          <EditField label={port.port} note={noteOf(port)} name={`variable of ${mark}`} mark={["link", mark]} why={why}
                     present={port.variable ?? ""} list={port.kind.endsWith("const") ? "constants-known" : "known"}
                     placeholder="no variable" title={port.doc || "name of a variable"}
                     commit={(typed) => draft.edit(linkActs(task.task, port, typed))} />
          {port.variable !== null && <MoreOf variable={port.variable} />}
        </div>)}
      {port.kind !== "out-var" && <ValueField {...props} label={isLinked ? "own value" : port.port} />}
      {fault !== "" && <p className="fault">{fault}</p>}
      {instanceOf(port.port) !== null &&
        <Button label={`Remove ${mark}`} forbidden={why}
                press={() => void draft.press(removedInstance(task.task, port))}>Remove {port.port}</Button>}
    </li>
  );
}

function Ports(props: Props) {
  const { task, why } = props;
  return <>{(Object.keys(kindWords) as Port["kind"][]).map((kind) => {
    const found = task.ports.filter((port) => port.kind === kind);
    const repeated = task.repeated.filter((port) => port.kind === kind && port.instances < port.max_instances);
    return found.length + repeated.length === 0 ? null : (
      <section key={kind}>
        <h4>{kindWords[kind]}</h4>
        <ul className="ports" aria-label={`${kindWords[kind]} of ${task.task}`}>
          {found.map((port) => <PortFields key={port.port} {...props} port={port} />)}</ul>
        {kind === "out-var" && found.length > 0 && (
          <details><summary>Before the first cycle</summary>
            {found.map((port) => <ValueField key={port.port} {...props} port={port} label={`${port.port} at first`} />)}
          </details>)}
        {repeated.map((port) => (
          <AddForm key={port.port} label={`Add ${port.port}[${port.instances}]`} why={why}
                   fields={[{ id: `add-${task.task}-${port.port}`, list: "known",
                     label: kind.endsWith("var") ? "variable" : "value" }]}
                   commit={([words]) => draft.edit(instanceActs(task.task, port, words!))} />))}
      </section>
    );
  })}</>;
}

function Memberships({ outline, task, text, why }: Omit<Props, "faults">) {
  return (
    <section>
      <h4>In configurations</h4>
      {outline.configurations.map(({ configuration: name, tasks }) => (
        <label key={name} className="check"><input type="checkbox" checked={tasks.includes(task.task)} title={why}
            disabled={why !== ""} aria-label={`${task.task} in ${name}`}
            onChange={(event) => void draft.press(
              memberActs(text, outline, name, task.task, event.target.checked))} /> {name}</label>))}
    </section>
  );
}

const LEVELS: [string, string][] = ["low", "medium", "high"].map((level) => [level, level]);

/** `measured`: figures of the machine that runs FILE; "": none. */
export const TaskForm = memo(function TaskForm({ measured, ...props }: Props & { measured: string }) {
  const { outline, task, text, why } = props;
  const { task: name } = task;
  const key = { task, text, why };
  const set = (path: string) => (words: string) =>
    draft.edit(valueActs(`tasks/${name}/${path}`, words, wordsAt(text, `tasks/${name}/${path}`) !== null));
  const standby = wordsAt(text, `tasks/${name}/standby_for`);
  return (
    <article aria-label={`Task ${name}`}>
      <h3>{name}</h3>
      <p className="doc">{task.component}: {task.known ? task.doc : "the library has no component of this name"}</p>
      <EditField label="name" name={`name of ${name}`} mark={["rename", name]} present={name} why={why} title="key F2"
                 commit={async (to) => {
                   const sentence = await draft.edit([{ act: "rename", path: `tasks/${name}`, to }]);
                   if (sentence === "") choose([to]);
                   return sentence;
                 }} />
      <EditField label="component" name={`component of ${name}`} mark={["field", `${name} component`]} why={why}
                 present={task.component} list="components" commit={set("component")} />
      <KeyField {...key} name="rate" label="rate" help="frequency, as 1 kHz; none: the component's"
                placeholder={task.rate_hz === null ? "none" : `${rate(task.rate_hz)}, of the component`} />
      <KeyField {...key} name="budget" label="budget" help="execution time of a cycle, as 40 us" placeholder="none"
                note={measured} />
      <EditChoice label="criticality" name={`criticality of ${name}`} mark={["field", `${name} criticality`]}
                  present={task.criticality} options={LEVELS} why={why} commit={set("criticality")} />
      <EditChoice label="rtpu" name={`rtpu of ${name}`} mark={["field", `${name} rtpu`]} present={task.rtpu} why={why}
                  options={outline.rtpus.map(({ rtpu }) => [rtpu, rtpu])} commit={set("rtpu")} />
      <Ports {...props} />
      <Memberships outline={outline} task={task} text={text} why={why} />
      <h4>Time and reactions</h4>
      {KEYS.map(([id, label, help]) => <KeyField key={id} {...key} name={id} label={label} help={help} />)}
      <EditChoice label="standby for" name={`${name} is a standby for`} mark={["field", `${name} standby_for`]}
                  present={task.standby_for ?? ""} commit={set("standby_for")}
                  why={why || (standby !== null && /^[\n{]/.test(standby) ? "is a map: change it in the text" : "")}
                  options={[["", "none"], ...outline.tasks.filter((one) => one.task !== name)
                    .map(({ task: other }): [string, string] => [other, other])]} />
      <p className="hint">Other keys of a task are set in the text.</p>
      <Button label={`Remove ${name}`} forbidden={why} title="key Delete"
              press={() => void draft.press(removedTask(text, outline, name))} />
    </article>
  );
});
