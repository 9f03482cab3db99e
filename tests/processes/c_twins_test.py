# SPDX-License-Identifier: Apache-2.0
"""Components beside their twins in C, in the process of an rtpu: both publish the same bits and have the same fault."""
import pathlib
import unittest

from system import System, await_that

APPLICATION = pathlib.Path(__file__).resolve().parents[1] / "applications" / "c_twins.yaml"
TWINS = {"tderiv": ("dv", "c_dv"), "limit": ("w", "c_w"), "pid_joint": ("tau", "c_tau")}


def text():
    judges = "".join(f"  same_{name}: {{component: t_same, alias: {{a: {a}, b: {b}, compared: compared_{name}, "
                     f"different: different_{name}}}}}\n" for name, (a, b) in TWINS.items())
    return APPLICATION.read_text().replace("operator:\n", judges + "operator:\n")


class CTwins(unittest.TestCase):
    def judged(self):
        """False if a release was dropped: of twins, only one may have lost a cycle then."""
        with System(text(), name="c_twins") as system:
            await_that(lambda: system.task("t_limit")["faults"] > 40, system.told)
            different = {name: system.value(f"different_{name}") for name in TWINS}
            compared = [system.value(f"compared_{name}") for name in TWINS]
            tasks = {task["task"]: task for task in system.call("status")["tasks"]}
            if any(task["dropped"] > 0 for task in tasks.values()):
                return False
            self.assertEqual(different, dict.fromkeys(TWINS, 0))
            self.assertGreater(min(compared), 200)
            for name in ("limit", "t_limit"):
                self.assertEqual(tasks[name]["fault"], "cycle: x is not a finite number")
        return True

    def test_publish_the_same_bits(self):
        await_that(self.judged, "a run without a dropped release")


if __name__ == "__main__":
    unittest.main()
