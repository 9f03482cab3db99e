# SPDX-License-Identifier: Apache-2.0
# Needs: demo chimera-web component_gain_files
"""Row 22, the page on a subsystem of 100 tasks, with 200 values in its picture ten times a second, in Debian's Chromium
without a GPU. Figures: time from the request to the first box; its files, compressed; mean time of a frame at rest and
while the picture is panned, beside an empty page in the same browser, in turn; processor time of the manager and of
chimera-web; response of the tasks with and without a page; time from the death of the manager to the page with the next
one; time from Enter in a field of the draft of these tasks to the picture with its verdict."""
import gzip
import json
import os
import pathlib
import signal
import statistics
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(os.environ["CHIMERA_SOURCE"]) / "tests" / "page" / "harness"))
from browser import Browser  # noqa: E402
from machine import Machine  # noqa: E402
from page import Page  # noqa: E402
from web import BUILD, Web  # noqa: E402

N, TURNS, LOADS, SECONDS, CPU_SECONDS, EDITS, PAUSE = 100, 5, 5, 3, 10, 60, 0.5
TASKS = "".join(f"  t{n}: {{component: gain, rtpu: unit, rate: 1 kHz, alias: {{x: x, y: y{n}}}}}\n" for n in range(N))
TEXT = (f"subsystem: subject\nrtpus: {{unit: {{cpu: 1, policy: edf}}}}\ntasks:\n{TASKS}operator: {{x: 1}}\n"
        f"configurations: {{all: [{', '.join(f't{n}' for n in range(N))}]}}\nstart: all\n")
FRAMES = """
    const done = arguments[0], times = [], place = document.querySelector('.canvas'), end = performance.now() + %d;
    const frame = now => {
      times.push(now);
      if (place && %s) place.scrollBy(0, times.length %% 200 < 100 ? 9 : -9);
      if (now < end) requestAnimationFrame(frame);
      else done((times[times.length - 1] - times[0]) / (times.length - 1));
    };
    requestAnimationFrame(frame);"""
FIRST_BOX = """new MutationObserver((_, observer) => {
  if (!document.querySelector('g.box')) return;
  observer.disconnect();
  window.firstBox = performance.now();
}).observe(document, {childList: true, subtree: true});"""
BACK = """
    const [began, old, done] = arguments, root = document.documentElement;
    const look = () => root.dataset.manager !== old && root.dataset.door === 'open' ? done(performance.now() - began)
      : setTimeout(look, 5);
    look();"""

EDIT = """
    const [words, isFaulty, done] = arguments, field = document.querySelector('input[data-link="t50 x"]');
    Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set.call(field, words);
    field.dispatchEvent(new Event('input', {bubbles: true}));
    new MutationObserver((_, observer) => {
      if (document.querySelector('[data-port="t50 x"]').classList.contains('faulty') !== isFaulty) return;
      observer.disconnect();
      requestAnimationFrame(() => setTimeout(() => done(performance.now() - window.began)));  // behind the drawn frame
    }).observe(document, {attributes: true, childList: true, subtree: true});
    requestAnimationFrame(() => setTimeout(() => {
      window.began = performance.now();
      field.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true}));
    }));"""


def tell(what, figure, unit, goal, met, n, **more):
    print(json.dumps({"row": 22, "what": what, "unit": unit, "figure": round(figure, 3), "goal": goal, "met": met,
                      "n": n, **more}))


def frames(page, link, browser):
    """Mean time of a frame in ms: of the page at rest, of the page while it is panned, of an empty page; in turn."""
    found = {"rest": [], "panned": [], "empty": []}
    for _ in range(TURNS):
        page.open(link)
        page.await_open()
        for what, moves in (("rest", "false"), ("panned", "true")):
            found[what].append(browser.driver.execute_async_script(FRAMES % (SECONDS * 1000, moves)))
        browser.driver.get("data:text/html,<p>empty")
        found["empty"].append(browser.driver.execute_async_script(FRAMES % (SECONDS * 1000, "false")))
    empty = statistics.median(found["empty"])
    for what, most in (("rest", 1.2), ("panned", 1.3)):
        ratio = statistics.median(one / other for one, other in zip(found[what], found["empty"]))
        tell(f"mean frame, {what}", statistics.median(found[what]), "ms", f"<= {most} of an empty page", ratio <= most,
             TURNS, baseline=round(empty, 3), baseline_name="empty page", ratio=round(ratio, 3))


def loads(page, link, browser):
    browser.command("Page.addScriptToEvaluateOnNewDocument", source=FIRST_BOX)
    times = []
    for _ in range(LOADS):
        browser.command("Network.clearBrowserCache")
        page.open(link)
        page.await_open()
        times.append(page.script("return window.firstBox"))
    tell("first box of a cold load, worst", max(times), "ms", "<= 1000 ms", max(times) <= 1000, LOADS)


def files():
    first = [path for path in sorted((BUILD / "page").iterdir()) if path.name != "library.js"]  # loaded later
    size = sum(len(gzip.compress(path.read_bytes(), 9)) for path in first)
    tell("files of the page for its first box, compressed", size / 1e3, "KB", "<= 120 KB", size <= 120_000, 1)


def cpu_seconds(pid):
    """Processor time of a process in s."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def load_of(pids):
    before = {name: cpu_seconds(pid) for name, pid in pids.items()}
    time.sleep(CPU_SECONDS)
    for name, most in (("manager", 5), ("chimera-web", 3)):
        share = 100 * (cpu_seconds(pids[name]) - before[name]) / CPU_SECONDS
        tell(f"{name} under one page", share, "% of a CPU", f"<= {most} %", share <= most, 1)


def back(machine, page, browser):
    times = []
    for _ in range(3):
        pid = machine.call("hello")["manager"]["pid"]
        began, old = page.script("return [performance.now(), document.documentElement.dataset.manager]")
        os.kill(pid, signal.SIGKILL)
        times.append(browser.driver.execute_async_script(BACK, began, old))
    tell("back after the death of the manager, worst", max(times), "ms", "<= 2000 ms", max(times) <= 2000, 3)


def edits(page, link, browser):
    """Alternates a link between its variable and one without a producer. After the pause the offers are there."""
    page.open(link)
    page.click('[data-mode-button="assemble"]')
    page.await_root("verdict", "legal")
    page.choose("t50")
    page.one('input[data-link="t50 x"]')
    times = []
    for n in range(EDITS):
        times.append(browser.driver.execute_async_script(EDIT, ("nowhere", "x")[n % 2], n % 2 == 0))
        time.sleep(PAUSE)
    times.sort()
    p95 = times[round(0.95 * EDITS) - 1]
    tell("edit to the drawn verdict, 100 tasks, p95", p95, "ms", "< 100 ms", p95 < 100, EDITS,
         p50=round(statistics.median(times), 3), worst=round(times[-1], 3))


def response(machine):
    """Mean time from release to end of all jobs of a window, in us."""
    def sums():
        spreads = [task["response_ns"] for task in machine.call("profile")["tasks"]]
        return sum(one["count"] for one in spreads), sum(one["count"] * one["mean"] for one in spreads)
    count, total = sums()
    time.sleep(SECONDS)
    later, end = sums()
    return (end - total) / (later - count) / 1e3


def jitter(machine, page, link, browser):
    """Responses without a page twice, and with one, in turn: does a page delay the jobs more than chance does?"""
    alone, again, watched = [], [], []
    for _ in range(TURNS):
        browser.driver.get("data:text/html,<p>empty")
        alone.append(response(machine))
        again.append(response(machine))
        page.open(link)
        page.await_open()
        watched.append(response(machine))
    spread = max(max(a, b) / min(a, b) for a, b in zip(alone, again))
    ratio = statistics.median(w / min(a, b) for w, a, b in zip(watched, alone, again))
    tell("mean response of 100 tasks under one page", statistics.median(watched), "us",
         f"<= {spread:.3f}, the A/A spread, of none", ratio <= spread, TURNS,
         baseline=round(statistics.median(alone), 3), baseline_name="no page", ratio=round(ratio, 3))


def main():
    with tempfile.TemporaryDirectory() as home:
        runtime = pathlib.Path(home) / "run"
        runtime.mkdir(mode=0o700)
        with Machine(runtime, TEXT, "subject", ("--priority", "50")) as machine, Web(runtime) as web:
            browser = Browser()
            try:
                browser.new_tab()
                page = Page(browser)
                files()
                loads(page, web.link, browser)
                frames(page, web.link, browser)
                page.open(web.link)
                page.await_open()
                load_of({"manager": machine.call("hello")["manager"]["pid"], "chimera-web": web.process.pid})
                jitter(machine, page, web.link, browser)
                back(machine, page, browser)
                with Web(runtime, [machine.file]) as bench:
                    edits(page, bench.link, browser)
            finally:
                browser.close()


main()
