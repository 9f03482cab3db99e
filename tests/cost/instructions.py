# SPDX-License-Identifier: Apache-2.0
"""Counts the instructions of a job: a long run less a short one, under valgrind, divided by the jobs between them. The
count repeats to the instruction whatever else the machine does. It is held to instructions.txt, and only falls: where
it is smaller the file is to say so (--write), where it is larger the change needs a decision that names what it buys.

  instructions.py [--write] BUILD"""
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
LIMITS = HERE / "instructions.txt"
SHORT_MS, LONG_MS, TASKS = 200, 1200, 10
ROUNDING = 1.0  # what a compiler's patch release may move


def counted(command, environment):
    """(instructions, standard output) of one run."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/%p", *command],
                              capture_output=True, text=True, env=environment, stdin=subprocess.DEVNULL, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{' '.join(command)}: exit {done.returncode}\n{done.stdout}{done.stderr}")
        # Of several processes the one that ran the jobs counts; the other waits for it.
        found = [re.search(r"^(?:summary|totals): (\d+)", file.read_text(encoding="utf-8"), re.M)
                 for file in pathlib.Path(folder).iterdir()]
        return max(int(one[1]) for one in found if one), done.stdout


def of_program(build, how):
    """Instructions a job of tests/cost/jobs.cc."""
    program = str(build / "tests" / "cost" / "cost_jobs")
    short, n_short = counted([program, how, str(SHORT_MS)], os.environ)
    long, n_long = counted([program, how, str(LONG_MS)], os.environ)
    return (long - short) / (int(n_long) - int(n_short))


def of_command(build):
    """Instructions a job of `chimera run --virtual`: the command as users have it, ten gains in a chain."""
    tasks = "".join(f"  g{i}: {{component: gain, rate: 1 kHz, alias: {{x: v{i}, y: v{i + 1}}}, constants: {{k: 1}}}}\n"
                    for i in range(TASKS))
    with tempfile.TemporaryDirectory() as folder:
        chain = pathlib.Path(folder) / "chain.yaml"
        chain.write_text(f"subsystem: chain\nrtpus: {{u: {{cpu: 0}}}}\ntasks:\n{tasks}operator: {{v0: 1 V}}\n",
                         encoding="utf-8")
        environment = dict(os.environ, CHIMERA_PATH=str(build / "components"))
        # Equally many characters, so that nothing but the jobs differs. Progress by the wall clock adds instructions,
        # more of them on a busy machine: the least of some runs counts.
        def run(ms):
            words = [str(build / "bin" / "chimera"), "run", str(chain), "--virtual", "--for", f"{ms} ms"]
            return counted(words, environment)[0]
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            short, long = (min(pool.map(run, [ms] * 2)) for ms in (2000, 9000))
            for _ in range(3):
                if judge("", (long - short) / (7000 * TASKS), read_limits()["run_virtual"]) is None:
                    break
                short, long = (min(before, run(ms)) for before, ms in ((short, 2000), (long, 9000)))
    return (long - short) / (7000 * TASKS)


def figures(build):
    yield "run_virtual", of_command(build)
    programs = ("virtual", "executive", "preemptive")
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        yield from zip(programs, pool.map(lambda how: of_program(build, how), programs), strict=True)


def read_limits():
    lines = [line.split() for line in LIMITS.read_text(encoding="utf-8").splitlines() if line and line[0] != "#"]
    return {name: float(number) for name, number in lines}


def judge(name, count, limit):
    """The complaint about one figure, or nothing."""
    if count > limit + ROUNDING:
        return f"{name}: {count:.1f} instructions a job, {limit:.1f} are allowed: find what was added to every job"
    if count < limit - ROUNDING:
        return f"{name}: {count:.1f} instructions a job, {limit:.1f} were allowed: make it the limit (--write)"
    return None


def write(measured):
    head = [line for line in LIMITS.read_text(encoding="utf-8").splitlines() if line.startswith("#")]
    rows = [f"{name} {count:.1f}" for name, count in measured.items()]
    LIMITS.write_text("\n".join(head + rows) + "\n", encoding="utf-8")


def main(arguments):
    build = pathlib.Path(arguments[-1])
    measured = dict(figures(build))
    for name, count in measured.items():
        print(f"{name}: {count:.1f} instructions a job")
    if "--write" in arguments:
        write(measured)
        return 0
    limits = read_limits()
    if limits.keys() != measured.keys():
        print(f"{LIMITS.name} has {sorted(limits)}, counted were {sorted(measured)}")
        return 1
    complaints = [c for c in (judge(name, count, limits[name]) for name, count in measured.items()) if c]
    print("\n".join(complaints))
    return 1 if complaints else 0


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1:]))
