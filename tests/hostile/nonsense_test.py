# SPDX-License-Identifier: Apache-2.0
"""Every command refuses nonsense - nothing, a lot, huge and negative numbers, bytes that are no UTF-8 - with an exit
code of its own, without an effect on what runs, and with `--json` in JSON.

usage: nonsense_test.py                                 a share of the calls
       nonsense_test.py --build DIR --seconds N         all of them, again and again for that time (a campaign)
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys
import time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--build", default=os.environ.get("CHIMERA_BUILD"), required="CHIMERA_BUILD" not in os.environ)
parser.add_argument("--seconds", type=float)
arguments = parser.parse_args()
os.environ["CHIMERA_BUILD"] = arguments.build
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "processes"))
from system import CHIMERA, HANG, TWO_RTPUS, System, duration  # noqa: E402

WITH_OPERATOR = TWO_RTPUS.replace("configurations:", """
  held: {component: limit, rtpu: second, rate: 10 Hz, alias: {x: wish, y: granted}, constants: {low: 0, high: 1}}
operator: {wish: 0.5}
configurations:""").replace("[steady, beside]", "[steady, beside, held]")

LONG = b"a" * 100_000  # of one argument the system takes 128 KiB
TEXTS = (b"", b" ", b"-", b"--", b"\xff", b"\xc0\xaf", b"a\nb", b"\x1b[2J", b"../../x", b"%n%s", LONG, b"[" * 1000,
         b"\xed\xa0\x80", "\u202e".encode(), b"'", b'"', b"{}", b"0", b"-1", b"1e400", b"nan", b"9" * 400)
TIMES = (b"", b"-1 s", b"0 s", b"1e-300 s", b"1e300 s", b"nan s", b"1", b"\xff s", LONG)
NUMBERS = (b"", b"-1", b"0", b"1e9", b"18446744073709551616", b"9" * 400, b"nan", b"\xff")
SHARE = 7  # no divisor of the calls of a text: each word meets most texts, some of them with --json


def calls():
    """Arguments of all calls. None of them is legal."""
    for text in TEXTS:
        for word in ("on", "off", "kill", "spawn", "clear", "reinit", "ring", "why", "describe", "get"):
            yield (word, text)
        yield ("set", "wish", text if text not in (b"0",) else b"2 m")
        yield ("set", text, "1")
        yield ("flag", text)
        yield ("status", "--pid", text)
        yield ("events", "--since", text if text not in (b"0",) else b"-0.5")
        yield ("events", "--kind", text)
        yield ("watch", text)
        yield ("scope", text, "--for", "0.1 s")
        yield ("status", "--subsystem", text)
    for time_text in TIMES:
        yield ("get", "wish", "--every", time_text)
        yield ("scope", "wish", "--for", time_text)
        yield ("scope", "wish", "--for", "0.1 s", "--wait", time_text)
        if time_text != b"0 s":  # a legal duration before the trigger
            yield ("scope", "wish", "--for", "0.1 s", "--pre", time_text)
    for number in NUMBERS:
        yield ("end", "--code", number)
        yield ("events", "--since", number if number != b"0" else b"x")


def said_of(system, words):
    """What is wrong with the answer to these arguments; "": nothing."""
    place = () if "--subsystem" in words else ("--subsystem", str(system.socket))
    try:
        got = subprocess.run([str(CHIMERA), *words, *place], capture_output=True, timeout=HANG, cwd=system.place,
                             env=system.environment, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return "it does not end"
    if got.returncode not in (0, 1, 2):
        return f"exit code {got.returncode}: {got.stderr[-500:]}"
    if b"\x1b" in got.stdout + got.stderr or b"terminate called" in got.stderr or b"runtime error" in got.stderr:
        return f"it says {(got.stdout + got.stderr)[:500]}"
    if got.returncode == 1 and "--json" in words and b"--" not in words:  # behind it stand no options
        try:
            json.loads(got.stdout)
        except ValueError:
            return f"it is no JSON: {got.stdout[:200]}"
    return ""


def judged(system, chosen):
    """[(arguments, what is wrong)] of those whose answer is."""
    before, pids = system.call("status"), system.pids()
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        wrong = [(words, said) for words, said in
                 zip(chosen, pool.map(lambda words: said_of(system, words), chosen), strict=True) if said]
    for words, said in wrong:
        print([str(word)[:60] for word in words], said)
    after = system.call("status")
    assert [t["state"] for t in after["tasks"]] == [t["state"] for t in before["tasks"]], after["tasks"]
    assert system.pids() == pids and after["flag"] == before["flag"], after["flag"]
    assert os.path.exists(system.socket)
    return wrong


def main():
    all_calls = [(*words, *more) for words in calls() for more in ((), ("--json",))]
    began, n, faults = time.monotonic(), 0, 0
    with System(WITH_OPERATOR) as system:
        while True:
            chosen = all_calls if arguments.seconds else all_calls[::SHARE]
            faults += len(judged(system, chosen))
            n += len(chosen)
            if arguments.seconds is None or time.monotonic() - began > arguments.seconds:
                break
    duration(f"{n} calls of nonsense", time.monotonic() - began)
    if arguments.seconds:
        print(json.dumps({"n": n, "faults": faults}))
    sys.exit(faults > 0)


main()
