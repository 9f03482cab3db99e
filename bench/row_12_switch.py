# SPDX-License-Identifier: Apache-2.0
# Needs: demo component_gain_files component_t_delays_files component_mujoco_robot_files
"""Row 12, a switch of configurations. 100 tasks at 1 kHz on two real-time units, 25 of each unit leave and as many
others arrive, there and back: from the return of the last `on` to the instant of the change, in periods, and how many
cycles were lost by all of them. Baseline of the whole command, right behind it: the same change by `off`, then `on`.
Then what one task of a unit feels while a large component (mujoco_robot) is loaded there or goes: the longest start
delay in windows of 0.5 s, beside as long ones in which nothing happens, and those twice (A/A)."""
import json
import os
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "tests" / "processes"))
from percentile import percentile  # noqa: E402
from system import System  # noqa: E402

SWITCHES, RESTARTS, WINDOWS, SECONDS, EACH = 200, 20, 20, 0.5, 25
PERIOD_NS = 1_000_000


def gains(name, unit):
    """EACH tasks of that name; those of one name produce the variables NAME0, NAME1, ..."""
    return "".join(f"  {name}_{unit}{n}: {{component: gain, rtpu: {unit}, rate: 1 kHz, "
                   f"alias: {{x: x, y: {'z' if name == 'stays' else 'y'}_{unit}{n}}}}}\n" for n in range(EACH))


def names(*tasks):
    return [f"{task}_{unit}{n}" for task in tasks for unit in ("first", "second") for n in range(EACH)]


TEXT = (f"subsystem: subject\nrtpus: {{first: {{cpu: 0, policy: edf}}, second: {{cpu: 1, policy: edf}}}}\ntasks:\n"
        f"{''.join(gains(name, unit) for name in ('stays', 'old', 'new') for unit in ('first', 'second'))}"
        f"operator: {{x: 1}}\nconfigurations: {{old: [{', '.join(names('stays', 'old'))}], "
        f"new: [{', '.join(names('stays', 'new'))}]}}\nstart: old\n")
LARGE = """
subsystem: subject
rtpus: {unit: {cpu: 1, policy: edf}}
tasks:
  probe: {component: t_delays, rtpu: unit, rate: 1 kHz, alias: {counts: of_probe}}
  large: {component: mujoco_robot, rtpu: unit, rate: 500 Hz, resources: {model: MODEL}}
operator: {q_ref: [0 rad, 1.4 rad, -1.4 rad, 0 rad, 0 rad, 0 rad]}
configurations: {all: [probe], both: [probe, large]}
start: all
""".replace("MODEL", str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "library/puma_torque/puma560.xml"))


def switches():
    """([periods from armed to the change], cycles lost in all switches, [ms of a switch], [ms of off and on])"""
    periods, lost, took, restarts = [], 0, [], []
    with System(TEXT, ("--priority", "80")) as system:
        for n in range(SWITCHES):
            began = time.monotonic()
            receipt = system.call("switch", configuration=("new", "old")[n % 2])
            took.append(1e3 * (time.monotonic() - began))
            assert receipt["end"] == "done", receipt
            periods.append((receipt["at_ns"] - receipt["armed_ns"]) / PERIOD_NS)
            lost += sum(task["lost"] for task in receipt["tasks"])
        for n in range(RESTARTS):
            began = time.monotonic()
            system.signal("off", *names(("old", "new")[n % 2]))
            system.signal("on", *names(("new", "old")[n % 2]))
            restarts.append(1e3 * (time.monotonic() - began))
    return periods, lost, took, restarts


def upper_end(counts):
    """Microseconds: the end of the last bin of t_delays in which something lies."""
    last = max(b for b, n in enumerate(counts) if n > 0)
    return (17 + last % 16) * 2 ** (last // 16) * 16 / 1e3


def stalls():
    """{what happened: [longest start delay in us]}"""
    found = {"nothing": [], "control": [], "large": []}
    with System(LARGE, ("--priority", "80")) as system:
        system.signal("off", "probe")
        for _ in range(WINDOWS):
            for what, seen in found.items():
                system.signal("on", "probe")
                end = time.monotonic() + SECONDS
                if what == "large":
                    system.signal("kill", "large")
                    system.signal("spawn", "large")
                time.sleep(max(0, end - time.monotonic()))
                system.signal("off", "probe")
                counts = system.call("get", variables=["of_probe"])["values"]["of_probe"]["value"]
                assert sum(counts) > SECONDS * 900, f"the probe did not run: {sum(counts)}"
                seen.append(upper_end(counts))
    return found


PERIODS, LOST, TOOK, RESTARTED = switches()
FIGURE = percentile(PERIODS, 0.99)
print(json.dumps({"row": 12, "what": f"all armed to the change, p99 (p50 {statistics.median(PERIODS):.2f})",
                  "unit": "periods", "figure": round(FIGURE, 2), "baseline": 1, "baseline_name": "a period of 1 ms",
                  "goal": "<= 1", "met": FIGURE <= 1, "n": SWITCHES}))
print(json.dumps({"row": 12, "what": "cycles lost by 150 tasks", "unit": "", "figure": LOST, "baseline": 0,
                  "baseline_name": "promised", "goal": "0", "met": LOST == 0, "n": SWITCHES}))
print(json.dumps({"row": 12, "what": f"the whole command, p50 (p99 {percentile(TOOK, 0.99):.1f})", "unit": "ms",
                  "figure": round(statistics.median(TOOK), 2), "baseline": round(statistics.median(RESTARTED), 2),
                  "baseline_name": "off, then on", "goal": "not slower",
                  "met": statistics.median(TOOK) <= statistics.median(RESTARTED), "n": SWITCHES}))
SEEN = stalls()
RATIOS = {what: sorted(one / other for one, other in zip(SEEN[what], SEEN["nothing"])) for what in ("control", "large")}
RATIO, LIMIT = statistics.median(RATIOS["large"]), RATIOS["control"][WINDOWS * 9 // 10]
print(json.dumps({"row": 12, "what": "longest start delay while a large component loads and goes", "unit": "us",
                  "figure": round(statistics.median(SEEN["large"]), 1),
                  "baseline": round(statistics.median(SEEN["nothing"]), 1), "baseline_name": "nothing happens",
                  "ratio": round(RATIO, 3), "limit": round(LIMIT, 3), "goal": "within the A/A spread",
                  "met": RATIO <= LIMIT, "aa_spread": round(LIMIT - RATIOS["control"][WINDOWS // 10], 3),
                  "n": WINDOWS}))
