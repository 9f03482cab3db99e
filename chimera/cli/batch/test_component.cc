// SPDX-License-Identifier: Apache-2.0
// Finds the components to be tested, runs the test of each, and reports.
#include "chimera/cli/batch/test_component.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <optional>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/base/message.h"
#include "chimera/catalogue/descriptor_json.h"
#include "chimera/component_test/judge.h"
#include "chimera/component_test/partner.h"
#include "chimera/component_test/setup.h"

namespace chimera::cli {
namespace {

constexpr std::size_t kMostRecordingBytes = std::size_t{256} << 20;

namespace fs = std::filesystem;

constexpr Nanoseconds kPartnerStartLimit = seconds(5);  // a partner that answers its first request
constexpr std::size_t kMostMemory = 64u * 1024 * 1024;  // of rows and their outputs
constexpr std::size_t kFewest = 20;                     // cycles of a short recording

std::string beside(const LibraryEntry& entry, const char* ending) {
  const fs::path folder = fs::path(entry.object_file).parent_path();
  const fs::path file = folder / (entry.descriptor.name + ending);
  std::error_code unknown;
  return fs::exists(file, unknown) ? absolute_path(file.string()) : "";
}

bool is_path(const std::string& word) { return word.find('/') != std::string::npos || word.ends_with(".so"); }

// Reads a shared object that is not installed: from the descriptor beside it, else from the object itself.
Result<LibraryEntry> entry_of_object(const std::string& path, Nanoseconds patience) {
  std::error_code failed;
  if (!fs::exists(path, failed))
    return (Message() << (failed ? failed.message() : "no such file")).error(ErrorCode::kNotFound, path);
  LibraryEntry entry;
  entry.object_file = absolute_path(path);
  entry.descriptor_file = fs::path(entry.object_file).replace_extension(".component.json").string();
  if (fs::exists(entry.descriptor_file, failed)) {
    auto descriptor = read_descriptor_file(entry.descriptor_file);
    if (!descriptor) return descriptor.error();
    entry.descriptor = *std::move(descriptor);
    return entry;
  }
  component_test::TrialOptions options;
  options.patience = patience;
  const auto text = component_test::descriptor_text(entry.object_file, options);
  if (!text) return text.error();
  auto descriptor = parse_descriptor(*text);
  if (!descriptor) return descriptor.error();
  entry.descriptor = *std::move(descriptor);
  entry.descriptor_file = entry.object_file;
  return entry;
}

/// One component on its way through the test.
class OneTest {
 public:
  OneTest(const TestOptions& options, const LibraryEntry& entry, const UnitSystem& units)
      : options_(options), entry_(entry), units_(units) {
    entry_.object_file = absolute_path(entry.object_file);  // the child lives in another folder
  }

  Result<component_test::TrialReport> run() {
    component_test::Setup setup;
    setup.file = options_.setup.empty() ? beside(entry_, ".test.yaml") : options_.setup;
    setup.folder = fs::path(absolute_path(setup.file.empty() ? entry_.object_file : setup.file)).parent_path().string();
    if (auto partner = start_partner(setup); !partner) return partner.error();
    const Verdict verdict = component_test::arrange(setup, entry_, units_);
    if (!verdict.configuration) return refuse(verdict.report);
    const Configuration& configuration = *verdict.configuration;
    const auto form = component_test::InputForm::of(configuration, entry_.descriptor);
    std::string source;
    const auto inputs = read_inputs(configuration, form, source);
    if (!inputs) return inputs.error();
    component_test::TrialOptions how;
    how.patience = options_.patience;
    how.folder = setup.folder;
    const auto trial = component_test::run_trial(entry_, configuration, form, *inputs, how);
    if (!trial) return trial.error();
    component_test::TrialReport report =
        component_test::judge(*trial, {entry_.descriptor, configuration, *inputs, partner_.has_value()});
    report.inputs = source;
    return report;
  }

 private:
  Result<void> start_partner(component_test::Setup& setup) {
    const std::string program = beside(entry_, ".test.partner");
    if (program.empty()) return {};
    auto partner = component_test::Partner::start(program, kPartnerStartLimit);
    if (!partner) return partner.error();
    partner_.emplace(*std::move(partner));
    setup.partner_text = partner_->line();
    return {};
  }
  component_test::TrialReport refuse(const Report& report) const {
    component_test::TrialReport said;
    said.component = entry_.descriptor.name;
    std::string text = report.text();
    text += "docs/formats/component-test.md: what " + said.component + ".test.yaml beside the component may say";
    said.judgements.push_back({"setup", component_test::Finding::kFails, text});
    return said;
  }
  Result<component_test::Inputs> read_inputs(const Configuration& configuration, const component_test::InputForm& form,
                                             std::string& source) const {
    const std::string file = options_.inputs.empty() ? beside(entry_, ".test.csv") : options_.inputs;
    if (file.empty()) {
      std::size_t payload = 0;
      (void)component_test::output_places(configuration.spec(), payload);
      const std::size_t most = kMostMemory / (form.bytes() + payload + sizeof(component_test::RowRecord));
      source = "generated, seed " + std::to_string(options_.seed);
      return component_test::Inputs::generated(form, options_.seed, std::clamp(most, kFewest, options_.cycles));
    }
    source = file;
    const auto text = read_ordinary(file, kMostRecordingBytes + 1);
    if (!text) return text.error();
    if (text->size() > kMostRecordingBytes)
      return (Message() << "has more than 256 MiB; a recording for a test is shorter").error(ErrorCode::kRefused, file);
    const Nanoseconds period = configuration.spec().tasks[0].period;
    return component_test::Inputs::recorded(form, *text, file, options_.names, period, kFewest);
  }

  const TestOptions& options_;
  LibraryEntry entry_;
  const UnitSystem& units_;
  std::optional<component_test::Partner> partner_;
};

const char* word(component_test::Finding finding) {
  return finding == component_test::Finding::kOk      ? "ok"
         : finding == component_test::Finding::kFails ? "fails"
                                                      : "not judged";
}

std::string short_text(double ns) {
  if (ns < 10) return "less than 10 ns";  // the steps of a processor's counter
  return ns < 1000 ? formatted("%.0f ns", ns) : formatted("%.1f us", ns * 1e-3);
}

std::string text_of(const component_test::TrialReport& report) {
  std::string text = report.component + ": " + (report.passes() ? "passes" : "FAILS");
  if (!report.inputs.empty()) text += " (inputs: " + report.inputs + ")";
  text += "\n";
  for (const component_test::JudgedProperty& one : report.judgements) {
    char head[64];
    std::snprintf(head, sizeof head, "  %-10s  %-12s  ", word(one.verdict), one.name.c_str());
    std::string body = one.text;
    for (std::size_t at = 0; (at = body.find('\n', at)) != std::string::npos; at += 5) body.replace(at, 1, "\n    ");
    text += head + body + "\n";
  }
  if (report.measured.cycles > 0)
    text += "  measured    time          " + short_text(report.measured.typical_ns) + " (mean of the middle half), " +
            short_text(static_cast<double>(report.measured.worst_ns)) + " worst of " +
            std::to_string(report.measured.cycles) + " cycles, each the shortest of three runs\n";
  return text;
}

std::string json_of(const component_test::TrialReport& report) {
  const std::string rows = join(report.judgements, ", ", [](const component_test::JudgedProperty& one) {
    return "{\"name\": " + json_string(one.name) + ", \"finding\": \"" + word(one.verdict) + "\", \"text\": " +
           json_string(one.text) + "}";
  });
  return "{\"component\": " + json_string(report.component) + ", \"passes\": " + (report.passes() ? "true" : "false") +
         ", \"inputs\": " + json_string(report.inputs) + ", \"judgements\": [" + rows +
         "], \"measured_cycles\": " + std::to_string(report.measured.cycles) +
         ", \"typical_ns\": " + std::to_string(report.measured.typical_ns) +
         ", \"worst_ns\": " + std::to_string(report.measured.worst_ns) + "}";
}

Result<std::vector<LibraryEntry>> wanted(const TestOptions& options, const Library& library) {
  std::vector<LibraryEntry> entries;
  if (options.all) entries.assign(library.entries().begin(), library.entries().end());
  for (const std::string& name : options.components) {
    if (is_path(name)) {
      auto entry = entry_of_object(name, options.patience);
      if (!entry) return entry.error();
      entries.push_back(*std::move(entry));
      continue;
    }
    const LibraryEntry* entry = library.find(name);
    if (entry == nullptr) return no_component(name, library);
    entries.push_back(*entry);
  }
  return entries;
}

}  // namespace

CommandResult test_components(const TestOptions& options, const Workplace& workplace) {
  const auto library = workplace.library();
  if (!library) return file_refusal(library.error(), options.json);
  const auto entries = wanted(options, *library);
  if (!entries) return file_refusal(entries.error(), options.json);
  CommandResult output;
  std::string rows;
  for (const LibraryEntry& entry : *entries) {
    const auto report = OneTest(options, entry, library->units()).run();
    if (!report) return file_refusal(report.error(), options.json);
    if (!report->passes()) output.code = kRefused;
    if (options.json) append_joined(rows, ", ", json_of(*report));
    else output.out += text_of(*report);
  }
  if (options.json) output.out = "{\"reports\": [" + rows + "]}\n";
  return output;
}

}  // namespace chimera::cli
