// SPDX-License-Identifier: Apache-2.0
// Collects, sorts and writes out the faults of a description.
#include "chimera/description/report.h"

#include <algorithm>

#include "chimera/base/assert.h"
#include "chimera/base/hosted/terminal_text.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/description/edit_json.h"
#include "chimera/description/key_paths.h"
#include "chimera/description/rule_ids.h"
#include "chimera/text/json_text.h"
#include "chimera/text/nearest.h"

namespace chimera {
namespace {

std::string_view word(Severity severity) { return severity == Severity::kError ? "error" : "warning"; }

std::string remedy(const Fault& fault) {
  if (!fault.remedy.empty()) return fault.remedy;
  return fault.nearest.empty() ? std::string{} : did_you_mean(fault.nearest).substr(2);
}

/// The port that tasks/TASK/KEY/PORT names; an item of a list under `alias` is an instance.
std::string port_of(std::span<const std::string> names) {
  constexpr std::string_view kKeys[] = {"alias", "constants", "resources", "initial", "max_step"};
  if (names.size() < 4 || std::ranges::find(kKeys, names[2]) == std::end(kKeys)) return {};
  return names.size() > 4 && names[2] == "alias" ? names[3] + '[' + names[4] + ']' : names[3];
}

Json offers_json(const Fault& fault) {
  Json all = Json::array();
  for (const Offer& offer : fault.offers) all.push_back({{"label", offer.label}, {"acts", edits_json(offer.acts)}});
  return all;
}

}  // namespace

std::string sentence(const Fault& fault) {
  const std::string help = remedy(fault);
  return help.empty() ? fault.message : fault.message + " (" + help + ")";
}

void Report::locate(Fault& fault) const {
  if (keys_ == nullptr) return;
  const std::vector<std::string> names = keys_->names(fault.at.key);
  for (const std::string& name : names) append_joined(fault.path, "/", name);
  if (names.size() < 2) return;
  if (fault.set.empty() && names[0] == "configurations") fault.set = names[1];
  if (!fault.task.empty() || names[0] != "tasks") return;
  fault.task = names[1];
  if (fault.port.empty()) fault.port = port_of(names);
}

void Report::use(std::shared_ptr<const KeyPaths> keys) {
  if (keys == nullptr || keys == keys_) return;
  keys_ = std::move(keys);
  for (Fault& fault : faults_) {
    fault.at.key = keys_->key_at(fault.at);
    locate(fault);
  }
}

void Report::add(Fault fault) {
  CHIMERA_ASSERT(is_rule(fault.rule));
  locate(fault);
  for (std::string* part : {&fault.message, &fault.found, &fault.expected, &fault.nearest, &fault.remedy, &fault.set,
                            &fault.task, &fault.port, &fault.path})
    *part = plain_line(*part);  // one fault, one line
  for (const Fault& known : faults_)
    if (known.at == fault.at && known.rule == fault.rule && known.message == fault.message) return;
  ++(fault.severity == Severity::kError ? errors_ : warnings_);
  if (faults_.size() < kMaxFaults) faults_.push_back(std::move(fault));
}

void Report::note(std::string text) {
  text = plain_line(text);
  if (std::find(notes_.begin(), notes_.end(), text) == notes_.end()) notes_.push_back(std::move(text));
}

void Report::add_all(const Report& other) {
  for (const std::string& text : other.notes_) note(text);
  for (const Fault& fault : other.faults_) add(fault);
  const std::size_t kept_errors = static_cast<std::size_t>(std::count_if(
      other.faults_.begin(), other.faults_.end(), [](const Fault& f) { return f.severity == Severity::kError; }));
  errors_ += other.errors_ - kept_errors;
  warnings_ += other.warnings_ - (other.faults_.size() - kept_errors);
}

void Report::offer(std::size_t fault, Offer offer) {
  offer.label = plain_line(offer.label);
  faults_[fault].offers.push_back(std::move(offer));
}

void Report::sort() {
  std::stable_sort(faults_.begin(), faults_.end(), [](const Fault& a, const Fault& b) { return a.at < b.at; });
}

bool Report::has(std::string_view rule) const noexcept {
  return std::any_of(faults_.begin(), faults_.end(), [rule](const Fault& f) { return f.rule == rule; });
}

std::string Report::text() const {
  std::string out;
  for (const Fault& fault : faults_) {
    out += file_;
    if (fault.at.line != 0) out += ':' + std::to_string(fault.at.line) + ':' + std::to_string(fault.at.column);
    out += ": ";
    out += word(fault.severity);
    out += ": " + fault.message + " [";
    out += fault.rule;
    out += "]\n";
    if (const std::string help = remedy(fault); !help.empty()) out += "  " + help + '\n';
  }
  if (const std::size_t all = errors_ + warnings_; all > faults_.size())
    out += file_ + ": and " + std::to_string(all - faults_.size()) + " more\n";
  for (const std::string& text : notes_) out += file_ + ": note: " + text + '\n';
  return out;
}

std::string Report::json() const {
  Json faults = Json::array();
  for (const Fault& fault : faults_)
    faults.push_back({{"rule", fault.rule},
                      {"severity", word(fault.severity)},
                      {"file", file_},
                      {"line", fault.at.line},
                      {"column", fault.at.column},
                      {"found", fault.found},
                      {"expected", fault.expected},
                      {"nearest", fault.nearest},
                      {"message", fault.message},
                      {"remedy", remedy(fault)},
                      {"set", fault.set},
                      {"task", fault.task},
                      {"port", fault.port},
                      {"path", fault.path},
                      {"offers", offers_json(fault)}});
  return spaced_json({{"file", file_},
                      {"legal", is_legal()},
                      {"errors", errors_},
                      {"warnings", warnings_},
                      {"faults", std::move(faults)},
                      {"notes", notes_}});
}

}  // namespace chimera
