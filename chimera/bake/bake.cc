// SPDX-License-Identifier: Apache-2.0
// Collects the refusals, then writes each file of an image.
#include "chimera/bake/bake.h"

#include <cstdio>
#include <set>

#include "chimera/bake/application.h"
#include "chimera/bake/dictionary.h"
#include "chimera/bake/refusals.h"
#include "chimera/bake/tables.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/text/time_text.h"

namespace chimera::bake {
namespace {

std::string components_text(const ApplicationSpec& spec) {
  std::set<std::string> names;
  for (const TaskSpec& task : spec.tasks) names.emplace(task.component);
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

std::string memory_text(const Target& target) {
  const auto line = [](const char* name, const MemoryRange& range) {
    char text[80];
    std::snprintf(text, sizeof text, "  %s : ORIGIN = 0x%08x, LENGTH = %u\n", name, range.address, range.bytes);
    return std::string(text);
  };
  return "/* Made by `chimera bake`. */\nMEMORY {\n" + line("FLASH (rx)", target.flash) +
         line("RAM (rwx)", target.ram) + "}\nchimera_stack_bytes = " + std::to_string(target.stack_bytes) +
         ";\nchimera_handler_stack_bytes = " + std::to_string(target.handler_stack_bytes) + ";\n";
}

/// Reactions of tasks that have no effect in the image.
std::vector<std::string> notes_of(const BakeInput& input) {
  std::vector<std::string> notes;
  if (input.profile != nullptr) return notes;
  notes.emplace_back("without --profile no deadline is judged: run the image, save its profile, and bake again");
  std::string idle;
  for (const TaskSpec& task : input.configuration.spec().tasks)
    if (task.budget.count > 0 && task.on_overrun != OnMiss::kContinue) append_joined(idle, ", ", in_quotes(task.name));
  if (!idle.empty())
    notes.push_back("'on_overrun' never acts without --profile, because budgets of the description are left out: " +
                    idle);
  return notes;
}

/// Switches that the image makes the slow way for deadlines, by the times of the profile.
void note_slow_switches(const ApplicationSpec& spec, std::vector<std::string>& notes) {
  const std::size_t n = spec.plans == nullptr ? 0 : spec.sets.size() * spec.sets.size();
  for (const SwitchPlan& plan : std::span(spec.plans, n)) {
    if (plan.deadline == nullptr || *plan.deadline) continue;
    const TaskSpec& task = spec.tasks[plan.deadline->task.index];
    const std::string ends = plan.deadline->takes == kNever ? "no bound was found for it"
                                                            : "it would end up to " + time_text(plan.deadline->takes) +
                                                                  " after its release";
    notes.push_back("the switch from " + in_quotes(spec.sets[plan.before].name) + " to " +
                    in_quotes(spec.sets[plan.after].name) + " turns tasks OFF first: otherwise task " +
                    in_quotes(task.name) + " could miss its deadline of " + time_text(task.deadline) + " (" + ends +
                    ")");
  }
}

}  // namespace

BakeResult bake(const BakeInput& input) {
  const Configuration& configuration = input.configuration;
  const Target& target = input.target;
  BakeResult result{.description = Report(configuration.file(), configuration.draft().keys),
                    .target = Report(input.target_file),
                    .memory = {},
                    .mechanisms = {},
                    .notes = notes_of(input),
                    .files = {}};
  refuse_times(configuration, target, result.description);
  refuse_features(configuration, input.library, result.description);
  refuse_unserved(configuration, target, result.description);
  if (input.profile != nullptr) refuse_late(configuration, *input.profile, target, result.description);
  refuse_unknown(configuration, target, result.target);
  if (input.link.is_there()) refuse_link(configuration, input.link, target, result.description, result.target);

  BakedApplication application(configuration, target, input.profile);
  if (input.link.is_there()) application.start_nothing();
  const ApplicationSpec& spec = application.spec();
  const std::vector<ScriptAct> acts = application.acts(input.acts);
  const baked::Run run{spec.rtpus.empty() ? Policy::kEdf : spec.rtpus[0].policy, target.tick.value, input.duration,
                       acts, input.link.period, input.link.stale_after};
  result.memory = memory_need(spec, input.acts.size(), target);
  if (input.link.is_there()) result.memory.shared_ram_bytes += link_ram(spec);
  result.mechanisms = mechanisms(spec, run, target);
  note_slow_switches(spec, result.notes);
  refuse_memory(result.memory, target, result.target);
  result.description.sort();
  result.target.sort();
  if (!result.description.is_legal() || !result.target.is_legal()) return result;
  result.files = {{"components.txt", components_text(spec)},
                  {"cpu.flags", "-mcpu=" + target.cpu + " -mthumb\n"},
                  {"dictionary.json", dictionary_text(application, target)},
                  {"mechanisms.h", mechanisms_text(result.mechanisms)},
                  {"memory.ld", memory_text(target)},
                  {"tables.cc", tables_text(spec, run, target)}};
  return result;
}

}  // namespace chimera::bake
