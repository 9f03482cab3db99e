#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The commands and options that `chimera --help` names, the manual and the completion are the same, each way; README.md
names the commands without --json.

usage: words.py PROGRAM SOURCE PAGES

PAGES is the folder of the manual and the completion as they are installed
"""
import pathlib
import re
import subprocess
import sys


def help_of(program, words):
    return subprocess.run([program, *words, "--help"], capture_output=True, text=True, check=True).stdout


def said_by_help(program, words=()):
    """Maps "" and every command ("new component") to its options and subcommands in `--help`."""
    text = help_of(program, words)
    options = set(re.findall(r"^\s+(?:-\w,\s*)?(--[a-z-]+)", text, re.MULTILINE))
    heading = re.search(r"^Commands:\n", text, re.MULTILINE)
    commands = re.findall(r"^  ([a-z]+)\b", text[heading.end():], re.MULTILINE) if heading else []
    said = {" ".join(words): options | set(commands)}
    for command in commands:
        said |= said_by_help(program, (*words, command))
    return said


def said_by_manual(text):
    """A section .SS holds one command; its options are the tagged paragraphs (.TP). OPTIONS belongs to no command."""
    said = {"": set()}
    commands, options = text.split(".SH COMMANDS", 1)[1].split(".SH OPTIONS", 1)
    tagged = r"^\.TP\n\.BI? (\\-\\-\S+)"
    for section in commands.split("\n.SS ")[1:]:
        name, body = section.split("\n", 1)
        said.setdefault(name, set()).update(word.replace("\\", "") for word in re.findall(tagged, body, re.MULTILINE))
        said.setdefault(name.rpartition(" ")[0], set()).add(name.rpartition(" ")[2])
    options = options.split(".SH ", 1)[0]
    said[""] |= {word.replace("\\", "") for word in re.findall(tagged, options, re.MULTILINE)}
    return said


def said_by_completion(path, commands):
    said = {}
    for command in commands:
        script = 'source "$1"; _chimera_words "$2"'
        run = subprocess.run(["bash", "-c", script, "bash", str(path), command], capture_output=True, text=True,
                             check=True)
        said[command] = set(run.stdout.split())
    return said


def complete(path, program, words):
    """Completions of bash for the last of `words`."""
    script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _chimera; '
              'printf "%s\\n" "${COMPREPLY[@]}"')
    run = subprocess.run(["bash", "-c", script, "bash", str(path), program, *words], capture_output=True, text=True,
                         check=True)
    return set(run.stdout.split())


def differences(what, said, wanted):
    for command in sorted(said.keys() | wanted.keys()):
        have, want = said.get(command, set()), wanted.get(command, set())
        for word in sorted(want - have):
            yield f"chimera {command}: {word} is not in the {what}"
        for word in sorted(have - want):
            yield f"chimera {command}: {word} is in the {what} only"


def lost_lines(manual):
    """Lines that roff takes for a macro, and prints nothing of."""
    for line in manual.splitlines():
        if re.match(r"[.'](?!\\\"|(TH|SH|SS|TP|B|BI|BR|I|IR|RB|br|nf|fi)\b)", line):
            yield f"the manual loses the line: {line}"


def without_json(wanted, readme):
    """README.md says "all but `a`, `b` and `c` have `--json`": of commands that have no commands of their own."""
    found = {command.split()[0] for command, words in wanted.items() if command and "--json" not in words
             and not any(other.startswith(command + " ") for other in wanted)}
    sentence = re.search(r"all but ((?:`[a-z]+`(?:, | and )?)+) have `--json`", re.sub(r"\s+", " ", readme))
    told = set(re.findall(r"`([a-z]+)`", sentence[1])) if sentence else set()
    for command in sorted(found ^ told):
        wrong = "does not name it as one" if command in found else "says so"
        yield f"chimera {command} has {'no ' if command in found else ''}--json, README.md {wrong} without"


def main():
    program, source, pages = sys.argv[1], *map(pathlib.Path, sys.argv[2:])
    completion, manual = pages / "chimera.bash", (pages / "chimera.1").read_text()
    wanted = said_by_help(program)
    faults = list(differences("manual", said_by_manual(manual), wanted))
    faults += differences("completion", said_by_completion(completion, wanted), wanted)
    if "run" not in wanted or "--virtual" not in wanted["run"] or "--c" not in wanted.get("new component", ()):
        faults.append(f"the help was not understood: {wanted}")
    for words, offered in ((["de"], {"describe"}), (["check", "--gr"], {"--graph"}),
                           (["check", "--graph", "d"], {"dot"}), (["new", "c"], {"component"}),
                           (["run", "--seed", ""], set()), (["describe", "gai"], {"gain"}),
                           (["test", "--se"], {"--seed", "--setup"}),
                           (["test", "gai"], {"gain"}), (["flag", "u"], {"up"}), (["new", "app", ""], set()),
                           (["run", "--isolation", "n"], {"none"}), (["list", ""], set()),
                           (["watch", "--every", ""], set()), (["--json", "de"], {"describe"}),
                           (["--subsystem", ""], set()), (["--subsystem", "a", "--json", "flag", "u"], {"up"}),
                           (["--subsystem", "=", "a", "new", "c"], {"component"})):
        if (got := complete(completion, program, words)) != offered:
            faults.append(f"completion of {words}: {sorted(got)}, expected {sorted(offered)}")
    faults += lost_lines(manual)
    faults += without_json(wanted, (source / "README.md").read_text())
    for fault in faults:
        print(fault)
    print(f"{sum(map(len, wanted.values()))} words of {len(wanted)} commands, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
