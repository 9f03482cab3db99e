// SPDX-License-Identifier: Apache-2.0
// Tries edits for each fault, and keeps those that help.
#include "chimera/verify/offers.h"

#include <algorithm>
#include <map>

#include "chimera/description/edit/text_edit.h"
#include "chimera/verify/offer_candidates.h"

namespace chimera {
namespace {

/// The words of a fault without the places in its message, which an edit moves.
std::string identity(const Fault& fault) {
  std::string words(fault.rule);
  for (const std::string* part : {&fault.set, &fault.task, &fault.port, &fault.message}) words += '\n' + *part;
  for (std::size_t at = words.find(" at "); at != std::string::npos; at = words.find(" at ", at + 1))
    words.erase(at + 4, std::min(words.find_first_not_of("0123456789:", at + 4), words.size()) - at - 4);
  return words;
}

struct Counted {
  std::map<std::string, int> errors, warnings;

  explicit Counted(const Report& report) {
    for (const Fault& fault : report.faults()) ++of(fault.severity)[identity(fault)];
  }
  std::map<std::string, int>& of(Severity severity) { return severity == Severity::kError ? errors : warnings; }
};

/// True if `after` is better than `before` by `fault`, and has no error of its own.
bool helps(const Fault& fault, const Report& before, const Report& after) {
  Counted old(before), now(after);
  if (now.of(fault.severity)[identity(fault)] >= old.of(fault.severity)[identity(fault)]) return false;
  for (const auto& [words, times] : now.errors)
    if (times > old.errors[words]) return false;
  return fault.severity == Severity::kError ? after.errors() < before.errors() : after.warnings() < before.warnings();
}

}  // namespace

void offer_edits(const ReadDescription& reading, const Library& library, Outlined& outlined, std::size_t most_tries) {
  if (!outlined.outline) return;
  const Report before = outlined.verdict.report;
  std::vector<std::vector<Offer>> of_fault;
  std::size_t most = 0;
  for (const Fault& fault : before.faults())
    most =
        std::max(most, of_fault.emplace_back(candidates_for(fault, *reading.draft, library, *outlined.outline)).size());
  std::size_t tries = 0;
  for (std::size_t rank = 0; rank < most; ++rank)
    for (std::size_t f = 0; f < of_fault.size(); ++f) {
      if (rank >= of_fault[f].size()) continue;
      if (++tries > most_tries) return;
      Offer& offer = of_fault[f][rank];
      const auto text = edit_text(reading.text, offer.acts);
      if (!text) continue;
      if (helps(before.faults()[f], before, verify(read_description(*text, before.file()), library).report))
        outlined.verdict.report.offer(f, std::move(offer));
    }
}

}  // namespace chimera
