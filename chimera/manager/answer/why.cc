// SPDX-License-Identifier: Apache-2.0
// Walks from a variable to its sources and names the first one that explains its value.
#include "chimera/manager/answer/why.h"

#include <algorithm>
#include <cstdio>

#include "chimera/base/hosted/wording.h"

namespace chimera::manager {
namespace {

VariableTrouble trouble_of(const VariableFacts& facts) {
  if (facts.is_rtpu_dead) return VariableTrouble::kRtpuDead;
  if (facts.producer.empty() || facts.state == State::kNotCreated) return VariableTrouble::kProducerMissing;
  if (facts.state == State::kError) return VariableTrouble::kProducerError;
  if (facts.state == State::kOff) return VariableTrouble::kProducerOff;
  if (!facts.is_written) return VariableTrouble::kNeverWritten;
  if (!facts.is_finite) return VariableTrouble::kNotFinite;
  const Nanoseconds limit = facts.stale_after.count > 0 ? facts.stale_after : facts.period * 3;
  return limit.count > 0 && facts.age > limit ? VariableTrouble::kStale : VariableTrouble::kNone;
}

std::string short_time(Nanoseconds t) {
  const auto ns = static_cast<double>(t.count);
  if (t < milliseconds(1)) return formatted("%.3g us", ns * 1e-3);
  return t < seconds(1) ? formatted("%.3g ms", ns * 1e-6) : formatted("%.3g s", ns * 1e-9);
}

std::string producer_text(const VariableFacts& facts) {
  return "its producer " + facts.producer + (facts.component == facts.producer ? "" : " (" + facts.component + ")");
}

std::string with_words(const std::string& text, const VariableFacts& facts) {
  return facts.last_words.empty() ? text : text + ": " + facts.last_words;
}

std::string with_timing(const VariableFacts& facts) { return facts.timing.empty() ? "" : " (" + facts.timing + ")"; }

std::string complaint(const WhyLink& link) {
  const VariableFacts& f = link.facts;
  switch (link.trouble) {
    case VariableTrouble::kRtpuDead:
      return with_words("the rtpu " + f.rtpu + " of " + producer_text(f) + " is dead", f);
    case VariableTrouble::kProducerMissing:
      return f.producer.empty() ? "no task that produces it was created" : producer_text(f) + " was not created";
    case VariableTrouble::kProducerError: return with_words(producer_text(f) + " is in ERROR", f);
    case VariableTrouble::kProducerOff: return producer_text(f) + " is OFF";
    case VariableTrouble::kNeverWritten:
      return "never written, though " + producer_text(f) + " is ON" +
             (f.waits_for_events ? ": it waits for an event" : with_timing(f));
    case VariableTrouble::kNotFinite: return f.producer + " published " + f.value;
    case VariableTrouble::kStale:
      return "stale: " + f.producer + " wrote it " + short_time(f.age) + " ago, its period is " + short_time(f.period) +
             with_timing(f);
    case VariableTrouble::kNone: break;
  }
  return "";
}

std::string praise(const std::vector<WhyLink>& chain) {
  const VariableFacts& f = chain[0].facts;
  std::string first = f.variable + " is good";
  first += f.timing.empty() ? ": " : " now, not always in time (" + f.timing + "): ";
  first += f.is_operators() ? "set by the operator" : f.producer + " wrote it " + short_time(f.age) + " ago";
  if (chain.size() == 1) return first;
  return first + ", and " + (chain.size() == 2 ? "the variable" : "all " + std::to_string(chain.size() - 1)) +
         (chain.size() == 2 ? " it depends on is good too" : " variables it depends on are good too");
}

const WhyLink* find(const std::vector<WhyLink>& chain, std::string_view variable) {
  for (const WhyLink& link : chain)
    if (link.facts.variable == variable) return &link;
  return nullptr;
}

/// Goes from a link with a trouble up to the one whose own inputs are good. In a loop it stops where it entered.
const WhyLink& source_of(const std::vector<WhyLink>& chain, const WhyLink& link, std::vector<const WhyLink*>& seen) {
  seen.push_back(&link);
  for (const std::string& input : link.facts.inputs) {
    const WhyLink* above = find(chain, input);
    if (above == nullptr || above->trouble == VariableTrouble::kNone) continue;
    if (std::find(seen.begin(), seen.end(), above) == seen.end()) return source_of(chain, *above, seen);
  }
  return link;
}

}  // namespace

const char* trouble_name(VariableTrouble trouble) noexcept {
  constexpr const char* kNames[] = {"rtpu-dead",     "producer-missing", "producer-error", "producer-off",
                                    "never-written", "not-finite",       "stale",          "ok"};
  return kNames[static_cast<std::size_t>(trouble)];
}

Why why(std::string_view variable, const FactsOf& facts_of) {
  Why why;
  const auto add = [&](std::string_view name, std::uint32_t depth) {
    if (find(why.chain, name) != nullptr) return;
    WhyLink link{depth, facts_of(name), VariableTrouble::kNone};
    link.trouble = trouble_of(link.facts);
    why.chain.push_back(std::move(link));
  };
  add(variable, 0);
  for (std::size_t i = 0; i < why.chain.size(); ++i) {
    // A copy, because the chain moves while it grows.
    const std::vector<std::string> inputs = why.chain[i].facts.inputs;
    for (const std::string& input : inputs) add(input, why.chain[i].depth + 1);
  }
  const auto bad = std::find_if(why.chain.begin(), why.chain.end(),
                                [](const WhyLink& link) { return link.trouble != VariableTrouble::kNone; });
  if (bad == why.chain.end()) {
    why.verdict = praise(why.chain);
    return why;
  }
  std::vector<const WhyLink*> seen;
  const WhyLink& source = source_of(why.chain, *bad, seen);
  const std::string& asked = why.chain[0].facts.variable;
  why.verdict = (&source == &why.chain[0] ? asked : asked + " depends on " + source.facts.variable) + ": " +
                complaint(source);
  return why;
}

}  // namespace chimera::manager
