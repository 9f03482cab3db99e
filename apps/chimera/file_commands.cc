// SPDX-License-Identifier: Apache-2.0
// The commands that look at descriptions and components: check, schedule, list, describe, new.
#include <cstdio>

#include "apps/chimera/commands.h"
#include "apps/chimera/option_values.h"
#include "chimera/cli/files/check.h"
#include "chimera/cli/files/list.h"
#include "chimera/cli/files/new.h"
#include "chimera/cli/files/schedule.h"

using namespace chimera;  // NOLINT: a part of a main()
using cli::Call;
using cli::WordKind;

namespace {

int check(const Call& call, const Workplace& workplace) {
  return print(cli::check({.file = call.operand(0),
                           .json = call.json,
                           .graph = call.value("--graph"),
                           .modes = call.has("--modes"),
                           .settings = settings_of(call)},
                          workplace));
}

int schedule(const Call& call, const Workplace& workplace) {
  return print(cli::schedule({.file = call.operand(0),
                              .profile = call.value("--profile"),
                              .svg = call.value("--svg"),
                              .dispatch = call.value("--dispatch"),
                              .json = call.json,
                              .settings = settings_of(call)},
                             workplace));
}

int list(const Call& call, const Workplace& workplace) { return print(cli::list(workplace, call.json)); }

int describe(const Call& call, const Workplace& workplace) {
  return print(cli::describe_component(call.operand(0), workplace, call.json));
}

int make(cli::NewKind kind, const Call& call) {
  return print(cli::new_project({.kind = kind, .name = call.operand(0)}, program_path()));
}

int new_component(const Call& call, const Workplace&) {
  using cli::NewKind;
  return make(call.has("--c")          ? NewKind::kComponentInC
              : call.has("--hardware") ? NewKind::kHardwareComponent
                                       : NewKind::kComponent,
              call);
}

int new_application(const Call& call, const Workplace&) { return make(cli::NewKind::kApplication, call); }
int new_firmware(const Call& call, const Workplace&) { return make(cli::NewKind::kFirmware, call); }

}  // namespace

FileCommand check_row() {
  return {.words = {.name = "check",
                    .help = "Prove a description legal, or name every fault with its place",
                    .operands = "FILE",
                    .least = 1,
                    .most = 1,
                    .operand_kind = WordKind::kDescription,
                    .operand_help = "the description",
                    .options = {set_option("This value instead of the file's, judged by the same rules. VAR is an "
                                           "operator variable, a constant of the file, or TASK.CONSTANT for a constant "
                                           "that one task has for itself. May be repeated."),
                                {.name = "--graph",
                                 .value = "FORMAT",
                                 .help = "draw it instead: dot, svg or text",
                                 .manual = "Draws the application instead: `dot`, `svg` or `text`.",
                                 .kind = WordKind::kOneOf,
                                 .words = "dot svg text"},
                                {.name = "--modes",
                                 .help = "judge the switches between its configurations instead",
                                 .manual = "Judges the switch from each configuration to each other instead: who asks "
                                           "for it without a person, whether every deadline holds over it, and which "
                                           "constants may become others under a task that stays. Takeovers by "
                                           "standbys are judged too. Exit code 1 also when a switch that a reaction "
                                           "asks for would lose a deadline.",
                                 .excludes = "--graph"}},
                    .json = "the report as one JSON object",
                    .example = "chimera check examples/01_puma_pid/puma_pid.yaml --graph svg > puma.svg",
                    .manual = "Reads the description FILE and prints every fault with its place, or the verdict that "
                              "it is legal."},
          .carry_out = check};
}

FileCommand schedule_row() {
  return {.words = {.name = "schedule",
                    .help = "Prove that every task keeps its deadlines, or tell what would help",
                    .operands = "FILE",
                    .least = 1,
                    .most = 1,
                    .operand_kind = WordKind::kDescription,
                    .operand_help = "the description",
                    .options = {set_option("This value instead of the file's, as of `run`."),
                                {.name = "--profile",
                                 .value = "FILE",
                                 .help = "execution times from this recorded profile, else from budgets",
                                 .manual = "Execution times from this recorded profile (docs/formats/profile.md); of "
                                           "tasks that it does not have from the budgets.",
                                 .kind = WordKind::kFile},
                                {.name = "--svg",
                                 .value = "FILE",
                                 .help = "draw the worst window of each CPU into this file",
                                 .manual = "Draws the worst window of each CPU into this file.",
                                 .kind = WordKind::kFile},
                                {.name = "--dispatch",
                                 .value = "HOW",
                                 .help = "judge all rtpus as 'preemptive' or 'executive' (non-preemptive); else each "
                                         "as described",
                                 .manual = "Whether a running job can be preempted, in all rtpus: `preemptive` or "
                                           "`executive`; without it each as the description says.",
                                 .kind = WordKind::kOneOf,
                                 .words = "preemptive executive"}},
                    .json = "the analysis as one JSON object",
                    .footer = "Response: longest time from release to end. Blocked: longest wait for a job that is not "
                              "preempted.\nCopies: at each cycle, from tables of other rtpus or the operator. `run` "
                              "starts only when every task\nkeeps its deadline, those with 'may miss' apart.\n"
                              "Exit code 0: everything keeps its deadlines; 1: it does not.",
                    .example = "chimera schedule examples/01_puma_pid/puma_pid.yaml --svg window.svg",
                    .manual = "Proves that every task of FILE keeps its deadlines, or names the tasks that do not, the "
                              "tasks that give way first, and what would fit; for each CPU the load, the longest "
                              "responses, the worst window, and how old data gets from sensors to actuators."},
          .carry_out = schedule};
}

FileCommand list_row() {
  return {.words = {.name = "list",
                    .help = "Name the installed components",
                    .json = "as one JSON object",
                    .footer = "Components are looked for along CHIMERA_PATH, then beside the program.",
                    .example = "chimera list",
                    .manual = "Names the installed components."},
          .carry_out = list};
}

FileCommand describe_row() {
  return {.words = {.name = "describe",
                    .help = "Show the data sheet of a component",
                    .operands = "NAME",
                    .least = 1,
                    .most = 1,
                    .operand_kind = WordKind::kComponent,
                    .operand_help = "the component",
                    .json = "its descriptor",
                    .example = "chimera describe pid_joint",
                    .manual = "Shows the data sheet of the component NAME."},
          .carry_out = describe};
}

FileCommand new_row() {
  return {.words = {.name = "new",
                    .help = "Make a project that builds and passes its tests at once",
                    .json = nullptr,
                    .manual = "Makes a project that builds and passes its tests at once, in a folder called as the "
                              "project: `component`, `app` or `firmware`.",
                    .has_commands = true}};
}

constexpr const char* kProjectName = "[a-z][a-z0-9_]*; also the name of the folder";

FileCommand new_component_row() {
  return {.words = {.name = "new component",
                    .help = "One component and its test",
                    .operands = "NAME",
                    .least = 1,
                    .most = 1,
                    .operand_help = kProjectName,
                    .options = {{.name = "--c", .help = "in C instead of C++"},
                                {.name = "--hardware",
                                 .help = "a driver of a serial device, tested on a pseudo terminal",
                                 .manual = "A driver of a serial device, with a test on a pseudo terminal.",
                                 .excludes = "--c"}},
                    .json = nullptr,
                    .example = "chimera new component low_pass"},
          .carry_out = new_component};
}

FileCommand new_application_row() {
  return {.words = {.name = "new app",
                    .help = "A description, a component of its own, and a script that runs it",
                    .operands = "NAME",
                    .least = 1,
                    .most = 1,
                    .operand_help = kProjectName,
                    .json = nullptr,
                    .example = "chimera new app pendulum"},
          .carry_out = new_application};
}

FileCommand new_firmware_row() {
  return {.words = {.name = "new firmware",
                    .help = "An application for a microcontroller, and a script that runs it in QEMU",
                    .operands = "NAME",
                    .least = 1,
                    .most = 1,
                    .operand_help = kProjectName,
                    .json = nullptr,
                    .example = "chimera new firmware thermostat"},
          .carry_out = new_firmware};
}
