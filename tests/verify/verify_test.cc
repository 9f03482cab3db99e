// SPDX-License-Identifier: Apache-2.0
// Each NAME.yaml of faulty/ and good/ is read, verified against components/, and judged for the executors; its whole
// report must be NAME.expected to the letter. UPDATE=1 writes them: read the difference before it is committed. Each
// fault also stands at the task, port and configuration of its message, and the outline shows what the text says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "chimera/analysis/schedule_report.h"
#include "chimera/base/testing/tree_path.h"
#include "chimera/catalogue/library.h"
#include "chimera/description/edit/text_edit.h"
#include "chimera/description/yaml_reader.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/offers.h"
#include "chimera/verify/verify.h"

namespace chimera {
namespace {

namespace fs = std::filesystem;

fs::path folder() { return source_path("tests/verify"); }

const Library& library() {
  static const Library kLibrary = [] {
    const std::string folders[] = {folder() / "components"};
    Library made = Library::make(folders, our_units());
    for (const Error& fault : made.faults()) ADD_FAILURE() << fault.where.view() << ": " << fault.message.view();
    return made;
  }();
  return kLibrary;
}

std::string contents(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream out;
  out << stream.rdbuf();
  return out.str();
}

std::vector<fs::path> descriptions(const char* kind) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::directory_iterator(folder() / kind))
    if (entry.path().extension() == ".yaml") out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

std::string name_of(const testing::TestParamInfo<fs::path>& info) { return info.param.stem().string(); }

/// Output of `check`, and below "run:" the refusals of `run`.
std::string judged(const fs::path& path) {
  ReadDescription reading = read_description(contents(path), path.filename().string());
  const Verdict verdict = verify(reading, library());
  EXPECT_EQ(verdict.configuration.has_value(), verdict.report.is_legal());
  std::string out = verdict.report.text();
  if (!verdict.configuration) return out;
  Report run = unsupported(*verdict.configuration, Executor::kProcesses);
  if (run.is_legal()) run.add_all(unschedulable(*verdict.configuration, schedule_report(*verdict.configuration, {})));
  return run.is_legal() ? out + "legal\n" : out + "run:\n" + run.text();
}

struct Description : ::testing::TestWithParam<fs::path> {};
struct FaultyDescription : Description {};
struct GoodDescription : Description {};

void compare(const fs::path& path, const std::string& report) {
  const fs::path expected = fs::path(path).replace_extension(".expected");
  if (std::getenv("UPDATE") != nullptr) std::ofstream(expected, std::ios::binary) << report;
  EXPECT_EQ(report, contents(expected)) << path;
}

TEST_P(FaultyDescription, HasExactlyItsReport) {
  const std::string report = judged(GetParam());
  compare(GetParam(), report);
  EXPECT_NE(report.find('['), std::string::npos) << "a faulty description without a fault";
}

TEST_P(GoodDescription, IsLegal) {
  const std::string report = judged(GetParam());
  compare(GetParam(), report);
  EXPECT_EQ(report.substr(0, report.find("run:\n")).find("error:"), std::string::npos) << report;
}

/// The node at a path, and the place of its key.
struct Found {
  const Node* node = nullptr;
  Place key;
};

Found at_path(const Node& root, const std::string& path) {
  Found at{&root, root.at};
  std::istringstream parts(path);
  for (std::string part; std::getline(parts, part, '/');) {
    if (at.node->is_list()) {
      at.node = &at.node->items.at(std::stoul(part));
      at.key = at.node->at;
      continue;
    }
    const auto key = std::ranges::find(at.node->keys, part, &Word::text);
    if (key == at.node->keys.end()) return {};
    at = {&at.node->items[static_cast<std::size_t>(key - at.node->keys.begin())], key->at};
  }
  return at;
}

/// True if the message has `name` in quotes, as 'name[3]' or on an arrow, or the path has it as a part.
bool speaks_of(const Fault& fault, const std::string& name) {
  const auto has = [&](const std::string& words) { return fault.message.find(words) != std::string::npos; };
  return has("'" + name + "'") || has("'" + name + "[") || has("-" + name + "->") ||
         ("/" + fault.path + "/").find("/" + name + "/") != std::string::npos;
}

std::set<std::string> tasks_of(const std::string& message) {
  static const std::regex kTask("tasks? '([^']*)'");
  std::set<std::string> names;
  for (std::sregex_iterator at(message.begin(), message.end(), kTask), end; at != end; ++at) names.insert((*at)[1]);
  return names;
}

void check_task(const Fault& fault, const Outline& outline) {
  const auto task = std::ranges::find(outline.tasks, fault.task, &OutlineTask::name);
  if (!fault.path.starts_with("tasks/" + fault.task)) {
    ASSERT_NE(task, outline.tasks.end()) << fault.message;
    const std::set<std::string> named = tasks_of(fault.message);
    EXPECT_TRUE(named.empty() || named.contains(fault.task)) << fault.message << ": " << fault.task;
  }
  if (fault.port.empty()) return;
  const bool is_written = fault.path.find('/' + fault.port.substr(0, fault.port.find('['))) != std::string::npos;
  std::vector<std::string> names{fault.port, fault.port.substr(0, fault.port.find('['))};
  bool is_there = false;
  for (const OutlinePort& port : task->ports)
    if (port.name == fault.port || port.declared == fault.port) is_there = true, names.push_back(port.variable);
  for (const OutlineRepeated& port : task->repeated) is_there |= port.name == fault.port;
  EXPECT_TRUE(is_there || is_written) << fault.message << ": " << fault.port;
  EXPECT_TRUE(std::ranges::any_of(names, [&](const auto& name) { return speaks_of(fault, name); }))
      << fault.message << ": " << fault.port;
}

// Rules whose faults have a port, and rules whose faults have at least a task.
const std::set<std::string_view> kAtPorts = {
    "input-unmet",    "two-producers",  "operator-produced", "type-clash",         "struct-clash",
    "unit-clash",     "shape-clash",    "type-unsolved",     "unit-unsolved",      "extent-unsolved",
    "type-contradiction", "unit-contradiction", "extent-contradiction", "constant-two-producers", "constant-produced",
    "constant-unmet", "resource-missing", "resource-twice",  "port-unknown",       "port-kind",
    "port-stream",    "alias-list",     "repeated-port",     "loop-without-initial"};
const std::set<std::string_view> kAtTasks = {"rate-missing", "time-range",        "utilisation", "component-unknown",
                                             "rtpu-unknown", "constant-circle",   "rtpu-band",   "standby-outputs",
                                             "server-key",   "server-periodic",   "safe-after",  "standby-unknown"};

TEST_P(FaultyDescription, PutsEachFaultAtItsBox) {
  const ReadDescription reading = read_description(contents(GetParam()), GetParam().filename().string());
  const Outlined outlined = verify_with_outline(reading, library());
  EXPECT_EQ(outlined.verdict.report.json(), verify(reading, library()).report.json());
  Report unused;
  const std::optional<Node> root = read_yaml(reading.text, unused);
  for (const Fault& fault : outlined.verdict.report.faults()) {
    SCOPED_TRACE(std::string(fault.rule));
    const bool is_at_port = kAtPorts.contains(fault.rule);
    EXPECT_TRUE(!is_at_port || !fault.port.empty()) << fault.message;
    EXPECT_TRUE(!(is_at_port || kAtTasks.contains(fault.rule)) || !fault.task.empty()) << fault.message;
    if (!fault.path.empty()) {
      ASSERT_TRUE(root);
      const Found found = at_path(*root, fault.path);
      ASSERT_NE(found.node, nullptr) << fault.path;
      EXPECT_TRUE(found.key == fault.at || found.node->at == fault.at || fault.rule == "key-twice") << fault.path;
    } else if (reading.draft && fault.rule != "key-missing") {
      ADD_FAILURE() << "a fault without a path: " << fault.message;
    }
    EXPECT_TRUE(fault.set.empty() || speaks_of(fault, fault.set)) << fault.message << ": " << fault.set;
    EXPECT_TRUE(fault.port.empty() || !fault.task.empty()) << fault.message;
    if (!fault.task.empty() && outlined.outline) check_task(fault, *outlined.outline);
  }
}

std::multiset<std::string> errors_of(const Report& report) {
  static const std::regex kPlace(" at [0-9]+:[0-9]+");
  std::multiset<std::string> errors;
  for (const Fault& fault : report.faults())
    if (fault.severity == Severity::kError)
      errors.insert(std::string(fault.rule) + std::regex_replace(fault.message, kPlace, ""));
  return errors;
}

TEST_P(FaultyDescription, IsOfferedOnlyEditsThatHelp) {
  const ReadDescription reading = read_description(contents(GetParam()), GetParam().filename().string());
  Outlined outlined = verify_with_outline(reading, library());
  offer_edits(reading, library(), outlined);
  const std::multiset<std::string> before = errors_of(outlined.verdict.report);
  for (const Fault& fault : outlined.verdict.report.faults())
    for (const Offer& offer : fault.offers) {
      const auto text = edit_text(reading.text, offer.acts);
      ASSERT_TRUE(text) << text.error().message.c_str();
      const Report report = verify(read_description(*text, outlined.verdict.report.file()), library()).report;
      const std::multiset<std::string> after = errors_of(report);
      EXPECT_TRUE(std::ranges::includes(before, after)) << fault.message << offer.label << '\n' << report.text();
      EXPECT_TRUE(fault.severity == Severity::kWarning || after.size() < before.size()) << offer.label;
    }
}

std::string ends_text(const std::vector<PortRef>& refs) {
  std::string text;
  for (const PortRef ref : refs) text += ' ' + std::to_string(ref.task) + '.' + std::to_string(ref.port);
  return text;
}

/// The parts of a configuration or an outline that the picture needs.
template <class Of>
std::string picture_text(const Of& of, const auto& is_given) {
  std::string text;
  for (const auto& task : of.tasks()) {
    text += task.name + ": " + task.component + ' ' + std::to_string(task.rate_hz) + '\n';
    for (const auto& port : task.ports)
      text += "  " + port.name + ' ' + std::to_string(port.kind) + ' ' + port.variable + ' ' + port.type + port.shape +
              ' ' + port.unit + '\n';
  }
  for (const auto& variable : of.variables())
    text += variable.name + (is_given(variable) ? " given" : "") + ends_text(variable.producers) + " ->" +
            ends_text(variable.consumers) + ' ' + variable.type + variable.shape + ' ' + variable.unit + '\n';
  return text;
}

struct OutlineView {
  const Outline& outline;
  const std::vector<OutlineTask>& tasks() const { return outline.tasks; }
  const std::vector<OutlineVariable>& variables() const { return outline.variables; }
};

TEST_P(GoodDescription, HasAnOutlineThatDrawsTheSamePicture) {
  const ReadDescription reading = read_description(contents(GetParam()), GetParam().filename().string());
  const Outlined outlined = verify_with_outline(reading, library());
  ASSERT_TRUE(outlined.outline && outlined.verdict.configuration);
  const Configuration& configuration = *outlined.verdict.configuration;
  const Outline& outline = *outlined.outline;
  EXPECT_EQ(picture_text(OutlineView{outline}, [](const auto& v) { return v.origin != Origin::kNobody; }),
            picture_text(configuration, [](const auto& v) { return v.is_given; }));
  ASSERT_EQ(outline.configurations.size(), configuration.sets().size());
  for (std::size_t s = 0; s < outline.configurations.size(); ++s) {
    EXPECT_EQ(outline.configurations[s].name, configuration.sets()[s].name);
    std::set<std::string> members;
    for (const TaskId task : configuration.sets()[s].order) members.insert(outline.tasks[task.index].name);
    const auto& named = outline.configurations[s].tasks;
    EXPECT_EQ(std::set<std::string>(named.begin(), named.end()), members);
  }
  EXPECT_EQ(outline.start, configuration.start());
}

INSTANTIATE_TEST_SUITE_P(Verify, FaultyDescription, ::testing::ValuesIn(descriptions("faulty")), name_of);
INSTANTIATE_TEST_SUITE_P(Verify, GoodDescription, ::testing::ValuesIn(descriptions("good")), name_of);

}  // namespace
}  // namespace chimera
