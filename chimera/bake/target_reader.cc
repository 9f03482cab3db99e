// SPDX-License-Identifier: Apache-2.0
// Reads a target file key by key, first that of `like`, then its own.
#include <algorithm>
#include <array>

#include "chimera/bake/target.h"
#include "chimera/bake/target_values.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/description/draft_values.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/text/time_text.h"

namespace chimera::bake {
namespace {

constexpr std::array<std::string_view, 18> kTargetKeys = {
    "version",       "like", "cpu",   "board",    "clock_hz",   "tick", "flash",       "ram",       "stack",
    "handler_stack", "uart", "shell", "watchdog", "interrupts", "pins", "safe_writes", "resources", "events"};
constexpr std::array<std::string_view, 3> kCpus = {"cortex-m0plus", "cortex-m3", "cortex-m4"};
constexpr std::array<std::string_view, 3> kUartKeys = {"address", "interrupt", "baud"};
constexpr std::array<std::string_view, 3> kPinKeys = {"register", "bit", "access"};
constexpr std::array<std::string_view, 2> kTruth = {"true", "false"};
constexpr std::array<std::string_view, 2> kAccess = {"read", "write"};
constexpr std::array<std::string_view, 2> kWriteKeys = {"register", "value"};
constexpr std::uint64_t kLeastStack = 256, kMostStack = 1024 * 1024;

/// "mps2-an385" of "firmware/targets/mps2-an385.yaml".
std::string stem_of(std::string_view file) {
  file = file.substr(file.find_last_of('/') + 1);
  return std::string(file.substr(0, file.find_last_of('.')));
}

/// Letters, digits, '-', '_' and '.', not first: it is also the name of a folder.
bool is_file_name(std::string_view text) noexcept {
  constexpr std::string_view kLegal = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  return !text.empty() && text.size() <= 64 && text.find_first_not_of(kLegal) == std::string_view::npos;
}

class TargetReader {
 public:
  TargetReader(Target& target, Report& report) : target_(target), report_(report) {}

  void read(const Node& root) {
    refuse_unknown_keys(root, kTargetKeys, "the target", report_);
    if (const Node* node = required(root, "version", "the target", "write 'version: 1' as the first line", report_))
      read_whole(*node, 1, 1, "'version'", report_);
    processor(root);
    memories(root);
    if (const Node* node = root.find("interrupts")) interrupts(*node);
    if (const Node* node = root.find("uart")) uart(*node);
    if (const Node* node = root.find("shell"))
      if (const auto index = read_choice(*node, kTruth, "'shell'", report_)) target_.shell = index->value == 0;
    if (const Node* node = root.find("pins")) pins(*node);
    if (const Node* node = root.find("safe_writes")) safe_writes(*node);
    if (const Node* node = root.find("resources")) resources(*node);
    if (const Node* node = root.find("events")) events(*node);
  }

 private:
  void processor(const Node& root) {
    if (const Node* node = root.find("cpu"))
      if (const auto cpu = read_choice(*node, kCpus, "'cpu'", report_)) target_.cpu = kCpus[cpu->value];
    if (const Node* node = root.find("board"))
      if (const auto board = file_name(*node, "'board'")) target_.board = *board;
    if (const Node* node = root.find("clock_hz"))
      if (const auto hz = read_whole(*node, 1'000'000, 1'000'000'000, "'clock_hz'", report_))
        target_.clock_hz = hz->value;
    if (const Node* node = root.find("tick"))
      if (const auto tick = read_duration(*node, "'tick'", report_)) target_.tick = *tick;
    if (const Node* node = root.find("watchdog"))
      if (const auto time = read_duration(*node, "'watchdog'", report_)) target_.watchdog = time->value;
  }

  void memories(const Node& root) {
    if (const Node* node = root.find("flash"))
      if (const auto flash = read_memory(*node, "'flash'", report_)) target_.flash = *flash;
    if (const Node* node = root.find("ram"))
      if (const auto ram = read_memory(*node, "'ram'", report_)) target_.ram = *ram;
    stack(root, "stack", target_.stack_bytes);
    stack(root, "handler_stack", target_.handler_stack_bytes);
  }

  void stack(const Node& root, const char* key, std::uint32_t& bytes) {
    const Node* node = root.find(key);
    if (node == nullptr) return;
    const std::string what = in_quotes(key);
    const auto read = read_bytes(*node, kLeastStack, kMostStack, what, report_);
    if (!read) return;
    if (read->value % 8 != 0)
      bad(*node, what + " is " + written(*node) + "; expected a multiple of 8 bytes", "the core aligns its stacks");
    bytes = static_cast<std::uint32_t>(read->value);
  }

  void interrupts(const Node& map) {
    if (!expect(map, Node::Kind::kMap, "'interrupts'", report_, true)) return;
    target_.interrupts.clear();
    for (std::size_t i = 0; i < map.keys.size(); ++i) {
      if (!check_name(map.keys[i], "the interrupt", report_)) continue;
      const std::string what = "interrupt " + in_quotes(map.keys[i].text);
      const auto number = read_whole(map.items[i], 0, kLastInterrupt, what, report_);
      if (!number) continue;
      const auto same = std::ranges::find(target_.interrupts, number->value, &NamedInterrupt::number);
      if (same != target_.interrupts.end())
        bad(map.items[i], what + " has the number " + written(map.items[i]) + " of " + in_quotes(same->name.text),
            "give each interrupt one name");
      target_.interrupts.push_back({map.keys[i], number->value});
    }
  }

  void uart(const Node& map) {
    constexpr const char* kForm = "write {address: 0x40004000, interrupt: NAME, baud: 115200}";
    if (!expect(map, Node::Kind::kMap, "'uart'", report_)) return;
    refuse_unknown_keys(map, kUartKeys, "'uart'", report_);
    SerialLine line;
    if (const Node* node = required(map, "address", "'uart'", kForm, report_))
      line.address = read_address(*node, "'address' of 'uart'", report_).value_or(0);
    if (const Node* node = required(map, "interrupt", "'uart'", kForm, report_))
      line.interrupt = read_name(*node, "'interrupt' of 'uart'", report_).value_or(Word{});
    if (const Node* node = required(map, "baud", "'uart'", kForm, report_))
      if (const auto baud = read_whole(*node, 300, 4'000'000, "'baud' of 'uart'", report_)) line.baud = baud->value;
    target_.uart = line;
  }

  void pins(const Node& map) {
    if (!expect(map, Node::Kind::kMap, "'pins'", report_, true)) return;
    target_.pins.clear();
    for (std::size_t i = 0; i < map.keys.size(); ++i)
      if (check_name(map.keys[i], "the pin", report_)) pin(map.keys[i], map.items[i]);
  }

  void pin(const Word& name, const Node& map) {
    constexpr const char* kForm = "write {register: 0x40028000, bit: 0, access: read}";
    const std::string what = "pin " + in_quotes(name.text);
    if (!expect(map, Node::Kind::kMap, what, report_)) return;
    refuse_unknown_keys(map, kPinKeys, what, report_);
    NamedPin made{.name = name};
    if (const Node* node = required(map, "register", what, kForm, report_))
      made.address = read_address(*node, "'register' of " + what, report_).value_or(0);
    if (const Node* node = required(map, "bit", what, kForm, report_))
      if (const auto bit = read_whole(*node, 0, 31, "'bit' of " + what, report_)) made.bit = bit->value;
    if (const Node* node = required(map, "access", what, kForm, report_))
      if (const auto access = read_choice(*node, kAccess, "'access' of " + what, report_))
        made.is_output = access->value == 1;
    target_.pins.push_back(made);
  }

  void safe_writes(const Node& list) {
    if (!expect(list, Node::Kind::kList, "'safe_writes'", report_, true)) return;
    target_.safe_writes.clear();
    if (list.items.size() > kMostSafeWrites)
      report_.add({.rule = "count-limit",
                   .at = list.at,
                   .message = "'safe_writes' has " + std::to_string(list.items.size()) + " entries; at most " +
                              std::to_string(kMostSafeWrites) + " are written",
                   .remedy = "keep those that stop a motion"});
    for (std::size_t i = 0; i < std::min(list.items.size(), kMostSafeWrites); ++i) {
      constexpr const char* kForm = "write {register: 0x40028000, value: 0}";
      const std::string what = "entry " + std::to_string(i) + " of 'safe_writes'";
      const Node& map = list.items[i];
      if (!expect(map, Node::Kind::kMap, what, report_)) continue;
      refuse_unknown_keys(map, kWriteKeys, what, report_);
      SafeWrite write;
      if (const Node* node = required(map, "register", what, kForm, report_))
        write.address = read_address(*node, "'register' of " + what, report_).value_or(0);
      if (const Node* node = required(map, "value", what, kForm, report_))
        write.value = read_word(*node, "'value' of " + what, report_).value_or(0);
      target_.safe_writes.push_back(write);
    }
  }

  void resources(const Node& map) {
    if (!expect(map, Node::Kind::kMap, "'resources'", report_, true)) return;
    target_.resources.clear();
    for (std::size_t t = 0; t < map.keys.size(); ++t) {
      const std::string what = "'resources' of task " + in_quotes(map.keys[t].text);
      const Node& ports = map.items[t];
      if (!check_name(map.keys[t], "the task", report_) || !expect(ports, Node::Kind::kMap, what, report_)) continue;
      for (std::size_t p = 0; p < ports.keys.size(); ++p)
        texts({map.keys[t], ports.keys[p], {}, false}, ports.items[p]);
    }
  }

  void texts(ResourceTexts made, const Node& node) {
    const std::string what = "resource " + in_quotes(made.port.text) + " of task " + in_quotes(made.task.text);
    made.is_list = node.is_list();
    const Node* const nodes = made.is_list ? node.items.data() : &node;
    for (std::size_t i = 0; i < (made.is_list ? node.items.size() : 1); ++i)
      if (const auto text = read_text(nodes[i], what, report_)) made.texts.push_back(*text);
    target_.resources.push_back(std::move(made));
  }

  void events(const Node& map) {
    if (!expect(map, Node::Kind::kMap, "'events'", report_, true)) return;
    target_.events.clear();
    for (std::size_t i = 0; i < map.keys.size(); ++i) {
      const std::string what = "the event of task " + in_quotes(map.keys[i].text);
      if (!check_name(map.keys[i], "the task", report_)) continue;
      if (const auto interrupt = read_name(map.items[i], what, report_))
        target_.events.push_back({map.keys[i], *interrupt});
    }
  }

  std::optional<std::string> file_name(const Node& node, const std::string& what) {
    if (node.is_scalar() && is_file_name(node.text)) return node.text;
    bad(node, what + " is " + written(node) + "; expected letters, digits, '-' and '_', at most 64",
        "it is the name of a folder or a file");
    return std::nullopt;
  }

  void bad(const Node& node, std::string message, std::string remedy) {
    report_.add({.rule = "number-bad",
                 .at = node.at,
                 .message = std::move(message),
                 .found = node.text,
                 .remedy = std::move(remedy)});
  }

  Target& target_;
  Report& report_;
};

/// The parts of one target judged together, when all keys are read.
class WholeTarget {
 public:
  WholeTarget(const Target& target, const Node& root, Report& report)
      : target_(target), root_(root), report_(report) {}

  void judge() {
    missing(target_.cpu.empty(), "cpu", "write 'cpu: cortex-m3', or 'like:' and the name of a target");
    missing(target_.board.empty(), "board", "write the name of a folder of firmware/boards");
    missing(target_.clock_hz == 0, "clock_hz", "write the frequency of the core, as 25000000");
    missing(target_.flash.bytes == 0, "flash", "write {address: 0x00000000, size: 64 KiB}");
    missing(target_.ram.bytes == 0, "ram", "write {address: 0x20000000, size: 20 KiB}");
    if (target_.clock_hz != 0) tick();
    overlap();
    std::vector<std::string> names = names_of(target_.interrupts, [](const auto& i) { return i.name.text; });
    if (target_.uart) interrupt(target_.uart->interrupt, names);
    for (const EventLine& event : target_.events) interrupt(event.interrupt, names);
  }

 private:
  void missing(bool is_missing, const char* key, const char* remedy) {
    if (is_missing && root_.find(key) == nullptr) required(root_, key, "the target", remedy, report_);
  }

  void tick() {
    const std::int64_t ns = target_.tick.value.count;
    const bool is_whole = ns > 0 && ns <= INT64_MAX / target_.clock_hz && ns * target_.clock_hz % 1'000'000'000 == 0;
    const std::int64_t cycles = is_whole ? ns * target_.clock_hz / 1'000'000'000 : 0;
    if (cycles > 0 && cycles <= kMostTickCycles) return;
    report_.add({.rule = "time-range",
                 .at = target_.tick.at,
                 .message = "'tick' is " + time_text(target_.tick.value) + ", which is no whole number of 1 to " +
                            std::to_string(kMostTickCycles) + " cycles of " + std::to_string(target_.clock_hz) + " Hz",
                 .remedy = "1 ms suits most applications; the timer of the core has 24 bits"});
  }

  void overlap() {
    const MemoryRange &flash = target_.flash, &ram = target_.ram;
    const bool is_apart = std::uint64_t{flash.address} + flash.bytes <= ram.address ||
                          std::uint64_t{ram.address} + ram.bytes <= flash.address;
    if (!is_apart && flash.bytes != 0 && ram.bytes != 0)
      report_.add({.rule = "number-bad",
                   .at = ram.at,
                   .message = "'ram' and 'flash' overlap",
                   .remedy = "take address and size of each from the manual of the chip"});
    const std::uint64_t stacks = std::uint64_t{target_.stack_bytes} + target_.handler_stack_bytes;
    if (ram.bytes != 0 && stacks >= ram.bytes)
      report_.add({.rule = "number-bad",
                   .at = ram.at,
                   .message = "'stack' and 'handler_stack' take " + std::to_string(stacks) + " of the " +
                              std::to_string(ram.bytes) + " bytes of 'ram'",
                   .remedy = "both lie in 'ram', with the states of all tasks"});
  }

  void interrupt(const Word& name, std::span<const std::string> names) {
    if (name.empty() || target_.interrupt(name.text)) return;
    std::vector<std::string_view> views(names.begin(), names.end());
    report_.add({.rule = "word-unknown",
                 .at = name.at,
                 .message = "'interrupts' has no " + in_quotes(name.text) + "; it has " + listed(names),
                 .found = name.text,
                 .expected = listed(names),
                 .nearest = closest(name.text, views),
                 .remedy = names.empty() ? "write 'interrupts: {" + name.text + ": NUMBER}'" : ""});
  }

  const Target& target_;
  const Node& root_;
  Report& report_;
};

std::optional<Node> root_of(std::string_view text, Report& report) {
  std::optional<Node> root = read_yaml(text, report);
  if (root && expect(*root, Node::Kind::kMap, "the file", report)) return root;
  return std::nullopt;
}

/// Starts with the keys of the target that `node` names.
void read_like(const Node& node, const FindTarget& find, Target& target, Report& report) {
  const auto refuse = [&](std::string message, std::string remedy) {
    report.add({.rule = "word-unknown",
                .at = node.at,
                .message = std::move(message),
                .found = node.text,
                .remedy = std::move(remedy)});
  };
  if (!node.is_scalar() || !is_file_name(node.text))
    return refuse("'like' is " + written(node) + "; expected the name of a target", "as mps2-an385");
  std::string file;
  const std::optional<std::string> text = find(node.text, file);
  if (!text) return refuse("there is no target " + in_quotes(node.text), "firmware/targets has a file for each");
  Report inner(file);
  if (const auto root = root_of(*text, inner)) {
    TargetReader(target, inner).read(*root);
    if (root->find("like") != nullptr) refuse("target " + in_quotes(node.text) + " has 'like' itself", "name that one");
  }
  // Later faults of these values stand at `like`, because this report is about the other file.
  target.tick.at = target.ram.at = node.at;
  if (target.uart) target.uart->interrupt.at = node.at;
  for (ResourceTexts& each : target.resources) each.task.at = each.port.at = node.at;
  for (EventLine& each : target.events) each.task.at = each.interrupt.at = node.at;
  for (const Fault& fault : inner.faults())
    if (fault.severity == Severity::kError)
      refuse(file + ":" + std::to_string(fault.at.line) + ": " + fault.message, fault.remedy);
}

}  // namespace

ReadTarget read_target(std::string_view text, std::string_view file, const FindTarget& find) {
  ReadTarget reading{std::nullopt, Report(std::string(file))};
  Report& report = reading.report;
  if (const std::optional<Node> root = root_of(text, report)) {
    Target target;
    if (const Node* node = root->find("like")) read_like(*node, find, target, report);
    TargetReader(target, report).read(*root);
    target.name = stem_of(file);
    if (report.is_legal()) WholeTarget(target, *root, report).judge();
    if (report.is_legal()) reading.target = std::move(target);
  }
  report.sort();
  return reading;
}

}  // namespace chimera::bake
