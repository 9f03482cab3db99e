// SPDX-License-Identifier: Apache-2.0
// The table of the commands on a running subsystem.
#include "chimera/cli/live/commands.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/cli/live/events_command.h"
#include "chimera/cli/live/live.h"
#include "chimera/cli/live/one_shot.h"
#include "chimera/cli/live/receipts_command.h"
#include "chimera/cli/live/scope_command.h"
#include "chimera/cli/live/sequence_command.h"
#include "chimera/cli/print/answer_text.h"
#include "chimera/cli/print/status_text.h"
#include "chimera/task/signal.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

/// A signal to tasks: the command has the name of the signal.
RunningCommand signal_row(Signal to_send, const char* help, const char* manual, const char* example) {
  return {.words = {.name = signal_name(to_send),
                    .help = help,
                    .operands = "TASK...",
                    .least = 1,
                    .most = kAnyNumber,
                    .operand_kind = WordKind::kTask,
                    .example = example,
                    .manual = manual,
                    .is_act = true},
          .method = "signal",
          .parameters = [](const Call& call) { return Json{{"signal", call.command->name}, {"tasks", call.operands}}; },
          .show = signal_text};
}

RunningCommand clear_row() {
  return signal_row(Signal::kClear, "Bring tasks from ERROR to OFF", "Brings each TASK from ERROR to OFF.",
                    "chimera clear pid");
}

RunningCommand drill_row() {
  return {.words = {.name = "drill",
                    .help = "Raise the flag, wait until each device is safe, lower it; exit code 1 unless all are",
                    .options = {{.name = "--wait", .value = "TIME", .help = "how long to wait for them ('10 s')"},
                                {.name = "--kill",
                                 .value = "RTPU",
                                 .help = "also kill this rtpu and print when its safe frames were written",
                                 .manual = "Also kills this rtpu when all are safe, and prints the time from "
                                           "the kill to the last byte of its safe frames; the exit code is 1 unless "
                                           "it had one and all were written. It is restarted as after any death."},
                                {.name = "--yes", .help = "do not ask before"}},
                    .example = "chimera drill --yes",
                    .manual = "Raises the illegal-configuration flag while the machine runs, waits until each "
                              "hardware task that is ON says by its `safe_state` output that its device is in the "
                              "state that the flag asks for, lowers the flag, and prints the time from the flag to "
                              "that. The exit code is 1 when one does not say so in time, or has no such output and "
                              "cannot tell. Asks before unless `--yes` is given, because it stops the machine.",
                    .is_act = true},
          .method = "drill",
          .once = drill};
}

RunningCommand end_row() {
  return {.words = {.name = "end",
                    .help = "End the subsystem: off, kill, and every process",
                    .example = "chimera end",
                    .manual = "Ends the subsystem: `off` and `kill` of every task, then every process.",
                    .is_act = true},
          .method = "end",
          .once = end};
}

RunningCommand events_row() {
  return {.words = {.name = "events",
                    .help = "Print the events of the subsystem, numbered without a gap",
                    .options = {{.name = "--since",
                                 .value = "TIME|N",
                                 .help = "events from a time on ('10 min' ago, '14:05', '2026-11-28'), or from N on",
                                 .manual = "Events from a time on, also of earlier runs: '10 min' ago, '14:05', "
                                           "'2026-11-28' or '2026-11-28 14:05:30' of local time; or those of this run "
                                           "from number N on."},
                                {.name = "--kind",
                                 .value = "KIND,...",
                                 .help = "only these, such as 'set,fault'",
                                 .manual = "Only events of these kinds, such as `set,fault`."},
                                {.name = "--each",
                                 .help = "a line for every event; else misses within 100 ms of each other are one",
                                 .manual = "A line for every event. Else deadlines that are missed within 100 ms of "
                                           "each other are one line: the tasks, the first cause, how many events, and "
                                           "the number of the last."},
                                {.name = "--follow", .help = "print new events as they happen, until Ctrl-C"}},
                    .example = "chimera events --follow",
                    .manual = "Prints the events of the subsystem, numbered without a gap; says how many older ones "
                              "are gone. When the subsystem does not run, from its file: "
                              "`$XDG_STATE_HOME/chimera/SUBSYSTEM/events.jsonl`, else in `~/.local/state`."},
          .method = "events",
          .once = events,
          .live = follow_events,
          .live_option = "--follow",
          .without = filed_events};
}

RunningCommand flag_row() {
  return {.words = {.name = "flag",
                    .help = "Raise or lower the operator's part of the illegal-configuration flag",
                    .operands = "up|down",
                    .least = 1,
                    .most = 1,
                    .operand_kind = WordKind::kOneOf,
                    .operand_words = "up down",
                    .example = "chimera flag up",
                    .manual = "Raises or lowers the operator's part of the illegal-configuration flag. It stays up "
                              "while anybody else raises it.",
                    .is_act = true},
          .method = "flag",
          .once = flag};
}

RunningCommand get_row() {
  return {.words = {.name = "get",
                    .help = "Print present values; without a name all",
                    .operands = "VAR...",
                    .most = kAnyNumber,
                    .operand_kind = WordKind::kVariable,
                    .options = {{.name = "--every",
                                 .value = "TIME",
                                 .help = "repeat at this interval, such as '1 s', until Ctrl-C"}},
                    .example = "chimera get q kp",
                    .manual = "Prints present values with their producer and age; without a name all."},
          .method = "get",
          .parameters =
              [](const Call& call) {
                return call.operands.empty() ? Json::object() : Json{{"variables", call.operands}};
              },
          .show = readings_text,
          .live = get_every,
          .live_option = "--every"};
}

RunningCommand kill_row() {
  return signal_row(Signal::kKill, "End tasks: back to NOT-CREATED; waits 3 s for `kill`",
                    "Ends tasks: back to NOT-CREATED. A `kill` that takes longer than 2.5 s is not waited for: it "
                    "goes on, and the refusal names it.",
                    "chimera kill pid");
}

RunningCommand off_row() {
  return signal_row(Signal::kOff, "Take tasks out of service, those of one rtpu in one step",
                    "Takes tasks out of service: those of one rtpu in one step, all or none; the rtpus one by one.",
                    "chimera off pid arm");
}

RunningCommand on_row() {
  RunningCommand row = signal_row(
      Signal::kOn, "Put tasks, or those of a configuration, into service in one step",
      "Puts tasks into service in one step: all or none. The name of a configuration stands for its tasks.",
      "chimera on pid arm");
  row.words.operand_kind = WordKind::kTaskOrConfiguration;
  row.once = turn_on;
  return row;
}

RunningCommand profile_row() {
  return {
      .words = {.name = "profile",
                .help = "Print what each task costs and how punctual it is",
                .options = {{.name = "--save",
                             .value = "FILE",
                             .help = "write it into this file, for `chimera schedule --profile`",
                             .manual = "Writes it into this file instead, for `chimera schedule --profile` "
                                       "(docs/formats/profile.md).",
                             .kind = WordKind::kFile}},
                .footer = "mean, max: execution time of a cycle; load: its share of the time ON; response: longest, "
                          "release to end;\njitter: latest start minus earliest, each after its release; groups, "
                          "bytes: copied from other rtpus or the\noperator",
                .example = "chimera profile",
                .manual = "Prints what each task costs and how punctual it is: mean and longest execution time of "
                          "a cycle, the load that they are, the longest response (from release to end), the jitter "
                          "(latest start minus earliest, each after its release), failures by kind, what is copied "
                          "from other rtpus or the operator, the other methods, and the sums of each rtpu."},
      .method = "profile",
      .once = profile};
}

RunningCommand receipts_row() {
  return {.words = {.name = "receipts",
                    .help = "Print the results of the last switches of configurations",
                    .operands = "[SUBSYSTEM]",
                    .most = 1,
                    .options = {{.name = "--last",
                                 .value = "N",
                                 .help = "how many (20)",
                                 .kind = WordKind::kNumber,
                                 .least = 1,
                                 .most = 200}},
                    .footer = "change: from the request to the instant of the change; lost: cycles; moves: how far "
                              "each variable did\nthat got another producer",
                    .example = "chimera receipts --last 5",
                    .manual = "Prints the results of the last requests for a switch of configurations: who asked, from "
                              "where to where, done or why not, how long until the change, how many cycles were "
                              "lost, how far each variable moved that got another producer. When the subsystem does "
                              "not run, from its file: `$XDG_STATE_HOME/chimera/SUBSYSTEM/receipts.jsonl`, else in "
                              "`~/.local/state`."},
          .method = "receipts",
          .once = receipts,
          .without = filed_receipts};
}

RunningCommand reinit_row() {
  RunningCommand row = signal_row(
      Signal::kReinit, "Call `reinit` of tasks with the constants of the start; the file is not read",
      "Calls `reinit` of each TASK, with the constants of the start and of other tasks: the file is not read again.",
      "chimera reinit pid");
  row.show = [](const Json& answer) {
    return signal_text(answer) + "the file was not read: constants in it are those of the start\n";
  };
  return row;
}

RunningCommand ring_row() {
  return {.words = {.name = "ring",
                    .help = "Ring the doorbell of tasks: one event for each",
                    .operands = "TASK...",
                    .least = 1,
                    .most = kAnyNumber,
                    .operand_kind = WordKind::kTask,
                    .example = "chimera ring lamp",
                    .manual = "Rings the doorbell of tasks: one event for each time that one is named.",
                    .is_act = true},
          .method = "ring",
          .parameters =
              [](const Call& call) {
                return Json{{"tasks", call.operands}};
              },
          .show = ring_text};
}

RunningCommand save_row() {
  return {.words = {.name = "save",
                    .help = "Show the operator's values in the words of the description",
                    .options = {{.name = "--write",
                                 .help = "write them into the description file; nothing else in it changes",
                                 .is_act = true}},
                    .example = "chimera save --write",
                    .manual = "Prints the present values of the operator variables in the words of the description."},
          .method = "save",
          .once = save};
}

RunningCommand scope_row() {
  return {
      .words =
          {.name = "scope",
           .help = "Record everything that is published before and after a trigger",
           .operands = "VAR...",
           .least = 1,
           .most = kAnyNumber,
           .operand_kind = WordKind::kVariable,
           .options =
               {{.name = "--trigger",
                 .value = "EXPR",
                 .help = "begin when this comes true, such as 'error_now > 2 mrad'"},
                {.name = "--pre", .value = "TIME", .help = "keep this much from before the trigger, such as '50 ms'"},
                {.name = "--for", .value = "TIME", .help = "how long from the trigger on ('1 s')"},
                {.name = "--wait", .value = "TIME", .help = "how long to wait for the trigger ('60 s')"},
                {.name = "--csv", .value = "FILE", .help = "write the rows to this file", .kind = WordKind::kFile},
                {.name = "--svg",
                 .value = "FILE",
                 .help = "draw the rows into this file (SVG)",
                 .kind = WordKind::kFile}},
           .example = "chimera scope q tau --trigger 'error_now > 2 mrad' --pre '50 ms' --for '200 ms' --svg "
                      "scope.svg",
           .manual = "Records everything that the producers of the variables publish. VAR is a variable, an "
                     "element such as `q[2]` or a field such as `pose.x`. Without `--csv` and `--svg` the "
                     "table is printed. Rows that were lost are counted in the last column and hatched in the "
                     "picture."},
      .method = "subscribe",
      .once = scope};
}

RunningCommand sequence_row() {
  return {.words = {.name = "sequence",
                    .help = "Show the steps of the sequence; go on, go to a step, or pause",
                    .operands = "[go [STEP] | pause]",
                    .most = 2,
                    .operand_kind = WordKind::kOneOf,
                    .operand_words = "go pause",
                    .example = "chimera sequence go 2",
                    .manual = "Prints the steps of the sequence and what the present one waits for. `go` begins the "
                              "present step anew, or the first one after the end, `go STEP` a step by its name or "
                              "number; both confirm a step that waits for Go. `pause` stays where it is.",
                    .is_act = true},
          .method = "set",
          .once = sequence};
}

RunningCommand set_row() {
  return {.words = {.name = "set",
                    .help = "Give an operator variable a value with its unit",
                    .operands = "VAR VALUE",
                    .least = 2,
                    .most = kAnyNumber,
                    .operand_kind = WordKind::kSetting,
                    .operand_help = "an operator variable, and its value with a unit",
                    .example = "chimera set kp '[100 90] N.m/rad'",
                    .manual = "Gives an operator variable a value with its unit. Values for all elements stand in "
                              "brackets.",
                    .is_act = true},
          .method = "set",
          .parameters =
              [](const Call& call) {
                std::string value = call.operands[1];
                for (std::size_t i = 2; i < call.operands.size(); ++i) value += " " + call.operands[i];
                return Json{{"values", {{call.operands[0], value}}}};
              },
          .show = readings_text};
}

RunningCommand spawn_row() {
  return signal_row(Signal::kSpawn, "Create and init tasks: OFF; waits up to 65 s for `init`",
                    "Creates tasks and calls their `init`: they are OFF. Waits for it up to 65 s.",
                    "chimera spawn pid");
}

RunningCommand status_row() {
  return {.words = {.name = "status",
                    .help = "Print the rtpus, the tasks and the illegal-configuration flag",
                    .options = {{.name = "--pid",
                                 .value = "RTPU",
                                 .help = "only the process number of this rtpu, of 'keeper' or of "
                                         "'manager'",
                                 .manual = "Only the number of the process of this rtpu, for `kill`; "
                                           "`keeper` and `manager` are names, too.",
                                 .is_act = true}},
                    .example = "chimera status",
                    .manual = "Prints the rtpus, the tasks and the illegal-configuration flag."},
          .method = "status",
          .once = status,
          .names_its_subsystem = true};
}

RunningCommand switch_row() {
  return {.words = {.name = "switch",
                    .help = "Change to a configuration while everything cycles: exactly its tasks are ON then",
                    .operands = "[CONFIGURATION]",
                    .most = 1,
                    .operand_kind = WordKind::kTaskOrConfiguration,
                    .options = {{.name = "--on",
                                 .value = "TASK...",
                                 .help = "instead of a configuration: what is ON, and these; who produces what they "
                                         "produce goes OFF",
                                 .kind = WordKind::kTask,
                                 .repeats = Option::Repeats::kManyEach,
                                 .excludes = "CONFIGURATION"},
                                {.name = "--off",
                                 .value = "TASK...",
                                 .help = "instead of a configuration: what is ON, without these",
                                 .kind = WordKind::kTask,
                                 .repeats = Option::Repeats::kManyEach,
                                 .excludes = "CONFIGURATION"},
                                {.name = "--wait",
                                 .value = "TIME",
                                 .help = "how long to wait for safe_when, slack and inputs with a value ('10 s')"},
                                {.name = "--dry-run", .help = "only say what it would do; changes nothing"},
                                {.name = "--cancel",
                                 .help = "take back the switch that is under way",
                                 .manual = "Takes back the switch that is under way, also that of another user: it is "
                                           "aborted unless it is committed. Prints its receipt."}},
                    .example = "chimera switch hand",
                    .manual = "Changes to a configuration while the tasks cycle: exactly its tasks are ON afterwards. "
                              "`on` of arriving tasks runs beside their predecessors. All rtpus change at one instant. "
                              "Then leaving tasks go OFF. All or nothing, and no cycle is lost. Prints the receipt. A "
                              "failure before that instant changes nothing; the exit code is 1 then. (`on "
                              "CONFIGURATION` turns tasks ON and none OFF.)",
                    .is_act = true},
          .method = "switch",
          .once = switch_to};
}

constexpr Option kEvery{.name = "--every", .value = "TIME", .help = "how often, such as '100 ms'"};

RunningCommand top_row() {
  return {
      .words = {.name = "top",
                .help = "Show the rtpus and tasks live, on the whole screen: q ends it",
                .options = {kEvery},
                .footer = "EXEC: mean execution time since the last update; MAX: longest so far; USED: MAX of BUDGET; "
                          "INPUT: age of the\noldest input",
                .example = "chimera top",
                .manual = "Shows the rtpus and tasks live on the whole screen. EXEC is the mean execution "
                          "time since the last "
                          "look, MAX the longest so far, USED that of BUDGET, INPUT the age of the oldest input. A "
                          "task that is not created has the state `none`. The keys o n e b j m a sort, the arrows "
                          "scroll, `q` ends. Without a terminal it prints one screen."},
      .method = "subscribe",
      .live = top,
      .names_its_subsystem = true};
}

RunningCommand watch_row() {
  return {.words = {.name = "watch",
                    .help = "Show values live, with their recent history",
                    .operands = "VAR...",
                    .least = 1,
                    .most = kAnyNumber,
                    .operand_kind = WordKind::kVariable,
                    .options = {kEvery},
                    .example = "chimera watch q tau[2]",
                    .manual = "Shows values live, one line each, with their recent history. Without a terminal it "
                              "prints a line each time."},
          .method = "subscribe",
          .live = watch};
}

RunningCommand why_row() {
  return {.words = {.name = "why",
                    .help = "Tell where a value comes from, and what is wrong with it",
                    .operands = "VAR",
                    .least = 1,
                    .most = 1,
                    .operand_kind = WordKind::kVariable,
                    .example = "chimera why tau",
                    .manual = "Names the producer of a variable, time and inputs of its value, and the first ancestor "
                              "that is wrong, stale or missing."},
          .method = "why",
          .once = why};
}

std::vector<RunningCommand> table() {
  std::vector<RunningCommand> rows = {clear_row(),  drill_row(), end_row(),    events_row(), flag_row(), get_row(),
                                      kill_row(),   off_row(),   on_row(),     profile_row(), receipts_row(),
                                      reinit_row(), ring_row(),  save_row(),   scope_row(),  sequence_row(),
                                      set_row(),    spawn_row(), status_row(), switch_row(), top_row(),
                                      watch_row(),  why_row()};
  constexpr std::string_view kRare[] = {"clear", "kill", "reinit", "ring", "spawn"};
  for (RunningCommand& row : rows) {
    row.words.which = kWhichOne;
    row.words.is_rare = std::ranges::find(kRare, row.words.name) != std::end(kRare);
  }
  return rows;
}

}  // namespace

std::span<const RunningCommand> running_commands() {
  static const std::vector<RunningCommand> kRows = table();
  return kRows;
}

const Command& help_words() {
  static const Command kWords{.name = "help",
                              .help = "List the commands, or describe one",
                              .operands = "[COMMAND]",
                              .most = 1,
                              .operand_kind = WordKind::kCommand,
                              .example = "help set",
                              .is_shells = true};
  return kWords;
}

const Command& quit_words() {
  static const Command kWords{
      .name = "quit", .help = "Leave the shell; the subsystem goes on", .example = "quit", .is_shells = true};
  return kWords;
}

Table shell_words() {
  static const std::vector<const Command*> kWords = [] {
    std::vector<const Command*> words = {&help_words(), &quit_words()};
    for (const RunningCommand& row : running_commands()) words.push_back(&row.words);
    std::ranges::sort(words, {}, [](const Command* command) { return std::string_view(command->name); });
    return words;
  }();
  return kWords;
}

const RunningCommand& row_of(const Call& call) {
  for (const RunningCommand& row : running_commands())
    if (&row.words == call.command) return row;
  CHIMERA_ASSERT(false);  // `help` and `quit` send no request
  return running_commands().front();
}

CommandResult one_shot(Session& session, const Call& call, const Screen& screen) {
  const RunningCommand& row = row_of(call);
  if (row.once != nullptr) return row.once(session, call, screen);
  return answered(session.ask(row.method, row.parameters == nullptr ? Json::object() : row.parameters(call)), call.json,
                  row.show);
}

}  // namespace chimera::cli
