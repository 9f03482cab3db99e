# SPDX-License-Identifier: Apache-2.0
"""What pages, other programs and kills may do to the draft of chimera-web: no text is lost or overwritten unseen."""
import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import sys
import tempfile
import threading
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "processes"))
from protocol_test import JUDGES  # noqa: E402
from system import await_that, kill  # noqa: E402
from wire import BUILD, Closed, Server  # noqa: E402

MIB = 1 << 20
TEXT = """subsystem: subject
rtpus:
  first: {cpu: 0, policy: edf}
tasks:
  one: {component: t_counter, rtpu: first, rate: 100 Hz}
  two: {component: t_source, rtpu: first, rate: 100 Hz}
start: all
configurations:
  all: [one, two]
"""


def rate(value):
    return {"act": "set", "path": "tasks/one/rate", "value": f"{value} Hz"}


def analysts(pid):
    """The processes that a chimera-web has started to read texts."""
    found = []
    for status in pathlib.Path("/proc").glob("[0-9]*/status"):
        try:
            lines = dict(line.split(":\t", 1) for line in status.read_text().splitlines() if ":\t" in line)
        except OSError:
            continue
        if int(lines["PPid"]) == pid and lines["Name"].startswith("chimera-manage"):
            found.append(int(lines["Pid"]))
    return found


class Drafts(unittest.TestCase):
    """What pages may do with the draft, and what other programs and kills do to it."""

    def setUp(self):
        self.place = pathlib.Path(tempfile.mkdtemp(prefix="chimera-draft-"))
        self.file = self.place / "subject.yaml"
        self.file.write_text(TEXT)
        self.server = self.start()

    def tearDown(self):
        with self.server.open() as page:
            self.assertIn("report", page.call("draft")["analysis"])
        self.server.__exit__()
        shutil.rmtree(self.place)

    def start(self):
        return Server(self.file, state=self.place / "state")

    def refused(self, page, kind, method, **parameters):
        answer = page.ask(method, **parameters)
        JUDGES["answer"].validate(answer)
        self.assertEqual(answer.get("error", {}).get("data", {}).get("kind"), kind, answer)
        return answer["error"]

    def edit(self, page, *acts):
        """An accepted edit of the present version."""
        return page.call("edit", version=page.call("draft")["version"], acts=list(acts))

    def test_every_answer_fits_the_schema(self):
        with self.server.open() as page:
            for method, parameters in (("draft", {}), ("library", {}), ("output", {}), ("differences", {}),
                                       ("remedies", {"version": 1}), ("transitions", {"version": 1}),
                                       ("keep", {"what": "draft"}),
                                       ("replace", {"version": 1, "text": "subsystem: [\n"}), ("draft", {}),
                                       ("replace", {"version": 2, "text": TEXT.replace("t_counter", "nothing")}),
                                       ("remedies", {"version": 3}), ("transitions", {"version": 3}),
                                       ("keep", {"what": "file"}),
                                       ("edit", {"version": 4, "acts": [rate(50)]}), ("write", {"version": 5})):
                with self.subTest(method):
                    name = "bench_library" if method == "library" else method + "_result"
                    JUDGES[name].validate(page.call(method, **parameters))
            self.assertEqual(self.file.read_text(), TEXT.replace("100 Hz", "50 Hz", 1))
            page.call("subscribe", to="draft")
            note = json.loads(page.message())
            JUDGES["notification"].validate(note)
            self.assertEqual((note["method"], note["params"]["version"]), ("draft", 5))

    def test_wrong_parameters_are_refused(self):
        wrong = {"draft": [{"version": 1}], "edit": [{}, {"version": 1}, {"version": 1, "acts": {}},
                                                     {"version": 1, "acts": [1]}, {"version": "1", "acts": []}],
                 "replace": [{"version": 1, "text": None}, {"version": 0, "text": ""}, {"version": 1.5, "text": ""}],
                 "remedies": [{}, {"version": -1}], "transitions": [{}],
                 "differences": [{"text": 1}], "write": [{}, {"version": True}],
                 "keep": [{}, {"what": "both"}], "start": [{"file": "/etc/passwd"}], "output": [{"pid": 1}]}
        with self.server.open() as page:
            for method, all_parameters in wrong.items():
                for parameters in all_parameters:
                    with self.subTest((method, parameters)):
                        answer = page.ask(method, **parameters)
                        JUDGES["answer"].validate(answer)
                        self.assertEqual(answer["error"]["code"], -32602)
            self.assertEqual(page.call("draft")["version"], 1)

    def test_acts_of_any_form_and_number_change_nothing_but_the_draft(self):
        deep = []
        for _ in range(20):
            deep = [deep]
        with self.server.open() as page:
            for acts in ([{}], [{"act": "fly"}], [{"act": "set", "path": 1}],
                         [{"act": "set", "path": "a", "value": deep}],
                         [{"act": "remove", "path": "../../etc"}], [rate(50), {"act": "remove", "path": "nothing"}],
                         [{"act": "add_task", "name": "\u0000", "component": "gain"}],
                         [{"act": "rename", "path": "tasks/one", "to": "a b: {"}],
                         [{"act": "remove", "path": "nothing"}] * 3000):
                with self.subTest(str(acts)[:60]):
                    self.refused(page, "edit", "edit", version=1, acts=acts)
            self.assertEqual(page.call("draft")["analysis"]["text"], TEXT)
            many = self.edit(page, *(rate(10 + i) for i in range(100)))
            self.assertEqual(many["analysis"]["text"], TEXT.replace("100 Hz", "109 Hz", 1))
        with self.server.open() as page:
            page.begin("edit", version=2, acts=[rate(1)] * 10_000)
            self.assertIn("error", json.loads(page.message()))
        with self.server.open() as page:
            self.assertEqual(page.call("draft")["version"], 2)
        self.assertEqual(self.file.read_text(), TEXT)

    def test_texts_beyond_the_limits_are_refused(self):
        with self.server.open() as page:
            for text in ("#" * 300_000, "#" * (MIB - 200), "a: \0", "a: \x1b[31m", "a: \x7f"):
                with self.subTest(text[:20]):
                    self.refused(page, "edit", "replace", version=1, text=text)
                    self.refused(page, "edit", "differences", text=text)
            nested = page.call("replace", version=1, text="[" * 100_000)
            self.assertFalse(nested["analysis"]["report"]["legal"])
            self.assertIsNone(nested["analysis"]["outline"])
            self.refused(page, "stale", "write", version=1)
        with self.server.open() as page:
            with contextlib.suppress(OSError):  # the server may end the connection before it has read all
                page.begin("replace", version=2, text="#" * MIB)
            self.assertEqual(page.code(), 1009)

    def test_components_that_come_are_known_to_the_next_analysis(self):
        folder = self.place / "build" / "components"
        self.file.write_text(TEXT.replace("t_counter", "of_my_own"))
        with self.server.open() as page:
            def task():
                return page.call("draft")["analysis"]["outline"]["tasks"][0]

            await_that(lambda: task()["component"] == "of_my_own", "the new file")
            self.assertFalse(task()["known"])
            folder.mkdir(parents=True)
            (folder / "cut.component.json").write_text("{")
            part = json.loads((BUILD / "components" / "t_counter.component.json").read_text())
            own = folder / "of_my_own.component.json"
            own.write_text(json.dumps({**part, "name": "of_my_own"}))

            def fingerprint():  # the fault of the changed descriptor has the right one
                said = " ".join(fault["message"] for fault in page.call("library")["faults"])
                return re.search(r"its content gives (\w+)", said)

            await_that(fingerprint, "a fault")
            own.write_text(json.dumps({**part, "name": "of_my_own", "fingerprint": fingerprint()[1]}))
            await_that(lambda: task()["known"], "the component")
            library = page.call("library")
            JUDGES["bench_library"].validate(library)
            self.assertIn("of_my_own", [one["name"] for one in library["components"]])
            self.assertEqual([one["file"] for one in library["faults"]], [str(folder / "cut.component.json")])
            await_that(lambda: len(analysts(self.server.process.pid)) < 2, "the end of the analyst without it")

    def test_of_two_pages_one_edits_each_version(self):
        good = 0
        with self.server.open() as one, self.server.open() as two:
            for i in range(20):
                version = one.call("draft")["version"]
                one.begin("edit", version=version, acts=[rate(100 + i)])
                two.begin("edit", version=version, acts=[{**rate(200 + i), "path": "tasks/two/rate"}])
                answers = [one.finish(), two.finish()]
                errors = [answer["error"] for answer in answers if "error" in answer]
                self.assertEqual([(e["data"]["kind"], e["data"]["version"]) for e in errors], [("stale", version + 1)])
                good += "result" in answers[0]
                text = two.call("draft")["analysis"]["text"]
                self.assertIn(f"{100 + i} Hz" if "result" in answers[0] else f"{200 + i} Hz", text)

    def test_a_file_that_another_program_changed_is_not_overwritten(self):
        other = self.place / "other"
        with self.server.open() as page:
            self.edit(page, rate(50))
            for change in (lambda: self.file.write_text("theirs: 1\n"),
                           lambda: (other.write_text("theirs: 2\n"), other.rename(self.file))):
                change()
                theirs = self.file.read_text()
                self.refused(page, "outside", "write", version=2)
                self.refused(page, "outside", "write", version=2)
                self.assertEqual(self.file.read_text(), theirs)
            self.assertTrue(page.call("draft")["outside"])
            self.file.unlink()
            self.file.mkdir()
            self.refused(page, "file", "write", version=2)
            self.refused(page, "file", "start")
            self.file.rmdir()
            self.file.symlink_to("nowhere")
            self.refused(page, "file", "keep", what="draft")
            self.file.unlink()
            self.refused(page, "outside", "write", version=2)
            page.call("keep", what="draft")
            self.assertTrue(page.call("write", version=2)["changed"])
        self.assertEqual(self.file.read_text(), TEXT.replace("100 Hz", "50 Hz", 1))

    def test_a_killed_server_goes_on_with_the_draft(self):
        sent = [TEXT]

        def edit_on(page, version):
            try:
                while True:
                    sent.append(TEXT.replace("100 Hz", f"{len(sent) + 1} Hz", 1))
                    answer = page.ask("edit", version=version, acts=[rate(len(sent))])
                    version += "result" in answer  # else it came too fast
            except (OSError, EOFError, Closed):
                pass

        for _ in range(4):
            with self.server.open() as page:
                editing = threading.Thread(target=edit_on, args=(page, page.call("draft")["version"]))
                editing.start()
                await_that(lambda: any(self.kept()), "a kept draft")
                seen = len(sent)
                await_that(lambda n=seen: len(sent) > n + 20, "more edits")
                self.server.process.kill()
                editing.join()
            self.server.__exit__()
            self.server = self.start()
            with self.server.open() as page:
                draft = page.call("draft")
            self.assertEqual((draft["touched"], draft["outside"], draft["problem"]), (True, False, None))
            self.assertIn(draft["analysis"]["text"], sent[1:])
            self.assertEqual(self.file.read_text(), TEXT)

    def kept(self):
        """The texts in the state folder."""
        for path in (self.place / "state" / "chimera" / "drafts").glob("subject.yaml-*[0-9a-f]"):
            try:
                yield path.read_text().split("\n", 1)[1]
            except OSError:
                pass

    def test_a_kept_draft_survives_every_end(self):
        for how in (signal.SIGKILL, signal.SIGTERM):
            with self.server.open() as page:
                text = self.edit(page, rate(10 + how))["analysis"]["text"]
            if how == signal.SIGKILL:
                await_that(lambda t=text: t in self.kept(), "a kept draft")
            self.server.end(how)
            self.server = self.start()
            with self.server.open() as page:
                self.assertEqual(page.call("draft")["analysis"]["text"], text)

    def test_a_killed_analyst_costs_one_edit(self):
        with self.server.open() as page:
            for i in range(5):
                version = self.edit(page, rate(100 + i))["version"]
                page.begin("edit", version=version, acts=[rate(200 + i)])
                for analyst in analysts(self.server.process.pid):
                    kill(analyst, str(self.server.runtime))
                answer = page.finish()
                if "error" in answer:
                    self.assertEqual(answer["error"]["data"]["kind"], "analysis")
                draft = page.call("draft")
                self.assertEqual(draft["version"], version + ("result" in answer))
                self.assertIn(f"{200 + i if 'result' in answer else 100 + i} Hz", draft["analysis"]["text"])

    def test_what_is_started_goes_on_without_the_page(self):
        with self.server.open() as page:
            self.edit(page, rate(50))
            self.refused(page, "touched", "start")
            page.call("write", version=2)
            pid = page.call("start")["pid"]
            self.refused(page, "under-way", "start")
            await_that(lambda: page.call("machines")["machines"], "a subsystem")
            self.assertEqual(os.getsid(pid), pid)
            self.assertEqual({os.readlink(f"/proc/{pid}/fd/{n}") for n in (1, 2)},
                             {str(self.place / "state/chimera/drafts/output")})
            JUDGES["output_result"].validate(page.call("output"))
        runtime = self.server.runtime
        self.server.end()
        with Server(self.file, runtime=runtime, state=self.place / "state") as later:
            with later.open("/machine/subject") as machine:
                await_that(lambda: machine.call("status")["configuration"] == "all", "the start")
                machine.call("end", code=0)
            await_that(lambda: not pathlib.Path(f"/proc/{pid}").exists(), "the end")
        self.server = self.start()

    def test_output_shows_the_end_of_what_was_started(self):
        self.file.write_text("subsystem: [\n")
        with self.server.open() as page:
            await_that(lambda: not page.call("draft")["touched"] and page.call("draft")["version"] == 2, "the new file")
            pid = page.call("start")["pid"]
            await_that(lambda: page.call("output")["ended"], "the end")
            output = page.call("output")
            self.assertEqual((output["pid"], output["ended"]), (pid, "with status 1"))
            self.assertIn("error", output["text"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
