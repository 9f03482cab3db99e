// SPDX-License-Identifier: Apache-2.0
// Answers as docs/formats/control.md has them, for the tests of this folder.
#pragma once

namespace chimera::cli::test {

/// A subsystem with two rtpus, one of them dead, and four tasks in all four states.
inline constexpr const char* kStatus = R"({
    "subsystem": "puma_pid", "configuration": "run", "now_ns": 755000000000, "origin_ns": 5000000000,
    "started_ns": 5000000000, "ending": false, "flag": {"up": true, "by": ["spare", "operator"]},
    "rtpus": [
      {"name": "servo", "cpu": 1, "policy": "muf", "pid": 4711, "incarnation": 1, "alive": true, "phase": "serving",
       "grant": "SCHED_FIFO 80", "running": "pid.cycle", "restarts": 0, "last_end": null, "lost_events": 0,
       "flag": false},
      {"name": "spare", "cpu": 0, "policy": "edf", "pid": 4712, "incarnation": 3, "alive": false, "phase": "ended",
       "grant": "", "running": null, "restarts": 2, "last_end": "signal 11 in trajectory.cycle", "lost_events": 4,
       "flag": true}],
    "tasks": [
      {"task": "trajectory", "component": "joint_trajectory", "rtpu": "spare", "state": "ERROR", "in_service": true,
       "incarnation": 3, "rate_hz": 100, "period_ns": 10000000, "budget_ns": 0, "cycles": 41234,
       "execution_ns": {"mean": 4100, "max": 18200}, "response_ns": {"max": 51000}, "jitter_ns": 12345, "missed": 3,
       "overrun": 0, "dropped": 1, "stale": 0, "rejected": 0, "fault": "cycle: goal out of reach", "faults": 1,
       "inputs": []},
      {"task": "pid", "component": "pid_joint", "rtpu": "servo", "state": "ON", "in_service": true, "incarnation": 1,
       "rate_hz": 1000, "period_ns": 1000000, "budget_ns": 40000, "cycles": 750000,
       "execution_ns": {"mean": 12100, "max": 30200}, "response_ns": {"max": 71000}, "jitter_ns": 3100, "missed": 0,
       "overrun": 0, "dropped": 0, "stale": 2, "rejected": 0, "fault": null, "faults": 0,
       "inputs": [{"port": "q", "variable": "q", "age_ns": 412000},
                  {"port": "q_ref", "variable": "q_ref", "age_ns": 3120000000}]},
      {"task": "arm", "component": "puma_torque", "rtpu": "servo", "state": "ON", "in_service": true, "incarnation": 1,
       "rate_hz": 1000, "period_ns": 1000000, "budget_ns": 150000, "cycles": 749999,
       "execution_ns": {"mean": 98700, "max": 149000}, "response_ns": {"max": 171000}, "jitter_ns": 0, "missed": 12,
       "overrun": 2, "dropped": 0, "stale": 0, "rejected": 0, "fault": null, "faults": 0,
       "inputs": [{"port": "tau", "variable": "tau", "age_ns": 530000}]},
      {"task": "pid_spare", "component": "pid_joint", "rtpu": "spare", "state": "NOT-CREATED", "in_service": false,
       "incarnation": 0, "rate_hz": 1000, "period_ns": 1000000, "budget_ns": 0, "cycles": 0,
       "execution_ns": {"mean": 0, "max": 0}, "response_ns": {"max": 0}, "jitter_ns": 0, "missed": 0, "overrun": 0,
       "dropped": 0, "stale": 0, "rejected": 0, "fault": null, "faults": 0,
       "inputs": [{"port": "q", "variable": "q", "age_ns": 412000},
                  {"port": "q_ref", "variable": "q_ref", "age_ns": null}]}]})";

/// The answer of `describe` for a part of it.
inline constexpr const char* kDescribed = R"({
    "start": "run", "configurations": [{"name": "run", "tasks": ["trajectory", "pid", "arm"]},
                                       {"name": "hand", "tasks": ["pid", "arm"]}],
    "tasks": [{"task": "trajectory", "component": "joint_trajectory", "rtpu": "spare", "ports": []},
              {"task": "pid", "component": "pid_joint", "rtpu": "servo",
               "ports": [{"port": "q", "kind": "in-var", "variable": "q", "type": "float64", "unit": "rad",
                          "shape": "[2]"}]},
              {"task": "arm", "component": "puma_torque", "rtpu": "servo", "ports": []}],
    "variables": [
      {"variable": "q", "type": "float64", "unit": "rad", "shape": "[2]", "constant": false, "given": false,
       "producers": [{"task": "arm", "port": "q"}], "consumers": [{"task": "pid", "port": "q"}]},
      {"variable": "q_ref", "type": "float64", "unit": "rad", "shape": "[2]", "constant": false, "given": false,
       "producers": [{"task": "trajectory", "port": "q_ref"}], "consumers": [{"task": "pid", "port": "q_ref"}]},
      {"variable": "error", "type": "float64", "unit": "rad", "shape": "", "constant": false, "given": false,
       "producers": [{"task": "pid", "port": "error"}], "consumers": []},
      {"variable": "ndof", "type": "int32", "unit": "1", "shape": "", "constant": true, "given": true,
       "producers": [], "consumers": []},
      {"variable": "kp", "type": "float64", "unit": "N.m/rad", "shape": "[2]", "constant": false, "given": true,
       "producers": [], "consumers": [{"task": "pid", "port": "kp"}]}],
    "sequence": {"steps": [
      {"number": 1, "name": "near", "switch": "run", "until": null, "for": "2 s", "within": null},
      {"number": 2, "name": "grip", "switch": "hand", "until": "distance <= 5 mm", "for": null, "within": "10 s"},
      {"number": 3, "name": null, "switch": "home", "until": null, "for": null, "within": null}]}})";

/// The answer of `get` for the second of three steps.
inline constexpr const char* kSequence = R"({"values": {
    "sequence_steps": {"value": ["near", "grip", "home"]}, "sequence_step": {"value": 2},
    "sequence_state": {"value": 2}, "sequence_waited": {"value": 1.5, "text": "1.5 s"}}})";

}  // namespace chimera::cli::test
