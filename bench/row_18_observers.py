# SPDX-License-Identifier: Apache-2.0
# Needs: demo component_gain_files component_t_delays_files
"""Row 18: what looking on costs the tasks. 100 tasks at 1 kHz on one rtpu and with them three that count how
long after its release each of their cycles begins, one in front, one in the middle, one behind. Windows of 0.5 s in
turn: alone, alone again (A/A), under `status` every 100 ms (what `chimera top` asks for), and under a tap of 100
variables read as fast as it comes. Of each window p50 and p99 over the three; the figure is the median over the
windows of the ratio to the window alone of the same turn. Goal: not above what nine of ten A/A ratios are below.
The tap must bring every row: rows a second and lost rows are printed too."""
import json
import os
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "tests" / "processes"))
from system import Client, System  # noqa: E402

SYSTEMS, TURNS, SECONDS, N = 3, 10, 0.5, 100
PROBES = ["front", "middle", "behind"]


def probe(name):
    return f"  {name}: {{component: t_delays, rtpu: unit, rate: 1 kHz, alias: {{counts: of_{name}}}}}\n"


def gains(first, end):
    return "".join(f"  t{n}: {{component: gain, rtpu: unit, rate: 1 kHz, alias: {{x: x, y: y{n}}}}}\n"
                   for n in range(first, end))


TASKS = probe("front") + gains(0, N // 2) + probe("middle") + gains(N // 2, N) + probe("behind")
TEXT = (f"subsystem: subject\nrtpus: {{unit: {{cpu: 1, policy: edf}}}}\ntasks:\n{TASKS}operator: {{x: 1}}\n"
        f"configurations: {{all: [{', '.join(PROBES + [f't{n}' for n in range(N)])}]}}\nstart: all\n")
OBSERVERS = {"alone": None, "control": None, "status": {"to": "status", "period_ms": 100},
             "tap": {"to": "tap", "variables": [f"y{n}" for n in range(N)]}}


def look_on(client):
    """Bytes that arrive in SECONDS."""
    received, end = [], time.monotonic() + SECONDS
    client.socket.settimeout(0.05)
    while time.monotonic() < end:
        try:
            received.append(client.socket.recv(1 << 20))
        except TimeoutError:
            pass
    return b"".join(received)


def from_ns(b):
    """The middle of a bin of t_delays."""
    return (16.5 + b % 16) * 2 ** (b // 16) * 16


def percentile(counts, share):
    left = share * sum(counts)
    for b, n in enumerate(counts):
        left -= n
        if left <= 0:
            return from_ns(b) / 1e3
    raise AssertionError("nothing was counted")


def window(system, subscription):
    """(p50, p99 in us, what came)"""
    came, client = b"", None
    if subscription is not None:
        client = Client(system.socket)
        client.call("subscribe", **subscription)
    system.signal("on", *PROBES)
    if client is None:
        time.sleep(SECONDS)
    else:
        came = look_on(client)
    system.signal("off", *PROBES)
    if client is not None:
        client.close()
    read = system.call("get", variables=[f"of_{name}" for name in PROBES])["values"]
    counts = [sum(bins) for bins in zip(*(value["value"] for value in read.values()))]
    assert sum(counts) > 3 * SECONDS * 900, f"the tasks did not run: {sum(counts)}"
    return percentile(counts, 0.5), percentile(counts, 0.99), came


def rows_of(came):
    """(rows, lost rows) of the whole messages in what a tap brought."""
    rows = lost = 0
    for line in came.split(b"\n")[:-1]:
        message = json.loads(line).get("params", {})
        rows += len(message.get("rows", []))
        lost += message.get("lost", 0)
    return rows, lost


def measure():
    """{observer: [(p50, p99)]}, rows of the tap, lost ones."""
    found = {name: [] for name in OBSERVERS}
    rows = lost = 0
    for _ in range(SYSTEMS):
        with System(TEXT, ("--priority", "80")) as system:
            system.signal("off", *PROBES)
            for _ in range(TURNS):
                for name, asked in OBSERVERS.items():
                    middle, high, came = window(system, asked)
                    assert asked is None or len(came) > 1000, f"{name}: only {len(came)} bytes came"
                    found[name].append((middle, high))
                    if name == "tap":
                        more, gone = rows_of(came)
                        rows, lost = rows + more, lost + gone
    return found, rows, lost


FOUND, ROWS, LOST = measure()
WINDOWS = SYSTEMS * TURNS
for name, what in (("status", "status at 100 ms"), ("tap", f"a tap of {N} variables")):
    for which, share in ((0, "p50"), (1, "p99")):
        ratios = {other: sorted(seen[which] / alone[which] for seen, alone in zip(FOUND[other], FOUND["alone"]))
                  for other in ("control", name)}
        ratio, limit = statistics.median(ratios[name]), ratios["control"][WINDOWS * 9 // 10]
        print(json.dumps({"row": 18, "what": f"start delay under {what}, {share}", "unit": "us",
                          "figure": round(statistics.median(seen[which] for seen in FOUND[name]), 1),
                          "baseline": round(statistics.median(seen[which] for seen in FOUND["alone"]), 1),
                          "baseline_name": "no observer", "ratio": round(ratio, 3), "limit": round(limit, 3),
                          "goal": "within the A/A spread", "met": ratio <= limit,
                          "aa_spread": round(limit - ratios["control"][WINDOWS // 10], 3), "n": WINDOWS}))
RATE = ROWS / (WINDOWS * SECONDS)
print(json.dumps({"row": 18, "what": f"rows of the tap a second, {LOST} lost", "unit": "1/s", "figure": round(RATE),
                  "baseline": 1000 * N, "baseline_name": "published", "ratio": round(RATE / (1000 * N), 3),
                  "goal": "all but the last message, 0 lost", "met": LOST == 0 and RATE > 900 * N, "n": ROWS}))
