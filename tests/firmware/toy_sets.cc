// SPDX-License-Identifier: Apache-2.0
// Bakes random sets of the twins test, and writes the records that the executive of this machine makes of them.
// usage: toy_sets TARGET OUT SEED...   (OUT/SEED.cc, OUT/toys.cc, OUT/mechanisms.h, OUT/records.txt)
#include <cstdio>
#include <fstream>
#include <sstream>

#include "chimera/bake/mechanisms.h"
#include "chimera/bake/source_text.h"
#include "chimera/bake/tables.h"
#include "chimera/bake/target.h"
#include "tests/conformance/random_toys.h"
#include "tests/conformance/runner.h"

namespace chimera::toy {
namespace {

constexpr Nanoseconds kDuration = milliseconds(40);

/// The application of a seed as in twins_test.cc, with a policy that images have.
struct RandomSet {
  explicit RandomSet(std::uint32_t seed) {
    Dice dice(seed);
    fill(app, dice);
    constexpr Policy kPolicies[] = {Policy::kEdf, Policy::kRm, Policy::kMuf};
    policy = kPolicies[dice.below(3)];
    while (app.has("t" + std::to_string(n))) ++n;
    acts = script(dice, n);
    if (seed % 2 == 0) add_events(app, acts, Dice(seed), n);
    set = &app.build();
  }
  Application app;
  std::vector<ScriptAct> acts;
  Policy policy = Policy::kEdf;
  std::uint32_t n = 0;
  TaskSet* set = nullptr;
};

void write(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
}

/// The toys of all sets as constant tables.
class ToyTables {
 public:
  std::size_t size() const { return n_; }
  void add(const Toy& toy) {
    const std::string number = std::to_string(n_++);
    const auto answers = [&](const char* name, int method) {
      std::vector<std::string> all;
      for (const int answer : toy.answers[static_cast<std::size_t>(method)]) all.push_back(std::to_string(answer));
      return tables_.array("std::int32_t", name + number, all);
    };
    std::vector<std::string> sends;
    for (const auto& [signal, target] : toy.sends)
      sends.push_back("{static_cast<Signal>(" + std::to_string(static_cast<int>(signal)) + "), " +
                      bake::literal(target) + "}");
    rows_.push_back("{" + std::to_string(toy.spend.count) + ", " + or_none(answers("kSync", CHIMERA_SYNC)) + ", " +
                    or_none(answers("kError", CHIMERA_ERROR)) + ", " +
                    or_none(tables_.array("Sent", "kSends" + number, sends)) + "}");
  }
  void add_set(std::uint32_t seed) {
    const std::string name = "baked_" + std::to_string(seed);
    declared_ += "namespace chimera::" + name + " {\nextern const ApplicationSpec kSpec;\nextern const std::span<const "
                 "chimera_component* const> kComponents;\nextern const baked::Run kRun;\n}\n";
    sets_.push_back("{" + std::to_string(seed) + ", &" + name + "::kSpec, &" + name + "::kComponents, &" + name +
                    "::kRun}");
  }
  std::string text() {
    const std::string toys = tables_.array("Toy", "kAllToys", rows_);
    std::string sets;
    for (const std::string& each : sets_) sets += "    " + each + ",\n";
    return "#include \"tests/firmware/toys/toys.h\"\n" + declared_ + "namespace chimera::baked_toys {\nnamespace {\n" +
           tables_.text() + "constinit const Set kAllSets[] = {\n" + sets +
           "};\n}\nconstinit const std::span<const Toy> kToys = " + toys +
           ";\nconstinit const std::span<const Set> kSets = kAllSets;\n}\n";
  }

 private:
  static std::string or_none(const std::string& name) { return name.empty() ? "{}" : name; }

  bake::Definitions tables_;
  std::vector<std::string> rows_, sets_;
  std::string declared_;
  std::size_t n_ = 0;
};

std::string records_of(RandomSet& random, std::uint32_t seed) {
  Runner runner(*random.set, Kind::kExecutiveOnTwin, random.policy, random.acts);
  std::string text = "set " + std::to_string(seed) + "\n";
  if (!runner.start()) return text + "refused\n";
  runner.run(kDuration);
  for (const TapRecord& r : runner.records())
    text += "record " + std::to_string(static_cast<int>(r.kind)) + " " + std::to_string(r.task.index) + " " +
            std::to_string(r.at.count) + " " + std::to_string(r.a) + " " + std::to_string(r.b) + "\n";
  return text;
}

/// The tables of one set, whose toys are numbers instead of addresses.
std::string tables_of(RandomSet& random, const bake::Target& target, ToyTables& toys,
                      std::vector<bake::Mechanism>& mechanisms) {
  ApplicationSpec spec = random.set->spec();
  std::vector<TaskSpec> tasks(spec.tasks.begin(), spec.tasks.end());
  std::vector<std::vector<PortSpec>> ports;
  std::vector<std::int64_t> numbers(tasks.size());
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    std::vector<PortSpec>& own = ports.emplace_back(tasks[t].ports.begin(), tasks[t].ports.end());
    numbers[t] = static_cast<std::int64_t>(toys.size());
    own[0].value = std::as_bytes(std::span(&numbers[t], 1));
    toys.add(random.app.toy(std::string(tasks[t].name)));
    tasks[t].ports = own;
    tasks[t].component = tasks[t].aperiodic ? "toy_polled" : "toy";
  }
  spec.tasks = tasks;
  const baked::Run run{.policy = random.policy, .tick = milliseconds(1), .duration = kDuration, .acts = random.acts,
                       .link_period = {}, .link_stale_after = {}};
  const auto used = bake::mechanisms(spec, run, target);
  if (mechanisms.empty()) mechanisms = used;
  for (std::size_t m = 0; m < used.size(); ++m) mechanisms[m].is_used = mechanisms[m].is_used || used[m].is_used;
  return bake::tables_text(spec, run, target);
}

int bake_sets(const std::string& target_file, const std::string& out, std::span<char*> seeds) {
  std::ifstream file(target_file);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const bake::ReadTarget target = bake::read_target(text, target_file, {});
  if (!target.target) return std::fprintf(stderr, "%s", target.report.text().c_str()), 1;
  ToyTables toys;
  std::vector<bake::Mechanism> mechanisms;
  std::string records;
  for (const char* const word : seeds) {
    const auto seed = static_cast<std::uint32_t>(std::atoi(word));
    RandomSet random(seed);
    write(out + "/" + word + ".cc", tables_of(random, *target.target, toys, mechanisms));  // toys are fresh still
    toys.add_set(seed);
    records += records_of(random, seed);
  }
  for (bake::Mechanism& each : mechanisms)
    if (each.name == "kTap") each.is_used = true;
  write(out + "/toys.cc", toys.text());
  write(out + "/mechanisms.h", bake::mechanisms_text(mechanisms));
  write(out + "/records.txt", records);
  return 0;
}

}  // namespace
}  // namespace chimera::toy

int main(int count, char** words) {
  if (count < 4) return std::fprintf(stderr, "usage: toy_sets TARGET OUT SEED...\n"), 2;
  return chimera::toy::bake_sets(words[1], words[2], std::span(words, static_cast<std::size_t>(count)).subspan(3));
}
