// SPDX-License-Identifier: Apache-2.0
// The draft as a whole, while no task is chosen: a task to add, operator variables, constants, configurations, rtpus.
import { Button } from "./controls";
import { draft } from "./draft";
import { freeName, memberActs, ownTasks, renameActs, rtpuActs, valueActs, variablePath } from "./edits";
import { AddForm, EditChoice, EditField, MoreOf } from "./edit_field";
import type { Outline, OutlineVariable } from "./protocol";
import { joinPath } from "./text";
import { choose, showVariable } from "./view";

interface Props { outline: Outline; text: string; why: string }

/** The name of a subsystem for a FILE that has none yet: its own name. */
export const nameOfFile = (file: string): string =>
  joinPath("/", file).replace(/^.*\//, "").replace(/\.[^.]*$/, "").replace(/\W/g, "_").replace(/^(?=\d)/, "_");

export function AddTask({ outline, file, why }: { outline: Outline | null; file: string; why: string }) {
  const taken = (outline?.tasks ?? []).map((task) => task.task);
  return <AddForm label="Add task" why={why}
                  fields={[{ id: "add-task-component", label: "component", list: "components" },
                    { id: "add-task-name", label: "name", isOptional: true }]}
                  commit={async ([component, wanted]) => {
                    const name = wanted || freeName(component!, taken);
                    const sentence = await draft.edit([{ act: "add_task", name, component: component!,
                      subsystem: outline?.subsystem || nameOfFile(file) }]);
                    if (sentence === "") choose([name]);
                    return sentence;
                  }} />;
}

function Values({ words, section, list, why }:
  { words: string; section: "operator" | "constants"; list: OutlineVariable[]; why: string }) {
  return (
    <section aria-label={words}>
      <h4>{words}</h4>
      {list.map((one) => (
        <div key={one.variable} className="row">
          <EditField label={one.variable} note={one.unit === "1" ? "" : one.unit} name={`value of ${one.variable}`}
                     mark={["field", `${section}/${one.variable}`]} present={one.value ?? ""} why={why}
                     commit={(typed) => draft.edit(valueActs(variablePath(one), typed, true))} />
          <MoreOf variable={one.variable} />
        </div>))}
      <AddForm label={section === "operator" ? "Add operator variable" : "Add constant"} why={why}
               fields={[{ id: `add-${section}-name`, label: "name",
                 list: section === "operator" ? "known" : "constants-known" },
               { id: `add-${section}-value`, label: "value" }]}
               commit={([name, value]) => draft.edit([{ act: "set", path: `${section}/${name}`, value: value! }])} />
    </section>
  );
}

function Configurations({ outline, text, why }: Props) {
  return (
    <section aria-label="Configurations">
      <h4>Configurations</h4>
      {outline.configurations.map(({ configuration: name, tasks, safe_when }) => (
        <details key={name}>
          <summary>{name}: {tasks.length} of {outline.tasks.length} tasks
            {name === outline.start ? ", ON at the start" : ""}</summary>
          <EditField label="name" name={`name of configuration ${name}`} mark={["rename", `configurations/${name}`]}
                     present={name} why={why}
                     commit={(to) => draft.edit([{ act: "rename", path: `configurations/${name}`, to }])} />
          {safe_when !== null && <p className="hint">safe when {safe_when}</p>}
          {ownTasks(outline).map(({ task }) => (
            <label key={task} className="check"><input type="checkbox" checked={tasks.includes(task)} title={why}
                disabled={why !== ""} aria-label={`${task} in ${name}`}
                onChange={(event) => void draft.press(
                  memberActs(text, outline, name, task, event.target.checked))} /> {task}</label>))}
          <div className="acts">
            <Button label={`Start with ${name}`} press={() => void draft.press(valueActs("start", name, true))}
                    forbidden={why || (name === outline.start ? `${name} is ON at the start` : "")} />
            <Button label={`Remove configuration ${name}`} forbidden={why}
                    press={() => void draft.press([{ act: "remove", path: `configurations/${name}` }])}>
              Remove</Button>
          </div>
        </details>))}
      <AddForm label="Add configuration" why={why} fields={[{ id: "add-configuration-name", label: "name" }]}
               commit={([name]) => draft.edit([{ act: "set", path: `configurations/${name}`, value: `[${
                 ownTasks(outline).filter((one) => !one.standby_for).map((one) => one.task).join(", ")}]` }])} />
    </section>
  );
}

const options = (...words: string[]): [string, string][] => words.map((one) => [one, one]);

function Rtpus({ outline, text, why }: Props) {
  return (
    <section aria-label="Rtpus">
      <h4>Rtpus: real-time processes</h4>
      {outline.rtpus.map(({ rtpu, cpu, policy, executor }) => {
        const field = (key: string) => ({ why, name: `${key} of ${rtpu}`, label: key,
          mark: ["field", `rtpus/${rtpu} ${key}`] as ["field", string],
          commit: (words: string) => draft.edit(rtpuActs(text, rtpu, key, words)) });
        return (
          <details key={rtpu}>
            <summary>{rtpu}: cpu {cpu}, {policy}, {executor}</summary>
            <EditField label="name" name={`name of rtpu ${rtpu}`} mark={["rename", `rtpus/${rtpu}`]} present={rtpu}
                       why={why} commit={(to) => draft.edit([{ act: "rename", path: `rtpus/${rtpu}`, to }])} />
            <EditField {...field("cpu")} present={String(cpu)} />
            <EditChoice {...field("policy")} present={policy}
                        options={options("rm", "edf", "muf", "muf-laxity", "llf")} />
            <EditChoice {...field("executor")} present={executor} options={options("executive", "preemptive")} />
            <Button label={`Remove rtpu ${rtpu}`} forbidden={why}
                    press={() => void draft.press([{ act: "remove", path: `rtpus/${rtpu}` }])} />
          </details>);
      })}
      <AddForm label="Add rtpu" why={why}
               fields={[{ id: "add-rtpu-name", label: "name" }, { id: "add-rtpu-cpu", label: "cpu" }]}
               commit={([name, cpu]) => draft.edit([{ act: "set", path: `rtpus/${name}`, value: `{cpu: ${cpu}}` }])} />
    </section>
  );
}

export function AssemblyForm({ outline, text, why, file }: Props & { file: string }) {
  const of = (origin: string) => outline.variables.filter((one) => one.origin === origin);
  return (
    <>
      {outline.tasks.length > 0 && <AddTask outline={outline} file={file} why={why} />}
      <EditField label="subsystem" name="name of the subsystem" mark={["field", "subsystem"]} why={why}
                 present={outline.subsystem} commit={(typed) => draft.edit(valueActs("subsystem", typed, false))} />
      <Values words="Operator variables" section="operator" list={of("operator")} why={why} />
      <Values words="Constants" section="constants" list={of("constants")} why={why} />
      <Configurations outline={outline} text={text} why={why} />
      <Rtpus outline={outline} text={text} why={why} />
    </>
  );
}

function Ends({ words, ends }: { words: string; ends: OutlineVariable["producers"] }) {
  return (
    <>
      <h4>{words}</h4>
      {ends.length === 0 && <p className="hint">none</p>}
      <ul className="ports" aria-label={words}>{ends.map((end) => (
        <li key={`${end.task} ${end.port}`}><button type="button" className="link"
            onClick={() => choose([end.task])}>{end.task}.{end.port}</button></li>))}</ul>
    </>
  );
}

/** A variable or constant: its name, value, producers and readers. */
export function VariableForm({ of, why }: { of: OutlineVariable; why: string }) {
  const { variable, constant, origin, producers } = of;
  const type = `${of.type}${of.shape} ${of.unit === "1" ? "" : of.unit}`;
  const isGiven = origin === "operator" || origin === "constants";
  return (
    <article aria-label={`Variable ${variable}`}>
      <h3>{variable}</h3>
      <p className="doc">{constant ? "constant" : "variable"}, {type}</p>
      <EditField label="name" name={`name of ${variable}`} mark={["rename", variable]} present={variable} why={why}
                 title="key F2" commit={async (to) => {
                   const sentence = await draft.edit(renameActs(of, to));
                   if (sentence === "") showVariable(to);
                   return sentence;
                 }} />
      <EditField label={constant ? "value" : "value of the operator"} name={`value of ${variable}`} why={why}
                 mark={["field", variablePath(of)]} present={isGiven ? of.value ?? "" : ""}
                 placeholder={producers.length > 0 ? "a task produces it" : of.value ?? "none"}
                 commit={(typed) => draft.edit(valueActs(variablePath(of), typed, isGiven))} />
      <Ends words="Producers" ends={producers} />
      {producers.length > 1 && !constant && (
        <div className="acts" role="toolbar" aria-label={`Join the producers of ${variable}`}>
          {(["mean", "priority", "select"] as const).map((by) => (
            <Button key={by} label={`Join by ${by}`} forbidden={why}
                    press={() => void draft.press([{ act: "join", variable, by }])} />))}
        </div>)}
      <Ends words="Readers" ends={of.consumers} />
    </article>
  );
}
