#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Proves that no function on the cycle path can reach the heap, a lock, an exception or a system call.

usage: check_cycle_path.py BUILD       BUILD: a release tree in which the floors up to runtime are built

Reads the object files of floors 0 to 5, follows every call and every reference from the loops of the executors,
and refuses every symbol of another library that is not on the short list below, naming the way to it.
Not followed: component methods and virtual calls (the clocks stand among the roots instead), and the places
below that leave the cycle path. Three planted cases, built on the spot, must be judged rightly first.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

ROOTS = [r'chimera::Executive::run\(', r'chimera::VirtualExecutor::run\(', r'chimera::LinuxClock::',
         r'chimera::CycleCounter::(now|compare)\(', r'chimera::TaskSet::host_', r'chimera::Tap::append(_row)?\(']
# memory and text within given bounds; 128-bit division, bits counted; the clock and the wait
ALLOWED = re.compile(r'^(mem(cpy|move|set|cmp|chr)|str(len|cpy|ncpy|cmp)|__(u?div|u?mod)ti3|__popcountdi2|clock_gettime'
                     r'|clock_nanosleep|__errno_location|_GLOBAL_OFFSET_TABLE_|snprintf|__snprintf_chk)$')
LEAVES = {
    r'chimera::Releases::carry_out\(': 'a signal at an edge: spawn runs init; for the others no_heap_test.cc counts',
    r'chimera::assertion_failed\(': 'ends the program',
}


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


class Graph:
    """Functions of object files and what each refers to. Local functions are told apart by their file."""

    def __init__(self):
        self.refers = {}
        self.alias = {}  # other names of a function

    def add(self, path):
        functions, places = {}, {}  # (section, address) -> name
        for line in run('objdump', '-t', path).splitlines():
            m = re.match(r'^([0-9a-f]+) (.{7}) (\S+)\s+[0-9a-f]+\s+(?:\.hidden )?(\S+)$', line)
            if not m or 'F' not in m[2]:
                continue
            local = m[2].startswith('l')
            name = f'{m[4]}@{path}' if local else m[4]
            # One function may have several names (the compiler calls global ones by a local alias): one node.
            first = places.setdefault((m[3], int(m[1], 16)), name)
            if first != name:
                self.alias[name] = first
                continue
            functions.setdefault(m[3], []).append((int(m[1], 16), name))
            self.refers.setdefault(name, set())
        for starts in functions.values():
            starts.sort()

        def at(section, address):
            found = [name for start, name in functions.get(section, []) if start <= address]
            return found[-1] if found else None

        section = current = None
        for line in run('objdump', '-dr', '--no-show-raw-insn', path).splitlines():
            if m := re.match(r'^Disassembly of section (\S+):', line):
                section = m[1]
            elif m := re.match(r'^([0-9a-f]+) <(.+)>:$', line):
                current = places.get((section, int(m[1], 16)))
            elif current and (m := re.search(r'R_X86_64_\w+\s+(\S+?)([+-]0x[0-9a-f]+)?$', line)):
                if m[1] in functions:  # an offset into a section, seen from the end of a 4-byte operand
                    target = at(m[1], int(m[2] or '0', 16) + 4)
                else:
                    local = f'{m[1]}@{path}'
                    target = local if local in self.refers or local in self.alias else m[1]
                if target and not target.startswith('.'):
                    self.refers[current].add(target)
            elif current and (m := re.search(r'\b(?:call|j\w+)\s+([0-9a-f]+) <', line)):
                self.refers[current].add(at(section, int(m[1], 16)))

    def complaints(self, roots, allowed, leaves):
        names = sorted(self.refers)
        plain = dict(zip(names, run_filter(names)))
        start = [n for n in names if any(re.match(r, plain[n]) for r in roots)]
        way = {n: None for n in start}
        todo, found = list(start), []
        while todo:
            here = todo.pop()
            for there in sorted({self.alias.get(t, t) for t in self.refers[here] if t}):
                if there in way:
                    continue
                way[there] = here
                if there in self.refers:
                    if not any(re.match(r, plain[there]) for r in leaves):
                        todo.append(there)
                elif is_foreign(there) and not allowed.match(there):
                    found.append(' <- '.join(plain.get(n, demangle(n)) for n in back(way, there)))
        return start, len(way), found


def back(way, name):
    while name is not None:
        yield name
        name = way[name]


def is_foreign(name):
    """A function of another library; data of ours (tables, constants, strings) is no call."""
    return not demangle(name).startswith(('chimera::', 'vtable for', 'typeinfo', '(anonymous'))


def run_filter(names):
    text = '\n'.join(n.split('@')[0] for n in names)
    return subprocess.run(['c++filt'], input=text, check=True, capture_output=True, text=True).stdout.splitlines()


def demangle(name):
    return run_filter([name])[0]


PLANTED = '''
#include <cstdlib>
#include <new>
namespace chimera {
[[gnu::noinline]] void* deep(std::size_t n) { return %s; }
struct Executive { void* run(std::size_t n); };
void* Executive::run(std::size_t n) { return n > 3 ? deep(n) : nullptr; }
struct Setup { void* make(std::size_t n); };
void* Setup::make(std::size_t n) { return ::operator new(n); }
}
'''


def planted():
    with tempfile.TemporaryDirectory() as folder:
        for body, expected in (('std::malloc(n)', True), ('nullptr', False), ('::operator new(n)', True)):
            source, obj = f'{folder}/p.cc', f'{folder}/p.o'
            pathlib.Path(source).write_text(PLANTED % body)
            run('c++', '-std=c++20', '-O2', '-fPIC', '-fno-semantic-interposition', '-c', source, '-o', obj)
            graph = Graph()
            graph.add(obj)
            found = graph.complaints(ROOTS, ALLOWED, LEAVES)[2]
            if bool(found) != expected:
                sys.exit(f'the check itself is broken: {body!r} gave {found}')
    return 3


def main():
    cases = planted()
    graph, n = Graph(), 0
    for floor in ('base', 'platform', 'table', 'task', 'schedule', 'runtime'):
        for path in sorted(pathlib.Path(sys.argv[1], 'chimera', floor).rglob(f'chimera_{floor}.dir/**/*.o')):
            graph.add(str(path))
            n += 1
    roots, reached, found = graph.complaints(ROOTS, ALLOWED, LEAVES)
    for complaint in found:
        print(f'the cycle path reaches {complaint}')
    if n < 10 or len(roots) < 6:
        sys.exit(f'only {n} object files and {len(roots)} roots: is the tree built?')
    if found:
        sys.exit(1)
    print(f'{reached} functions and symbols reached from {len(roots)} roots in {n} object files: no heap, lock, '
          f'exception or system call; {cases} planted cases judged rightly')


if __name__ == '__main__':
    main()
