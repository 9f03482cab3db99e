#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Proves what functions on the cycle path can reach.

usage: check_cycle_path.py BUILD       BUILD: a release tree in which the floors up to runtime, and rtpu, are built

Reads the object files of floors 0 to 5 and of rtpu, follows every call and every reference from the roots of three
paths, and refuses every symbol of another library that is not on the short list of the path, naming the way to it:
  loops              of the executive and of virtual time: no heap, lock, exception, or system call but clock and wait
  preemptive jobs    from release to end, the look of the supervisor, the edges of a preemptive context: no heap, no
                     exception; system calls that change a level, set the alarm, wake and wait
  edges of an rtpu   what comes from and goes to other processes: no heap, no exception; system calls that wake and wait
Not followed: component methods and virtual calls (the clocks stand among the roots instead), and the places
below that leave the path. Planted cases, built on the spot, must be judged rightly first.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

# memory and text within given bounds; 128-bit division, bits counted; the clock and the wait
PLAIN = (r'mem(cpy|move|set|cmp|chr)|str(len|cpy|ncpy|cmp)|__(u?div|u?mod)ti3|__popcountdi2|clock_gettime'
         r'|clock_nanosleep|__errno_location|_GLOBAL_OFFSET_TABLE_|snprintf|__snprintf_chk')
WAKES = r'|syscall|write'  # futex; the descriptor of a bell
LEVELS = r'|sched_setscheduler|timerfd_settime|read|ppoll|__libc_current_sigrtmin|getpid|__rseq_offset|__tls_get_addr'
ASSERTS = {r'chimera::(assertion_failed|end_without_descriptor)\(': 'ends the program'}
# on and off begin and end background methods, spawn runs init; for the others no_heap_test.cc counts
SIGNALS = {r'chimera::BoundarySignals::(carry_out|signal|finish_slow)\(': 'a signal at an edge'}
# Vectors within the room reserved at setup, which cannot be seen here; no_heap_test.cc and
# rtpu_control_no_heap_test.cc count.
RESERVED = {r'chimera::LabelList::set\(|(void )?std::vector<chimera::LabelledJob': 'a place for every task',
            r'chimera::PeerLinks::watch_flags\(': 'a place for every peer'}


class Path:
    """Functions that `roots` may reach: names that match `allowed`. `leaves` {pattern: why} are not followed."""

    def __init__(self, name, roots, allowed, leaves):
        self.name, self.roots, self.leaves = name, roots, leaves
        self.allowed = re.compile(f'^({allowed})$')


PATHS = (
    Path('loops', [r'chimera::Executive::run\(', r'chimera::VirtualExecutor::run\(', r'chimera::LinuxClock::',
                   r'chimera::CycleCounter::(now|compare)\(', r'chimera::.anonymous namespace.::host_',
                   r'chimera::Tap::append(_row)?\('],
         PLAIN, ASSERTS | SIGNALS),
    Path('preemptive jobs',
         [r'chimera::JobLoop::(run|run_job|run_body)\(', r'chimera::Supervisor::check_jobs\(',
          r'chimera::PreemptiveExecutor::(run_edge|enter_with_look_ups)\(',
          r'chimera::EdgeAccess::(claim|used_by_job|is_blocked|call)\('],
         PLAIN + WAKES + LEVELS,
         ASSERTS | SIGNALS | RESERVED | {r'chimera::enter_realtime\(': 'the start of a thread',
                                         r'chimera::use_decimal_point\(': 'the start of a thread',
                                         r'chimera::Processor::check(_holder)?\(': 'in tests only',
                                         r'chimera::EdgeAccess::look_up_blocked\(': 'outside the section'}),
    Path('edges of an rtpu', [r'chimera::RtpuControl::(take|publish|told|show|show_profiles|missed|gave_way|hangs'
                              r'|stop_all)\(',
                              r'chimera::(Doorbell|Outbox)::'],
         PLAIN + WAKES,
         ASSERTS | SIGNALS | RESERVED | {r'chimera::RtpuEnd::is_awaited\(': 'once the rtpu ends'}),
)


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


class Graph:
    """Functions of object files and what each refers to. Functions that are local to a file are kept apart."""

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
            for path in PATHS:
                found = graph.complaints([r'chimera::Executive::run\('], path.allowed, path.leaves)[2]
                if bool(found) != expected:
                    sys.exit(f'the check itself is broken: {body!r} gave {found} among {path.name}')
    return 3 * len(PATHS)


def main():
    cases = planted()
    graph, n = Graph(), 0
    for floor in ('base', 'platform', 'table', 'task', 'schedule', 'runtime', 'rtpu'):
        for path in sorted(pathlib.Path(sys.argv[1], 'chimera', floor).rglob(f'chimera_{floor}.dir/**/*.o')):
            graph.add(str(path))
            n += 1
    failed = False
    for path in PATHS:
        roots, reached, found = graph.complaints(path.roots, path.allowed, path.leaves)
        for complaint in found:
            print(f'{path.name}: the path reaches {complaint}')
        for root in path.roots:
            if not any(re.match(root, name) for name in run_filter(roots)):
                found.append(root)
                print(f'{path.name}: no function is called {root}: is the tree built?')
        failed = failed or bool(found)
        print(f'{path.name}: {reached} functions and symbols reached from {len(roots)} roots')
    if failed:
        sys.exit(1)
    print(f'{n} object files: no heap, no exception, no system call but those of each path; '
          f'{cases} planted cases judged rightly')


if __name__ == '__main__':
    main()
