# SPDX-License-Identifier: Apache-2.0
"""`chimera bake` runs `init` of each task and refuses what a component refuses; a crash of a component is a refusal.
usage: desk_init_test.py BUILD_TREE"""
import os
import pathlib
import subprocess
import sys
import tempfile

TARGET = "version: 1\nlike: mps2-an385\n"


def bake(tree, folder, tasks, target=""):
    (folder / "d.yaml").write_text("version: 1\nsubsystem: desk\ntasks:\n" + tasks)
    (folder / "board.yaml").write_text(TARGET + target)
    environment = dict(os.environ, ASAN_OPTIONS="detect_leaks=0:handle_segv=0", CHIMERA_PATH=str(tree / "components"))
    out = folder / f"out{len(list(folder.iterdir()))}"
    command = [tree / "bin" / "chimera", "bake", folder / "d.yaml", "--target", folder / "board.yaml", "--out", out]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, stdin=subprocess.DEVNULL)
    return done, out.is_dir()


def main():
    tree = pathlib.Path(sys.argv[1]).resolve()
    found = []

    def expect(name, done, is_written, code, words):
        said = done[0].stdout + done[0].stderr
        if done[0].returncode != code or done[1] != is_written or any(each not in said for each in words):
            found.append(f"{name}: exit {done[0].returncode}, files {done[1]}:\n{said}")

    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        expect("all agree", bake(tree, folder, "  a: {component: t_refuses}\n"), True, 0, ["baked into"])
        expect("two refuse", bake(tree, folder, "  a: {component: t_refuses, constants: {where: init}}\n"
                                                "  b: {component: t_refuses, alias: {count: m}}\n"
                                                "  c: {component: t_refuses, alias: {count: n}, "
                                                "constants: {where: init}}\n"),
               False, 1, ["d.yaml: error: task 'a': 'init' refuses: refused on demand",
                          "d.yaml: error: task 'c': 'init' refuses: refused on demand"])
        expect("one crashes", bake(tree, folder, "  a: {component: t_crash, constants: {where: init}, "
                                                "resources: {armed: x}}\n",
                                   f"resources: {{a: {{armed: {folder}}}}}\n"),
               False, 1, ["d.yaml: error: 'init' at the desk: the run ended by signal 11 (SIGSEGV) in a.init"])
        expect("one needs the board", bake(tree, folder, "  button: {resources: {pin: x}}\n",
                                           "resources: {button: {pin: test0}}\n"),
               True, 0, ["'init' is not tried here, because it needs the board: button"])
    print("\n".join(found) or "bake refuses what init refuses")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
