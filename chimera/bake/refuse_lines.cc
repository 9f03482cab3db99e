// SPDX-License-Identifier: Apache-2.0
// Compares the resource ports and the events of a description with the lines of a target.
#include <algorithm>

#include "chimera/bake/application.h"
#include "chimera/bake/refusals.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/description/draft_values.h"

namespace chimera::bake {
namespace {

std::string example(const std::string& task, const std::string& port) {
  return "write 'resources: {" + task + ": {" + port + ": TEXT}}' in the target";
}

/// A resource port of this name names a line of the target.
bool is_pin(std::string_view port) noexcept { return port == "pin"; }
bool is_interrupt(std::string_view port) noexcept { return port == "interrupt"; }
bool is_serial(std::string_view port) noexcept { return port == "device"; }

class UnknownLines {
 public:
  UnknownLines(const Configuration& configuration, const Target& target, Report& report)
      : configuration_(configuration), target_(target), report_(report) {}

  void judge() {
    for (const ResourceTexts& each : target_.resources) judge(each);
    for (const EventLine& each : target_.events) judge(each);
  }

 private:
  const ConfiguredTask* task(const Word& name) {
    const auto tasks = configuration_.tasks();
    const auto found = std::ranges::find(tasks, name.text, &ConfiguredTask::name);
    if (found != tasks.end()) return &*found;
    unknown(name, "the description has no task " + in_quotes(name.text), names_of(tasks, &ConfiguredTask::name),
            "tasks");
    return nullptr;
  }

  void judge(const ResourceTexts& each) {
    const ConfiguredTask* const of = task(each.task);
    if (of == nullptr) return;
    std::size_t n = 0;
    std::vector<std::string> names;
    for (const ConfiguredPort& port : of->ports) {
      if (port.kind != CHIMERA_RESOURCE) continue;
      if (declared_name(port) == each.port.text) ++n;
      else if (std::ranges::find(names, declared_name(port)) == names.end()) names.push_back(declared_name(port));
    }
    if (n == 0)
      return unknown(each.port, "task " + in_quotes(of->name) + " has no resource port " + in_quotes(each.port.text),
                     names, "resource ports");
    if (n != each.texts.size())
      report_.add({.rule = "resource-missing",
                   .at = each.port.at,
                   .message = "resource " + in_quotes(each.port.text) + " of task " + in_quotes(of->name) + " has " +
                              counted(each.texts.size(), "text") + "; the description has " + counted(n, "instance"),
                   .remedy = "write a list with a text for each instance"});
    for (const Word& text : each.texts) line(each.port.text, text);
  }

  void line(const std::string& port, const Word& text) {
    const auto name = [](const auto& item) { return item.name.text; };
    if (is_pin(port) && !target_.has_pin(text.text))
      unknown(text, "the target has no pin " + in_quotes(text.text), names_of(target_.pins, name), "pins");
    if (is_interrupt(port) && !target_.interrupt(text.text))
      unknown(text, "the target has no interrupt " + in_quotes(text.text), names_of(target_.interrupts, name),
              "interrupts");
    if (is_serial(port)) serial(text);
  }

  void serial(const Word& text) {
    if (!target_.uart || text.text != "uart")
      return unknown(text, "the target has no serial line " + in_quotes(text.text),
                     target_.uart ? std::vector<std::string>{"uart"} : std::vector<std::string>{}, "serial lines");
    const ResourceTexts& first = *target_.user_of_uart();
    if (&first.texts[0] != &text)
      refuse("resource-twice", text, "'uart' belongs to task " + in_quotes(first.task.text),
             "take one of the two tasks out");
  }

  void judge(const EventLine& each) {
    const ConfiguredTask* const of = task(each.task);
    if (of == nullptr) return;
    const auto index = static_cast<std::size_t>(of - configuration_.tasks().data());
    if (!configuration_.spec().tasks[index].aperiodic)
      refuse("not-built", each.task, "task " + in_quotes(of->name) + " has no method 'sync', so it takes no events",
             "take the line out of 'events'");
    const bool is_of_uart = target_.uart && target_.uart->interrupt.text == each.interrupt.text;
    const auto is_same = [&each](const EventLine& other) { return other.interrupt.text == each.interrupt.text; };
    const auto first = std::ranges::find_if(target_.events, is_same);
    if (is_of_uart || &*first != &each)
      refuse("resource-twice", each.interrupt, "the interrupt " + in_quotes(each.interrupt.text) + " belongs to " +
             (is_of_uart ? "'uart'" : "task " + in_quotes(first->task.text)), "give each task an interrupt of its own");
  }

  void refuse(const char* rule, const Word& word, std::string message, std::string remedy) {
    report_.add({.rule = rule, .at = word.at, .message = std::move(message), .found = word.text,
                 .remedy = std::move(remedy)});
  }

  void unknown(const Word& word, std::string message, const std::vector<std::string>& names, const char* what) {
    const std::vector<std::string_view> views(names.begin(), names.end());
    report_.add({.rule = "word-unknown",
                 .at = word.at,
                 .message = std::move(message),
                 .found = word.text,
                 .expected = listed(names),
                 .nearest = closest(word.text, views),
                 .remedy = closest(word.text, views).empty() ? "its " + std::string(what) + ": " + listed(names) : ""});
  }

  const Configuration& configuration_;
  const Target& target_;
  Report& report_;
};

}  // namespace

void refuse_unserved(const Configuration& configuration, const Target& target, Report& report) {
  for (const ConfiguredTask& task : configuration.tasks()) {
    for (const ConfiguredPort& port : task.ports)
      if (port.kind == CHIMERA_RESOURCE && target.resource(task.name, declared_name(port)) == nullptr)
        report.add({.rule = "resource-missing",
                    .at = port.at,
                    .message = "resource " + in_quotes(declared_name(port)) + " of task " + in_quotes(task.name) +
                               " has no text in the target " + in_quotes(target.name),
                    .expected = "a text",
                    .remedy = example(task.name, declared_name(port)),
                    .task = task.name,
                    .port = port.name});
    const bool has_interrupt =
        std::ranges::any_of(target.events, [&task](const EventLine& event) { return event.task.text == task.name; });
    if (task.has_event_source && !has_interrupt)
      report.add({.rule = "resource-missing",
                  .at = task.at,
                  .message = "the events of task " + in_quotes(task.name) +
                             " come from a descriptor on Linux, and the target " + in_quotes(target.name) +
                             " gives it no interrupt",
                  .remedy = "write 'events: {" + task.name + ": INTERRUPT}' in the target",
                  .task = task.name});
  }
}

void refuse_unknown(const Configuration& configuration, const Target& target, Report& report) {
  UnknownLines(configuration, target, report).judge();
}

}  // namespace chimera::bake
