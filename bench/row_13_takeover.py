# SPDX-License-Identifier: Apache-2.0
# Needs: process_campaigns component_gain_files component_faulty_files
"""Row 13, takeover: from the loss of a task until readers have an output of its standby in another rtpu. The loss is
the SIGKILL of the rtpu of the primary, or the fault by which the primary goes to ERROR. A cold standby publishes with
`on`: its first row on the tap of its rtpu. A hot standby has published beside the primary: readers have its last output
from the takeover on, and then one that is newer than the loss. The goal is one period of the standby. Baseline, in turn
with it: there is no standby. The manager starts the rtpu again, or a client that waits for the event `fault` turns the
other task ON. A death must cost another task of the standby's rtpu no cycle. Its lost cycles are compared with those of
an equally long time without a death."""
import json
import os
import pathlib
import signal
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "tests" / "processes"))
from percentile import percentile  # noqa: E402
from system import System, await_that  # noqa: E402

PERIOD_US = 1000
ROUNDS = 100
WINDOW_S = 0.1
UNTIL_FAULT_S = 0.5  # after `on`; the client is there before
TEXT = """
subsystem: subject
rtpus: {first: {cpu: 0, policy: edf}, second: {cpu: 1, policy: edf}}
tasks:
  steady: {component: t_counter, rtpu: second, rate: 1 kHz}
  main: {rtpu: first, rate: 1 kHz, MAIN}
  spare: {component: gain, rtpu: second, rate: 1 kHz, alias: {x: x, y: u}, constants: {k: 3}SPARE}
  user: {component: gain, rtpu: second, rate: 1 kHz, alias: {x: u, y: seen}, constants: {k: 1}}
operator: {x: 1}
configurations: {all: [steady, main, user]}
start: all
"""
SOUND = "component: gain, alias: {x: x, y: u}, constants: {k: 2}"
FAILING = f"component: faulty, alias: {{y: u}}, constants: {{throw_after: {UNTIL_FAULT_S} s}}"
COLD, HOT, NONE = ", standby_for: main", ", standby_for: {task: main, hot: true}", ""


def kill_rtpu(system, _):
    pidfd = os.pidfd_open(system.rtpu("first")["pid"])
    began = time.monotonic_ns()
    signal.pidfd_send_signal(pidfd, signal.SIGKILL)
    os.close(pidfd)
    return began


def await_fault(system, kept):
    """The instant of the fault of the primary, from the event of its rtpu. Notes that come first go to `kept`."""
    end = time.monotonic() + 5
    while time.monotonic() < end:
        kept.append(system.client.note())
        for event in kept[-1]["params"].get("events", []):
            if event["kind"] == "fault" and event["task"] == "main":
                return event["at_ns"]
    raise AssertionError("no fault was told")


def await_fault_and_answer(system, kept):
    at = await_fault(system, kept)
    system.signal("on", "spare")
    return at


def follow(system, kept, who, began, takes_over):
    """The instants after `began` at which `who` took over, None without a standby, and first published."""
    row = takeover = None
    end = time.monotonic() + 10
    while row is None or (takes_over and takeover is None):
        assert time.monotonic() < end, f"{who} has not taken over, or not published"
        told = (kept.pop(0) if kept else system.client.note())["params"]
        for event in told.get("events", []):
            if event["kind"] == "takeover":
                takeover = event["at_ns"]
        if told.get("task") == who and row is None:
            row = next((row[0] for row in told["rows"] if row[0] > began), None)
            assert row is None or told["lost"] == 0, told
    return takeover, row


def lost(system):
    """Cycles of the steady task that were late or not run so far."""
    task = system.task("steady")
    assert task["incarnation"] == 1 and task["faults"] == 0, task
    return task["dropped"] + task["missed"]


def lost_in_window(system, action):
    """Cycles lost from the beginning of the action, which takes less than the window, to the end of the window."""
    before, end = lost(system), time.monotonic() + WINDOW_S
    action()
    time.sleep(max(0, end - time.monotonic()))
    return lost(system) - before


def once(main, spare, strike, who):
    """(microseconds from the loss to the takeover, to the first row of `who`, cycles lost in a window that begins with
    the loss, and in one before)"""
    with System(TEXT.replace("MAIN", main).replace("SPARE", spare), ("--priority", "80")) as system:
        system.call("subscribe", to="tap", variables=["u"])
        system.call("subscribe", to="events")
        subscribed, kept, took = time.monotonic_ns(), [], []

        def take_over():
            began = strike(system, kept)
            assert began > subscribed, "the client came too late"
            took.extend(at and (at - began) / 1e3 for at in follow(system, kept, who, began, spare != NONE))

        await_that(lambda: system.call("get", variables=["seen"])["values"]["seen"]["value"])
        without = lost_in_window(system, lambda: None)
        with_it = lost_in_window(system, take_over)
        assert system.state(who) == "ON"
        return *took, with_it, without


def told(times):
    return f"p50 {statistics.median(times):.0f}, max {max(times):.0f}", round(percentile(times, 0.99), 1)


def line(what, times, baseline, baseline_name, has_goal=True):
    middle, figure = told(times)
    middle_of_baseline, other = told(baseline)
    print(json.dumps({"row": 13, "what": f"{what}, p99 ({middle})", "unit": "us", "figure": figure, "baseline": other,
                      "baseline_name": f"{baseline_name} ({middle_of_baseline})", "ratio": round(figure / other, 4),
                      "goal": f"<= {PERIOD_US} us, a period" if has_goal else "",
                      "met": figure <= PERIOD_US if has_goal else None, "n": ROUNDS}))


CASES = {"kill, cold": (SOUND, COLD, kill_rtpu, "spare"), "kill, hot": (SOUND, HOT, kill_rtpu, "spare"),
         "kill, none": (SOUND, NONE, kill_rtpu, "main"), "fault, cold": (FAILING, COLD, await_fault, "spare"),
         "fault, hot": (FAILING, HOT, await_fault, "spare"),
         "fault, none": (FAILING, NONE, await_fault_and_answer, "spare")}
found = {name: [] for name in CASES}
for _ in range(ROUNDS):
    for name, case in CASES.items():
        found[name].append(once(*case))
TAKEOVERS = {name: [each[0] for each in runs] for name, runs in found.items()}
ROWS = {name: [each[1] for each in runs] for name, runs in found.items()}
NEWER = {name: [max(each[:2]) for each in runs] for name, runs in found.items() if "hot" in name}
for loss, instead in (("kill", "the rtpu restarted"), ("fault", "a client: `on spare`")):
    without_it = ROWS[f"{loss}, none"]
    line(f"{loss} to the first output of a cold standby", ROWS[f"{loss}, cold"], without_it, instead)
    line(f"{loss} to the takeover by a hot one", TAKEOVERS[f"{loss}, hot"], without_it, instead)
    line(f"{loss} to an output of a hot one that is newer", NEWER[f"{loss}, hot"], without_it, instead, has_goal=False)
DEATHS = found["kill, cold"] + found["kill, hot"]
LOST, CONTROL = (sum(each[place] for each in DEATHS) for place in (2, 3))
print(json.dumps({"row": 13, "what": "cycles that another task of the standby's rtpu lost", "unit": "", "figure": LOST,
                  "baseline": CONTROL, "baseline_name": "no death", "goal": "no more than without death",
                  "met": LOST <= CONTROL, "n": len(DEATHS)}))
