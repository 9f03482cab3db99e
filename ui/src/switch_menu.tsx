// SPDX-License-Identifier: Apache-2.0
// The menu of configurations: each with its plan before it is pressed; the receipt comes after.
import { useEffect, useState } from "react";
import { Button, onEscape } from "./controls";
import { forbidden, Machine, MachineState } from "./machine";
import type { Plan, Receipt } from "./protocol";
import { duration } from "./text";
import { ask, view } from "./view";

/** What a switch would do, in a sentence. */
export function planText(plan: Plan): string {
  if (plan.end === "nothing-to-do") return "is in force";
  if (plan.end === "refused") return `not now: ${plan.why ?? plan.reason ?? "refused"}`;
  const parts = [`${plan.way}, about ${duration(plan.expected_ns)}`];
  if (plan.arrives.length > 0) parts.push(`ON: ${plan.arrives.join(", ")}`);
  if (plan.leaves.length > 0) parts.push(`OFF: ${plan.leaves.join(", ")}`);
  parts.push(`${plan.stays.length} stay`);
  return parts.join("; ");
}

/** How a switch ended, in a sentence. */
export function receiptText(receipt: Receipt): string {
  if (receipt.end === "nothing-to-do") return `${receipt.to ?? "The set"} is in force already.`;
  const took = Object.values(receipt.took_ns ?? {}).reduce((sum, ns) => sum + ns, 0);
  const lost = (receipt.tasks ?? []).reduce((sum, task) => sum + task.lost, 0);
  const way = `${receipt.from ?? "?"} → ${receipt.to ?? "?"}`;
  if (receipt.end !== "done") return `${way}: ${receipt.end}${receipt.why ? `, ${receipt.why}` : ""}.`;
  const cycles = lost === 0 ? "no cycle lost" : `${lost} cycles lost`;
  return `${way}: done in ${duration(took)}, ${receipt.way ?? ""}, ${cycles}.`;
}

async function carryOut(machine: Machine, configuration: string): Promise<void> {
  const receipt: Receipt | null = await machine.act("switch", { configuration });
  if (receipt) machine.say(receiptText(receipt));
}

function press(machine: Machine, name: string, plan: Plan | undefined): void {
  if (!plan || plan.way !== "slow" || plan.end !== "possible") return void carryOut(machine, name);
  ask({
    title: `Switch to ${name} the slow way?`, button: `Switch to ${name}`,
    text: `${plan.slow_why ?? "Tasks must be created"}. Tasks that stay may wait; about ${duration(plan.expected_ns)}.`,
    carryOut: () => void carryOut(machine, name),
  });
}

export function SwitchMenu({ machine, state }: { machine: Machine; state: MachineState }) {
  const [isOpen, open] = useState(false);
  const [plans, setPlans] = useState<Record<string, Plan>>({});
  const names = (state.description?.configurations ?? []).map((one) => one.name);
  const inForce = state.status?.configuration ?? "";
  const underWay = state.status?.switch;
  const list = names.join("\n");
  useEffect(() => {
    if (!isOpen) return;
    let isNeeded = true;
    const askAll = async () => {
      const all = await Promise.all(list.split("\n").map((name) => machine.ask("plan", { configuration: name })));
      if (isNeeded) setPlans(Object.fromEntries(list.split("\n").map((name, i) => [name, all[i]]).filter((p) => p[1])));
    };
    void askAll();
    return () => { isNeeded = false; };
  }, [isOpen, inForce, list, machine]);
  if (names.length < 2) return null;
  return (
    <div className="menu" onKeyDown={onEscape(() => open(false))}>
      <Button label="Switch configuration" isPressed={isOpen} press={() => open(!isOpen)}>Switch ▾</Button>
      {underWay && <Button label="Cancel the switch under way" forbidden={forbidden(state.hello?.role, "operate")}
                           press={() => void machine.act("cancel", {})}>Cancel: {underWay.progress}</Button>}
      {isOpen && (
        <ul className="sheet" aria-label="Configurations">
          {names.map((name) => {
            const plan = plans[name];
            const why = forbidden(state.hello?.role, "operate");
            return (
              <li key={name}>
                <Button label={`Switch to ${name}`} forbidden={why || (name === inForce ? `${name} is in force` : "")}
                        press={() => { open(false); press(machine, name, plan); }}>{name}</Button>
                <span className="plan" data-plan={name}>{plan ? planText(plan) : "…"}</span>
                <Button label={`Draw only ${name}`} isPressed={state.drawn === name}
                        press={() => {
                          view.set({ chosen: [] });
                          void machine.draw(state.drawn === name ? "" : name);
                        }}>
                  draw only this</Button>
              </li>
            );
          })}
        </ul>
      )}
    </div>
  );
}
