#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Plants defects in the executors, one at a time, in a copy of the source, and demands that the unit tests of the
runtime or the conformance suite catch each of them. Its last line says how many were planted and how many were missed.

usage: planted_defects.py --build TREE [--seconds N]     (every defect is planted once, however long that takes)
       planted_defects.py --build TREE --only WORDS  (those whose names have these words in them, or whose files)
       planted_defects.py --look                         (only that the text of each defect stands in its file once)
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
RUNTIME = "chimera/runtime/"
PROGRAMS = {name: f"{folder}/{name}" for folder, name in (
    ("chimera/runtime", "runtime_test"), ("tests/conformance", "conformance_test"),
    ("chimera/runtime", "runtime_process_test"), ("tests/conformance", "conformance_process_test"))}
LIMIT = 300  # seconds for one test program; one that hangs has caught the defect

# The defect in words, the file, its text, and the text with the defect.
DEFECTS = (
    ("a signal turns a task ON that takes no part in a switch", "cycle/boundary_signals.cc",
     "if (order && keeps_out(set_, *order, tasks, signal)) {", "if (false && order) {"),
    ("each event makes an active server active anew", "job/sporadic_job.cc",
     "if (!is_active_) server_.activate(now);", "server_.activate(now);"),
    ("a rest below the granularity of the clock is still capacity", "job/sporadic_job.cc", "left < smallest_", "false"),
    ("a job leaves a phase that it is not in", "preemptive/job_phase.cc",
     "  CHIMERA_ASSERT(value() == from);\n", "  (void)from;\n"),
    ("two ready jobs keep the late check of a lone one", "preemptive/job_checks.cc",
     "  if (has_coalesced_ && n_ready > 1) {", "  if (false) {"),
    ("an idle job is checked as often as a busy one", "preemptive/job_checks.cc",
     "used == last ? kMinIdleGap", "used == last ? kMinBudgetGap"),
    ("less important jobs use what is kept for the important", "preemptive/processor_share.cc",
     "std::max(kept_for_important_, by_others)", "by_others"),
    ("a job is stopped before the share is used", "preemptive/processor_share.cc",
     "used(now) >= limit_.share && ", "used(now) >= Nanoseconds{} && "),
    ("a job that has not begun counts as running", "preemptive/ready_jobs.cc",
     "if (JobThread& job = (*this)[i]; job.phase.is_running())", "if (JobThread& job = (*this)[i]; true)"),
    ("a miss is looked up again and again", "preemptive/edge_access.cc", "!look_up.is_done && ", ""),
    ("a job that was withdrawn does not come again", "preemptive/edge_access.cc",
     "    job.next_release = job.job.release;", "    //"),
    ("an edge takes the task of a job that runs", "preemptive/edge_access.cc",
     "|| !job->phase.is_free()) return nullptr;", ") return nullptr;"),
    ("a job without capacity is not halted", "preemptive/supervisor.cc", "server.halt();", ""),
    ("a job is given up twice", "preemptive/supervisor.cc", "if (of_job.is_given_up) return;", ""),
    ("a release that was passed over is not counted", "preemptive/supervisor.cc", "passed + 1)});", "passed)});"),
    ("preemptions are not counted", "preemptive/processor.cc",
     "  if (job.sporadic && job.sporadic->is_halted()) return;\n  ++job.task.profile.preempted;", ""),
    ("a leaving task is turned off before the change", "switch/switching.cc",
     "  if (agreement().propose(order_.number, at)) peers_->ring();",
     "  for (const TaskId id : plan_.leaving) {\n    (void)parts_.set.life().settle_off(id, now);\n    task(id)"
     ".state = State::kOn;\n  }\n  if (agreement().propose(order_.number, at)) peers_->ring();"),
    ("readers are bound to a task that is armed", "life/task_life.cc",
     "turns_on && !is_arming_) set_", "turns_on) set_"),
    ("an aborted switch leaves tasks armed", "switch/switching.cc", "  const std::size_t n = undoes ? next_armed_ :",
     "  const std::size_t n = undoes ? 0 :"),
    ("a job released before a switch reads the new producer", "job/job_threads.h",
     "    return mechanisms::kSwitch && (tasks_[task.index].is_busy || queue_->has_waiting(task, at));",
     "    return (void)task, (void)at, false;"),
    ("a thread's job released before a switch reads the new producer", "state/sources.cc",
     "  if (has_old_job_[consumer.index]) return;\n", ""),
    ("a thread takes a release before the change that comes after it", "preemptive/edge_access.cc",
     "job.release_end = std::min(end_, from);", "job.release_end = end_, (void)from;"),
    ("what was released before the change is released after it", "switch/changeover.cc",
     "  queue_.release_due(instant - Nanoseconds{1}, [this](const DroppedRelease& dropped) { misses_.drop(dropped); "
     "});",
     "  (void)instant;"),
    ("signals that come while a task is armed wait for the change", "switch/switching.cc",
     "  if (armed != kNever && armed > edge) {", "  if (false && armed > edge) {"),
    ("a task of a loop arms with what its partner wrote long ago", "state/sources.cc",
     "handover.variable == variable && is_armed(handover.to.task)", "(void)is_armed, handover.variable == variable"),
    ("an off that was never called waits for a gap for ten seconds", "switch/switching.cc",
     "gap_.soon() : IdleGap::kLongestWait;", "gap_.soon() : kSwitchPatience;"),
    ("virtual time goes the slow way where real threads need no gap", "cycle/releases.cc",
     "!threads_.preempt()", "true"),
    ("a switch that was only late is not tried again", "switch/switch_orders.cc",
     "why == NoSwitch::kLate && now < over.order.until;", "false;"),
    ("signals of a task that is armed go out at once", "life/task_life.cc",
     "if (!is_arming_) set_.sent()", "set_.sent()"),
    ("the step of a switch is not judged", "switch/switch_record.cc",
     "    if (part.step_of_on.is_beyond) return &part;\n", ""),
    ("a task that left by a switch is never turned off", "switch/changeover.cc",
     "    leaving.standing = Standing::kOwesOff;\n", ""),
    ("a switch goes on although a member was moved", "switch/arming.cc",
     "set.tasks()[id.index].state != State::kOn) return {NoSwitch::kDisturbed, id};", "false) return {};"),
    ("a value of another context is not looked for", "switch/switching.cc",
     "is_valid()) return wait(now, kLookForValue);", "is_valid()) return wait(now);"),
    ("a standby that is ON does not count as its primary", "plan/switch_plan.h",
     "if (spec.stand_in(task, by) && is_on(by)) return true;", "(void)by, (void)task;"),
    ("an on that fits no gap is tried for ten seconds", "plan/switch_way.cc",
     "if (needed <= longest_gap) continue;", "if (true || needed <= longest_gap) continue;"),
    ("an overwritten takeover is reported in the place of a younger one", "plan/takeover.h",
     "    if (takeover.number < oldest()) return;\n", ""),
    ("all devices have ten seconds together on the way back", "switch/slow_steps.cc",
     "  back_until_ = kNever;  // the next device has as long\n", ""),
    ("an arriving task is armed without a value that it reads", "switch/switching.cc",
     "    if (missing_value(parts_.set, next, plan_.handovers).is_valid()) return wait(now, kLookForValue);\n", ""),
    ("a task that asks waits until the first cycles were seen", "switch/switching.cc",
     "if (has_seen || peers_->is_wish_open()) return", "if (has_seen) return"),
    ("what is refused is taken again in each cycle", "cycle/boundary_signals.cc",
     "if (asked_ && now < asked_at_ + kAskAgain) {", "if (asked_ && now < asked_at_) {"),
    ("another request waits, too", "cycle/boundary_signals.cc",
     "  if (!is_the_same) asked_ = {};", "  (void)is_the_same;"),
    ("a request that waits is not looked at again", "cycle/boundary_signals.cc",
     "asks_again_ = asked_at_ + kAskAgain;", "asks_again_ = kNever;"),
    ("lists of tasks are held against nothing that is ON", "switch/local_switches.cc",
     "asked_->find(request, orders_.on(), now, target)", "asked_->find(request, TaskBits(), now, target)"),
    ("lists of tasks that are met are asked for all the same", "switch/switching.cc",
     "has_lists ? request.lists.are_met_by(tasks_on(statuses_)) :", "has_lists ? false :"),
    ("of lists of tasks that wait only the same again is a new wish", "plan/switch_wish.h",
     "return is_last_open ? !is_for_the_same : !changes_nothing;",
     "return is_last_open ? is_for_the_same : !changes_nothing;"),
    ("who produces the same as a task of a list stays ON", "hosted/asked_set.cc",
     "if (!lists_.plus.has(producer.task)) on_[producer.task.index] = false;", "(void)producer;"),
    ("a slow switch that is undone leaves who was ON OFF", "switch/slow_steps.cc",
     "  if (step.act == SlowAct::kOff && each.state == State::kOff) return turn_on_again(each, now);\n", ""),
    ("the constants before are not in force again on the way back", "switch/slow_steps.cc",
     "  constants.read_foreign();\n  constants.put_in_force(order_->constants);\n", "  constants.read_foreign();\n"),
    ("a device that is not ready is asked at each edge", "switch/slow_steps.cc",
     "  if (task.standing != Standing::kHalfOn || now >= again_at_) return false;",
     "  if (task.standing != Standing::kHalfOn || now >= now) return false;"),
    ("the flag stays up after a slow switch", "switch/slow_switch.cc", "  flag.hold(false);\n", ""),
    ("hardware has no time to see the flag before a constant changes", "switch/slow_switch.cc",
     "  if (waits && now < held_since_ + lead) {", "  if (false && now < held_since_ + lead) {"),
    ("users are re-initialised before who makes their constants on the way back", "plan/slow_plan.cc",
     "  return is_reinit ? first_reinit_ + end_of_reinits_ - 1 - step : step;", "  return (void)is_reinit, step;"),
    ("who stays is not re-initialised with a constant that changes", "plan/slow_plan.cc",
     "  add(SlowAct::kReinit, users);\n", ""),
    ("the resource is opened before the rival has closed it", "plan/slow_plan.cc",
     "if (std::any_of(plan.arriving.begin(), plan.arriving.end(), is_its)) steps_[n_++] = {SlowAct::kKill, order[i]};",
     "(void)is_its;"),
    ("a shared resource makes rivals", "plan/rivals.cc",
     "CHIMERA_RESOURCE && !port.shared &&", "CHIMERA_RESOURCE &&"),
    ("tasks of one configuration are rivals", "plan/rivals.cc", "!run_together(spec, TaskId(a), TaskId(b))",
     "(!run_together(spec, TaskId(a), TaskId(b)) || true)"),
    ("a standby opens the resource of its primary before that is killed", "cycle/recovery.cc",
     "    if (!give_up_resource(group, id, now)) return false;\n", ""),
    ("a hot standby that is not ready is asked at each edge", "cycle/recovery.cc",
     "  } else if (now < standby.again_at) {", "  } else if (false && now < standby.again_at) {"),
    ("the loss of a primary is covered for ever", "plan/standbys.cc",
     "group.is_waiting ? now + tasks_[by.index].period : now", "group.is_waiting ? kNever : now"),
    ("a takeover is over before its first cycle", "cycle/takeover_record.cc",
     "is_on && !standby.is_busy && standby.profile.cycles != open.cycles", "is_on"),
    ("the flag of a late takeover is not told", "cycle/takeover_record.cc",
     "  takeover.flag = std::max(Nanoseconds{}, now - set_.standbys().loss(group).covered_until);\n", ""),
    ("a takeover is given out before it is over", "plan/takeover.h",
     "    if (is_over) place.over.store(", "    (void)is_over;\n    place.over.store("),
)


def faults_of_texts():
    for what, name, text, _ in DEFECTS:
        if (times := (ROOT / RUNTIME / name).read_text().count(text)) != 1:
            yield f"'{what}': its text stands in {RUNTIME}{name} {times} times: {text.strip()}"


def make(copy):
    """The source without what is built, configured."""
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(ROOT, copy, symlinks=True, ignore=shutil.ignore_patterns("build", ".git", "__pycache__"))
    subprocess.run(["cmake", "--preset", "debug"], cwd=copy, check=True, stdout=subprocess.DEVNULL)


def build(copy):
    """Output of the compiler if it refused, otherwise ""."""
    command = ["ninja", "-C", str(copy / "build/debug"), "-j", str(len(os.sched_getaffinity(0))), *PROGRAMS]
    done = subprocess.run(command, capture_output=True, text=True)
    return done.stdout[-3000:] if done.returncode else ""


def caught_by(copy):
    """The first test that fails, or that its program died or hung; "": none."""
    for program, path in PROGRAMS.items():
        try:
            done = subprocess.run([str(copy / "build/debug" / path), "--gtest_fail_fast"], timeout=LIMIT,
                                  cwd=(copy / path).parent, capture_output=True, text=True, errors="replace")
        except subprocess.TimeoutExpired:
            return f"{program}, which hangs"
        if done.returncode == 0:
            continue
        failed = re.search(r"^\[  FAILED  \] (\S+)", done.stdout, re.MULTILINE)
        last = re.findall(r"^\[ RUN      \] (\S+)", done.stdout, re.MULTILINE)
        return failed[1] if failed else f"{last[-1] if last else program}, which dies"
    return ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, help="the tree beside which the copy is made")
    parser.add_argument("--seconds", type=float, help="taken, as by every campaign")
    parser.add_argument("--only", default="", help="those with these words in their names or files")
    parser.add_argument("--look", action="store_true", help="look at the texts only")
    arguments = parser.parse_args()
    if wrong := list(faults_of_texts()):
        print("\n".join(wrong))
        return 1
    if arguments.look:
        print(f"{len(DEFECTS)} defects can be planted")
        return 0
    if arguments.build is None:
        parser.error("--build or --look")
    copy = arguments.build.resolve() / "planted_defects"
    make(copy)
    if (said := build(copy)) or (said := caught_by(copy)):
        print(f"without any defect: {said}")
        return 1
    missed = 0
    chosen = [defect for defect in DEFECTS if arguments.only in f"{defect[0]} {defect[1]}"]
    for number, (what, name, text, planted) in enumerate(chosen, 1):
        path, begun = copy / RUNTIME / name, time.monotonic()
        sound = path.read_text()
        path.write_text(sound.replace(text, planted))
        refused = build(copy)
        by = "" if refused else caught_by(copy)
        path.write_text(sound)
        missed += by == ""
        told = f"caught by {by}" if by else f"does not compile:\n{refused}" if refused else "NOT CAUGHT"
        print(f"{number} of {len(chosen)}, {time.monotonic() - begun:.0f} s, {name}: {what}: {told}", flush=True)
    shutil.rmtree(copy)
    print(json.dumps({"name": "executor_defects", "n": len(chosen), "faults": missed, "counted": "defects"}))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
