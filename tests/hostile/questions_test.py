# SPDX-License-Identifier: Apache-2.0
"""Commands are answered beside the most costly questions that all other connections may ask, and values of 4 MiB are
answered whole. How long that takes: bench row 21."""
import json
import pathlib
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "processes"))
from costly import LARGE_VALUES, Load, loops, request, worst, worst_of_values  # noqa: E402, I100
from system import TWO_RTPUS, Client, System, await_that, duration  # noqa: E402


def analysts(system):
    """Pids of the processes of this system that answer questions about descriptions."""
    return system.named("chimera-analyst")


def acts(system):
    for method, parameters in (("signal", {"signal": "off", "tasks": ["beside"]}), ("flag", {"up": True}),
                               ("flag", {"up": False})):
        began = time.monotonic()
        system.call(method, **parameters)
        duration(f"the answer to {method}", time.monotonic() - began)


def acts_are_answered_beside(system, asked, begun):
    with Load(system.socket, asked) as load:
        await_that(lambda: begun(load), "the load")
        for _ in range(5):
            acts(system)
        await_that(lambda: load.answers > 0, "an answer to a question")
    assert system.state("beside") == "OFF"


def large_values_are_answered_whole(system):
    """Made while they are sent, they are what was asked for, and what is asked behind them is answered behind them."""
    client = Client(system.socket)
    client.socket.sendall(request("get") + request("hello"))
    values = client.line()["result"]["values"]
    assert [len(values[name]["value"]) for name in "abg"] == [65536] * 3, values.keys()
    assert values["b"]["value"][65535] == 0.2 and values["b"]["text"].startswith("[0.2 0.2 "), values["b"]["text"][:99]
    assert values["b"]["text"].endswith(" 0.2] m") and values["l"]["value"][0] is False
    assert {*values["a"]} == {*values["n"]} and values["n"]["valid"]
    assert client.line()["result"]["subsystem"] == "subject"
    client.socket.sendall(request("subscribe", to="values", period_ms=20, variables=["c", "n"]))
    opened = client.line()["result"]["subscription"]
    for _ in range(3):
        note = client.line()
        assert note["method"] == "values" and note["params"]["subscription"] == opened, note.keys()
        assert note["params"]["values"]["c"]["value"][0] == 0.3 and note["params"]["at_ns"] > 0
    client.close()
    words = system.chimera("get", "a")
    assert words.stdout.count("0.1") == 65536, words.stdout[:200] + words.stderr
    reason = system.call("why", variable="sum")
    assert len(json.dumps(reason)) < 10_000 and "65536 elements" in json.dumps(reason), json.dumps(reason)[:1000]


def it_ends_in_order_while_an_analysis_is_under_way(system):
    with Load(system.socket, [(b"".join(worst()[0][:1]), 2, 2)]):
        await_that(lambda: analysts(system), "an analysis")
        system.call("end", code=0)
        assert system.wait() == 0, system.said()
    system.await_nothing_left()


def main():
    with System(TWO_RTPUS) as system:
        acts_are_answered_beside(system, worst(), lambda _: analysts(system))
        system.call("check", text=loops(inputs=1, configurations=1)[:-5])  # is not refused
        it_ends_in_order_while_an_analysis_is_under_way(system)
    with System(LARGE_VALUES) as system:
        large_values_are_answered_whole(system)
        acts_are_answered_beside(system, worst_of_values(), lambda load: load.answers > 2)


main()
