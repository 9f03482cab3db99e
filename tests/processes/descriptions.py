# SPDX-License-Identifier: Apache-2.0
"""Descriptions that several scripts run over two rtpus: a switch, a slow one, a device for one user, a standby."""
from system import RTPUS

EXECUTIVE, THREADS = "policy: edf}", "policy: edf, executor: preemptive}"


def preemptive(text):
    """The description with a thread for each task."""
    return text.replace(EXECUTIVE, THREADS)


def mixed(text):
    """The description with a thread for each task of the second rtpu."""
    return text.replace("cpu: 1, " + EXECUTIVE, "cpu: 1, " + THREADS)


# One variable, `wanted`, by a task of the first rtpu or by one of the second; both rtpus read it.
SWITCH = RTPUS + """
tasks:
  reference:
    {component: signal_generator, rtpu: first, rate: 100 Hz, alias: {y: vref},
     constants: {amplitude: 0 m/s, offset: 1 m/s}}
  slow: {component: gain, rtpu: first, rate: 100 Hz, alias: {x: vref, y: wanted}, constants: {k: 2}}
  fast:
    {component: gain, rtpu: second, rate: 100 Hz, alias: {x: vref, y: wanted}, constants: {k: 4},
     max_step: {y: 3 m/s}}
  steep:
    {component: gain, rtpu: second, rate: 100 Hz, alias: {x: vref, y: wanted}, constants: {k: 40},
     max_step: {y: 3 m/s}}
  here: {component: gain, rtpu: first, rate: 50 Hz, alias: {x: wanted, y: seen_here}, constants: {k: 1}}
  there: {component: gain, rtpu: second, rate: 50 Hz, alias: {x: wanted, y: seen_there}, constants: {k: 1}}
configurations:
  gentle: [reference, slow, here, there]
  quick: [reference, fast, here, there]
  wild: [reference, steep, here, there]
start: gentle
"""
SETS = {"gentle": {"reference", "slow", "here", "there"}, "quick": {"reference", "fast", "here", "there"}}
SEEN = {"gentle": {"seen_here": 2, "seen_there": 2}, "quick": {"seen_here": 4, "seen_there": 4}}

# Two tasks of two rtpus make the same constants; a third task uses them and stays.
SLOW_SWITCH = RTPUS + """
tasks:
  light: {component: t_constants, rtpu: first, rate: 100 Hz, constants: {joints: 2, scale: 0.5 m}}
  heavy: {component: t_constants, rtpu: second, rate: 100 Hz, constants: {joints: 3, scale: 2 m}}
  user: {component: t_extent, rtpu: second, rate: 100 Hz}
  beside: {component: t_counter, rtpu: first, rate: 200 Hz}
operator: {q: 1 rad}
configurations:
  with_light: [light, user, beside]
  with_heavy: [heavy, user, beside]
start: with_light
"""
SLOW_SETS = {"with_light": {"light", "user", "beside"}, "with_heavy": {"heavy", "user", "beside"}}
SLOW_SEEN = {"with_light": {"arc": [0.5, 1]}, "with_heavy": {"arc": [2, 4, 6]}}

# Two tasks of two rtpus open one device that accepts one user.
DEVICE = RTPUS + """
tasks:
  hand: {component: t_lock, rtpu: first, rate: 100 Hz, resources: {device: device.lock}, constants: {value: 1}}
  drill:
    {component: t_lock, rtpu: second, rate: 100 Hz, resources: {device: device.lock}, constants: {value: 2, late: 3}}
  user: {component: gain, rtpu: second, rate: 100 Hz, alias: {x: y, y: seen}, constants: {k: 1}}
"""
DEVICE_SWITCH = DEVICE + "configurations: {with_hand: [hand, user], with_drill: [drill, user]}\nstart: with_hand\n"
DEVICE_STANDBY = DEVICE.replace("late: 3}", "late: 3}, standby_for: hand") + "configurations: {run: [hand, user]}\n"
DEVICE_SETS = {"with_hand": {"hand", "user"}, "with_drill": {"drill", "user"}}
DEVICE_SEEN = {"with_hand": {"seen": 1}, "with_drill": {"seen": 2}}

# `wanted` comes from a task of the first rtpu or from its standby in the second; `user` reads it in the second.
STANDBY = RTPUS + """
tasks:
  reference:
    {component: signal_generator, rtpu: second, rate: 100 Hz, alias: {y: vref},
     constants: {amplitude: 0 m/s, offset: 1 m/s}}
  main: {component: gain, rtpu: first, rate: 100 Hz, alias: {x: vref, y: wanted}, constants: {k: 2}}
  spare: {component: gain, rtpu: second, rate: 50 Hz, alias: {x: vref, y: wanted}, constants: {k: 3}, standby_for: main}
  user: {component: gain, rtpu: second, rate: 100 Hz, alias: {x: wanted, y: seen}, constants: {k: 1}}
configurations: {run: [reference, main, user]}
"""
