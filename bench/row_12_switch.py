# SPDX-License-Identifier: Apache-2.0
# Needs: demo component_gain_files component_t_delays_files component_mujoco_robot_files
"""Row 12, a switch of configurations. 100 tasks at 1 kHz on two rtpus, 25 of each rtpu leave and as many
others arrive, there and back: from the return of the last `on` to the instant of the change, in periods, and how many
cycles were lost by all of them. A witness on each processor says which of them the host disturbed: cycles are counted
in the others, and the instant of the change is judged where no job of the run has been stalled for 0.5 ms before, since
nothing is changed sooner than the longest job so far takes. 20 switches in each run, runs until 200 are judged, at most
60. Baseline of the whole command: the same change by `off`, then `on`, few enough for the limit of acts a second.
Then a large component (mujoco_robot) is loaded into an rtpu or removed: the longest start delay of another task there,
in windows of 0.5 s, against equal windows in which nothing happens, and those twice (A/A)."""
import json
import os
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "tests" / "processes"))
from host_witness import HostWitness, any_stall  # noqa: E402
from percentile import percentile  # noqa: E402
from system import System  # noqa: E402

JUDGED, A_RUN, RUNS, RESTARTS, WINDOWS, SECONDS, EACH = 200, 20, 60, 20, 20, 0.5, 25
PERIOD_NS = 1_000_000
LONG_S, AROUND_S = 0.5e-3, 2e-3  # a stall that a job is longer by; what is disturbed before and after one


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


def one_run(n, periods, lost, took):
    """Adds [periods from armed to the change] and [cycles lost] of the switches that are judged, [ms] of all."""
    witnesses = [HostWitness(cpu) for cpu in (0, 1)]
    receipts = []
    with System(TEXT, ("--priority", "80")) as system:
        target = "new"
        for _ in range(n):
            began = time.monotonic()
            receipts.append(system.call("switch", configuration=target))
            took.append(1e3 * (time.monotonic() - began))
            target = {"new": "old", "old": "new"}[target] if receipts[-1]["end"] == "done" else target
    stalls = [stall for witness in witnesses for stall in witness.stalls()]
    for receipt in receipts:
        begin, end = ((receipt["origin_ns"] + receipt[key]) / 1e9 for key in ("asked_ns", "ended_ns"))
        if not any_stall(stalls, begin - AROUND_S, end + AROUND_S):
            assert receipt["end"] == "done", receipt
            lost.append(sum(task["lost"] for task in receipt["tasks"]))
        if receipt["end"] == "done" and not any_stall(stalls, receipt["origin_ns"] / 1e9 - AROUND_S, end, LONG_S):
            periods.append((receipt["at_ns"] - receipt["armed_ns"]) / PERIOD_NS)


def restarts():
    """[ms of off, then on]"""
    took = []
    with System(TEXT, ("--priority", "80")) as system:
        for n in range(RESTARTS):
            began = time.monotonic()
            system.signal("off", *names(("old", "new")[n % 2]))
            system.signal("on", *names(("new", "old")[n % 2]))
            took.append(1e3 * (time.monotonic() - began))
    return took


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
                assert sum(counts) > SECONDS * 500, f"the probe did not run: {sum(counts)}"
                seen.append(upper_end(counts))
    return found


PERIODS, LOST, TOOK = [], [], []
MADE = 0
while (len(PERIODS) < JUDGED or len(LOST) < JUDGED) and MADE < RUNS * A_RUN:
    one_run(A_RUN, PERIODS, LOST, TOOK)
    MADE += A_RUN
RESTARTED = restarts()
FIGURE = percentile(PERIODS, 0.99)
print(json.dumps({"row": 12, "what": f"all armed to the change, p99 (p50 {statistics.median(PERIODS):.2f})",
                  "unit": "periods", "figure": round(FIGURE, 2), "baseline": 1, "baseline_name": "a period of 1 ms",
                  "goal": "<= 1", "met": FIGURE <= 1, "n": len(PERIODS)}))
print(json.dumps({"row": 12, "what": f"cycles lost by 150 tasks ({MADE - len(LOST)} of {MADE} disturbed)", "unit": "",
                  "figure": sum(LOST), "baseline": 0, "baseline_name": "promised", "goal": "0",
                  "met": sum(LOST) == 0, "n": len(LOST)}))
print(json.dumps({"row": 12, "what": f"the whole command, p50 (p99 {percentile(TOOK, 0.99):.1f})", "unit": "ms",
                  "figure": round(statistics.median(TOOK), 2), "baseline": round(statistics.median(RESTARTED), 2),
                  "baseline_name": "off, then on", "goal": "not slower",
                  "met": statistics.median(TOOK) <= statistics.median(RESTARTED), "n": MADE}))
SEEN = stalls()
RATIOS = {what: sorted(one / other for one, other in zip(SEEN[what], SEEN["nothing"])) for what in ("control", "large")}
RATIO, LIMIT = statistics.median(RATIOS["large"]), RATIOS["control"][WINDOWS * 9 // 10]
print(json.dumps({"row": 12, "what": "longest start delay while a large component loads and goes", "unit": "us",
                  "figure": round(statistics.median(SEEN["large"]), 1),
                  "baseline": round(statistics.median(SEEN["nothing"]), 1), "baseline_name": "nothing happens",
                  "ratio": round(RATIO, 3), "limit": round(LIMIT, 3), "goal": "within the A/A spread",
                  "met": RATIO <= LIMIT, "aa_spread": round(LIMIT - RATIOS["control"][WINDOWS // 10], 3),
                  "n": WINDOWS}))
