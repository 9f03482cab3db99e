# SPDX-License-Identifier: Apache-2.0
"""The digests of applications are those that are pinned here, each time, and differ where a run differs. A change of a
pinned one changes what an application does. usage: digest_test.py PROGRAM SOURCE"""
import hashlib
import os
import pathlib
import subprocess
import sys
import tempfile

CAR = "examples/02_cruise_control/"
SERVO = "tests/applications/servo.yaml"
SWITCHES = ("--at", "20 s: switch two_modules", "--at", "30 s: switch one_module", "--at", "40 s: switch override")
PINNED = {
    (CAR + "cruise_control.yaml", "60 s"):
        "a4451b9b8e4ca687489205f29202543066f8f2b637b7807d5d96d46a5c2d102d",
    (CAR + "pedals.yaml", "70 s"):
        "8549c261d9a509a9500a39010107607d65e9b1ec2162d0e1efad652feaf34280",
    (CAR + "variants.yaml", "60 s", *SWITCHES):
        "4e6be2071a0b0f9f76dc2860e5bd1f65e06d93b4e61795119b71497b110ca986",
    (SERVO, "2 s", "--expect", "max |q[0]| <= 1.01 rad", "--expect", "q[1] <= -0.499 rad"):
        "b2beae26806a28a370f93fd21fef53daefd0874e1c02fb3d7afa746e142cce1e",
}
CRUISE = next(iter(PINNED))
OTHERS = (
    (CRUISE[0], "60 s", "--set", "car.mass", "1600.0000000000002 kg"),
    (CRUISE[0], "60.001 s"),
    (CRUISE[0], "60 s", "--at", "59.9 s: off dashboard"),
)


def digest(program, source, file, duration, *words):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, "digest.txt")
        done = subprocess.run([program, "run", source / file, "--virtual", "--for", duration, "--digest", path, *words],
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{file}: exit {done.returncode}\n{done.stdout}{done.stderr}")
        return hashlib.sha256(path.read_bytes()).hexdigest()


def complaints(program, source):
    for run, pinned in PINNED.items():
        found = digest(program, source, *run)
        if found != pinned:
            yield f"{run[0]}: the digest has the SHA-256 {found}, pinned is {pinned}"
    if digest(program, source, *CRUISE) != digest(program, source, *CRUISE):
        yield f"{CRUISE[0]}: two runs give two digests"
    for run in OTHERS:
        if digest(program, source, *run) in PINNED.values():
            yield f"{' '.join(run)}: the digest is that of another run"


def main():
    program, source = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
    found = list(complaints(program, source))
    print("\n".join(found) or f"{len(PINNED)} digests are as pinned, {len(OTHERS)} others differ")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
