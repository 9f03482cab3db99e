# SPDX-License-Identifier: Apache-2.0
"""Compares the receipts of switches that an image prints with those of `chimera run --virtual --json`
(docs/formats/receipt.md): the configurations, the end, lost cycles and steps, but no durations."""
import re

SWITCH = re.compile(r"switch (\d+) from (\S+) to (\S+) (\S+) why (\S+) task (\S+) lost (\d+) .*")
STEP = re.compile(r"step (\d+) (\S+) on (\S+) cycle (\S+) usual \S+")


def of_image(lines):
    """One text for each receipt, in the order of the ends of the switches."""
    found, steps = {}, {}
    for line in lines:
        if switch := SWITCH.fullmatch(line):
            number, before, after, end, why, _, lost = switch.groups()
            if why == "nothing-to-do":  # has no number, and no receipt on the host
                continue
            found[number] = f"{before} to {after} {end} {why} lost {lost}"
        elif step := STEP.fullmatch(line):
            steps.setdefault(step[1], []).append(f" {step[2]} {step[3]} {step[4]}")
    return {number: text + "".join(sorted(steps.get(number, []))) for number, text in found.items()}


def _number(value):
    return "-" if value is None else "nan" if value == "nan" else f"{value:g}"


def of_host(run):
    """As of_image(), of the object that `chimera run --json` prints."""
    found = {}
    for each in run["receipts"]:
        why = each["reason"] or "none"
        lost = sum(task["lost"] for task in each["tasks"])
        steps = sorted(f" {one['variable']} {_number(one['step_of_on'])} {_number(one['step'])}"
                       for one in each["variables"]) if each["end"] == "done" else []
        found[str(each["number"])] = (f"{each['from'] or '-'} to {each['to'] or '-'} {each['end']} {why} lost {lost}"
                                      + "".join(steps))
    return found


def difference(host, image):
    """One sentence about the first difference; "" if the receipts are equal."""
    for number in sorted(host.keys() | image.keys(), key=int):
        if host.get(number) != image.get(number):
            return f"switch {number}: the image has {image.get(number)}, the host has {host.get(number)}"
    return ""
