# SPDX-License-Identifier: Apache-2.0
"""One task hands its command to another in the middle of a motion, in virtual time: what readers see at 1 kHz makes no
step above what the command itself does in that time. Each case is a description with the tasks `before` and `after`,
which produce the same; at 1 s `before` goes off and `after` on. A command that is older is not gone on from.
usage: handover_test.py PROGRAM"""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile

POSE = "[0 rad, 1.2 rad, -1.2 rad, 0 rad, 0.6 rad, 0 rad]"
ARM = f"""
constants: {{start_pose: {POSE}}}
tasks:
  xr: {{component: ctraj, rate: 1 kHz, alias: {{xd: xr}}, constants: {{
    centre: {{position: [0.6 m, -0.15 m, 0.1 m], orientation: [0, 1, 0, 0]}}, amplitude: [0 m, 0.2 m, 0 m],
    frequency: [0 Hz, 0.4 Hz, 0 Hz]}}}}
  robot: {{component: puma, rate: 1 kHz, constants: {{bandwidth: 20 rad/s}}}}
  where: {{component: gfwdkin, rate: 1 kHz}}
"""
# What `after` says at on stands for 5 ms.
SLOWER = """  before: {component: COMPONENT, rate: 1 kHz}
  after: {component: COMPONENT, rate: 100 Hz, offset: 5 ms}
"""
TAU = """
constants:
  start_pose: [0 rad, 0.5 rad, -2 rad, 0 rad, 0.5 rad, 0 rad]
  goal: [1 rad, 0.5 rad, -1 rad, 0 rad, 0.5 rad, 0 rad]
  duration: 2 s
operator: {kp: 400 N.m/rad, ki: 100 N.m/(rad.s), kd: 40 N.m.s/rad}
tasks:
  trajectory: {component: joint_trajectory, rate: 1 kHz}
  robot: {component: puma_torque, rate: 1 kHz, resources: {model: puma560.xml}}
  before: {component: pid_joint, rate: 1 kHz}
  after: {component: pid_joint, rate: 1 kHz, constants: {filter_time: 5 ms}}
"""
SINE = """
constants: {ndof: 2, start_pose: 0 rad, goal: [1 rad, -1 rad]}
tasks:
  before: {component: signal_generator, rate: 1 kHz, alias: {y: q_ref}, constants: {
    amplitude: 0.5 rad, frequency: 0.3 Hz}}
  before_v: {component: signal_generator, rate: 1 kHz, alias: {y: qd_ref}, constants: {
    amplitude: 0.942478 rad/s, frequency: 0.3 Hz, phase: 90 deg}}
  before_a: {component: signal_generator, rate: 1 kHz, alias: {y: qdd_ref}, constants: {
    amplitude: -1.776529 rad/s2, frequency: 0.3 Hz}}
  after: {component: joint_trajectory, rate: 1 kHz, constants: {PROFILE}}
"""
SWITCH = ("before", "after")
# name, text, what is logged, the largest step that any element of each may make from row to row, which tasks change
CASES = (
    ("ginvkin", ARM + SLOWER.replace("COMPONENT", "ginvkin"), {"q_ref": 1.5e-2}, [SWITCH]),
    ("pinvkin", ARM + SLOWER.replace("COMPONENT", "pinvkin"), {"q_ref": 1.5e-2}, [SWITCH]),
    ("time_integrator", """
operator: {start: 0 rad}
tasks:
  speed: {component: signal_generator, rate: 1 kHz, alias: {y: rate_of_change}, constants: {
    amplitude: 1 rad/s, frequency: 0.2 Hz}}
  before: {component: time_integrator, rate: 1 kHz}
  after: {component: time_integrator, rate: 1 kHz}
""", {"integral": 1.1e-3}, [SWITCH]),
    ("joint_trajectory quintic", SINE.replace("PROFILE", "duration: 2 s"), {"q_ref": 1.3e-3, "qd_ref": 6e-3},
     [SWITCH, ("before_v", None), ("before_a", None)]),
    ("joint_trajectory jerk", SINE.replace("PROFILE", "profile: jerk"), {"q_ref": 1.2e-3, "qd_ref": 3e-3},
     [SWITCH, ("before_v", None), ("before_a", None)]),
    ("pid_joint", TAU, {"tau": 1.0}, [SWITCH]),
    ("car", """
operator: {gas: 0.6, fb: 0 N}
tasks:
  before: {component: car, rate: 1 kHz, constants: {start_speed: 20 m/s}, resources: {road: "0:0"}}
  after: {component: car, rate: 1 kHz, resources: {road: "0:0"}}
""", {"speed": 0.05, "xw": 0.1}, [SWITCH]),
)
# The same with `after` a second later: no element of its first value is above this, as at a first start; before, one
# was ten times as large.
OUTDATED = (("pid_joint", TAU, "tau", 0.2), ("time_integrator", CASES[2][1], "integral", 0.01))


def run(program, text, logged, changes, on_at):
    """The rows of the log as lists of numbers, the time first; what was said where it failed."""
    with tempfile.TemporaryDirectory() as folder:
        names = [line.split(":")[0].strip() for line in text[text.index("tasks:"):].splitlines()
                 if line.startswith("  ") and not line.startswith("   ")]
        gone, come = [old for old, _ in changes], [new for _, new in changes if new]
        first = [name for name in names if name not in come]
        text = f"version: 1\nsubsystem: handover\nstart: first\nconfigurations: {{first: [{', '.join(first)}, log], " \
               f"second: [{', '.join(name for name in names if name not in gone)}, log]}}\n" + text
        text += f"  log: {{component: csv_log, rate: 1 kHz, alias: {{in: [{', '.join(logged)}]}}, " \
                "resources: {file: log.csv}}\n"
        pathlib.Path(folder, "handover.yaml").write_text(text)
        words = [program, "run", "handover.yaml", "--virtual", "--for", "4 s"]
        for task in gone:
            words += ["--at", f"1 s: off {task}"]
        for task in come:
            words += ["--at", f"{on_at} s: on {task}"]
        done = subprocess.run(words, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              check=False)
        log = pathlib.Path(folder, "log.csv")
        if done.returncode != 0 or not log.exists():
            return None, done.stdout + done.stderr
        with log.open() as file:
            rows = list(csv.reader(file))
        return rows, done.stdout + done.stderr


def largest_step(rows, name):
    columns = [i for i, head in enumerate(rows[0]) if head.split("(")[0].split("[")[0] == name]
    assert columns, rows[0]
    steps = [(abs(float(b[i]) - float(a[i])), float(b[0])) for a, b in zip(rows[1:], rows[2:]) for i in columns
             if a[i] and b[i] and float(a[0]) > 0.5]
    return max(steps)


def largest(rows, begin, end):
    """Of the first row in that time."""
    for row in rows:
        if row[0] != "t(s)" and begin <= float(row[0]) < end:
            return max(abs(float(value)) for value in row[1:])
    return float("nan")


def main():
    program, failed = os.path.abspath(sys.argv[1]), []
    for name, text, limits, changes in CASES:
        rows, said = run(program, text, list(limits), changes, 1)
        if rows is None or len(rows) < 3900:
            failed.append(f"{name} does not run: {said}")
            continue
        for variable, limit in limits.items():
            step, at = largest_step(rows, variable)
            if step > limit:
                failed.append(f"{name}: {variable} makes a step of {step:.6g} at {at} s, above {limit:g}")
    for name, text, variable, limit in OUTDATED:
        rows, said = run(program, text, [variable], [SWITCH], 2)
        if rows is None:
            failed.append(f"{name} outdated does not run: {said}")
        elif not (largest(rows, 2, 2.003) <= limit and largest(rows, 0.99, 1) > 10 * limit):
            failed.append(f"{name} outdated: {variable} begins at {largest(rows, 2, 2.003):.6g}, above {limit:g}; it "
                          f"was {largest(rows, 0.99, 1):.6g}")
    print("\n".join(failed) or f"{len(CASES)} hand-overs without a step, {len(OUTDATED)} outdated commands left alone")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
