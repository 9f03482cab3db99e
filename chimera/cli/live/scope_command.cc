// SPDX-License-Identifier: Apache-2.0
// Reads the words of `chimera scope`, records, and writes a table and a picture.
#include "chimera/cli/live/scope_command.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "chimera/analysis/recorded_profile.h"
#include "chimera/cli/live/scope.h"
#include "chimera/cli/live/terminal.h"
#include "chimera/cli/print/answer_text.h"
#include "chimera/cli/print/fields.h"
#include "chimera/cli/print/figures.h"
#include "chimera/cli/print/sketch.h"
#include "chimera/cli/print/sparkline.h"
#include "chimera/platform/clock.h"
#include "chimera/text/json.h"
#include "chimera/text/nearest.h"
#include "chimera/units/quantity.h"

namespace chimera::cli {
namespace {

using By = Wakeup::By;

constexpr Nanoseconds kGrace = seconds(2);  // for the last rows to come

Error wrong(const std::string& message) { return {ErrorCode::kBadInput, std::string_view(message), {}}; }

Result<Nanoseconds> duration(const Call& call, const char* option, Nanoseconds otherwise, Nanoseconds most) {
  if (!call.has(option)) return otherwise;
  const auto value = parse_duration(call.value(option));
  if (!value) return wrong(std::string(option) + ": " + std::string(value.error().message.view()));
  if (*value > most) return wrong(std::string(option) + ": at most " + duration_text(most.count));
  return *value;
}

/// Facts of a variable from the answer of `describe`.
struct Known {
  std::string unit;
  bool is_scalar = true;
  bool is_given = false;  ///< an operator variable: no task publishes it
};

Result<Known> known(const Json& described, const std::string& name) {
  std::vector<std::string> names;
  for (const Json& variable : described["variables"]) {
    names.push_back(text_of(variable, "variable"));
    if (names.back() != name) continue;
    if (truth_at(variable, "constant")) return wrong("'" + name + "' is a constant: no task publishes it");
    return Known{text_of(variable, "unit"), text_of(variable, "shape").empty(), truth_at(variable, "given")};
  }
  return Error{ErrorCode::kNotFound, {no_such("state variable", name, names)}, {}};
}

struct Asked {
  ScopeRequest request;
  Nanoseconds wait;
  Json variables = Json::array(), given = Json::array();

  void subscribe_to(const std::string& variable, const Known& what) {
    Json& list = what.is_given ? given : variables;
    if (std::find(list.begin(), list.end(), variable) == list.end()) list.push_back(variable);
  }
};

Result<void> add_channels(Asked& asked, const Call& call, const Json& described) {
  for (const std::string& operand : call.operands) {
    const auto name = read_channel(operand);
    if (!name) return name.error();
    const auto what = known(described, name.value().variable);
    if (!what) return what.error();
    asked.request.channels.push_back({name.value(), what.value().unit, what.value().is_scalar});
    asked.subscribe_to(name.value().variable, what.value());
  }
  return {};
}

Result<void> add_trigger(Asked& asked, const Call& call, const Json& described, const Surroundings& surroundings) {
  const auto units = UnitSystem::load(surroundings.unit_files);
  if (!units) return units.error();
  auto trigger = Trigger::read(call.value("--trigger"), units.value());
  if (!trigger) return trigger.error();
  const auto what = known(described, trigger->channel().variable);
  if (!what) return what.error();
  const auto level = trigger->settle(what.value().unit, units.value());
  if (!level) return level.error();
  if (!what.value().is_scalar && trigger->channel().part.empty())
    return wrong("trigger '" + trigger->text() + "': say which element, such as " + trigger->channel().variable +
                 "[0]");
  asked.subscribe_to(trigger->channel().variable, what.value());
  asked.request.trigger_is_scalar = what.value().is_scalar;
  asked.request.trigger = std::move(*trigger);
  return {};
}

Result<Asked> read(const Call& call, const Json& described, const Surroundings& surroundings) {
  Asked asked;
  const auto pre = duration(call, "--pre", {}, seconds(600));
  if (!pre) return pre.error();
  const auto length = duration(call, "--for", seconds(1), seconds(3600));
  if (!length) return length.error();
  const auto wait = duration(call, "--wait", seconds(60), seconds(86'400));
  if (!wait) return wait.error();
  asked.request.pre = pre.value();
  asked.request.duration = length.value();
  asked.wait = wait.value();
  if (asked.request.duration.count == 0) return wrong("--for: must be longer than 0");
  if (asked.request.pre.count > 0 && !call.has("--trigger")) return wrong("--pre belongs to --trigger");
  if (const auto added = add_channels(asked, call, described); !added) return added.error();
  if (call.has("--trigger"))
    if (const auto added = add_trigger(asked, call, described, surroundings); !added) return added.error();
  return asked;
}

/// Feeds `scope` until it is complete, the user ends it, or the time is over. An error only when the other end is gone.
std::optional<Error> record(Session& session, Scope& scope, const Asked& asked) {
  LinuxClock clock;
  InputWait attention(false);
  Nanoseconds until = clock.now() + asked.request.pre + asked.wait;  // nothing is waited for before it can begin
  bool was_triggered = false;
  while (!scope.is_complete() && clock.now() < until) {
    const Wakeup woken = attention.wait(&session.client(), until - clock.now());
    if (woken.by == By::kStop) return std::nullopt;
    if (woken.by == By::kLost) return woken.error;
    if (woken.by == By::kNote && woken.note.method == "tap") scope.add(*woken.note.parameters);
    if (woken.by == By::kNote && woken.note.method == "values") scope.add_values(*woken.note.parameters);
    if (scope.is_triggered() && !was_triggered) {
      was_triggered = true;
      until = scope.begin() + asked.request.duration + kGrace;
    }
  }
  return std::nullopt;
}

Result<void> write(const std::string& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  bool is_good = file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  int why = errno;
  if (file != nullptr && std::fclose(file) != 0 && is_good) is_good = false, why = errno;
  if (is_good) return {};
  return Error{ErrorCode::kSystem, {std::string("cannot be written: ") + std::strerror(why)}, std::string_view(path)};
}

CommandResult show_recording(const Scope& scope, const Call& call, const std::string& subsystem, std::size_t width) {
  const std::string note = (call.has("--trigger") ? "trigger " + call.value("--trigger") + "; " : "") + scope.summary();
  for (const auto& [option, text] : {std::pair{"--csv", scope.csv()}, {"--svg", svg(scope.plot(subsystem, note))}})
    if (call.has(option))
      if (const auto written = write(call.value(option), text); !written) return refused(written.error(), call.json);
  if (call.json)
    return {json_line({{"began_ns", scope.begin().count},
                       {"rows", scope.rows()},
                       {"gaps", scope.gaps()},
                       {"lost", scope.lost_rows()},
                       {"early_edges", scope.early_edges()},
                       {"csv", call.value("--csv")},
                       {"svg", call.value("--svg")}}),
            "", kOk};
  const bool is_plain = !call.has("--csv") && !call.has("--svg");
  if (is_plain && width > 0)
    return {sketch(scope.plot(subsystem, note), width, writes_unicode()),
            scope.summary() + "; --csv FILE writes them, --svg FILE draws them\n", kOk};
  return {is_plain ? scope.csv() : "", scope.summary() + "\n", kOk};
}

}  // namespace

CommandResult scope(Session& session, const Call& call, const Screen& screen) {
  const control::RpcResponse described = session.ask("describe");
  if (!described.is_good()) return refused(described, call.json);
  const auto asked = read(call, *described.result, session.surroundings());
  if (!asked) return refused(asked.error(), call.json, asked.error().code == ErrorCode::kNotFound ? kRefused : kUsage);
  for (const char* option : {"--csv", "--svg"})
    if (call.has(option))
      if (const auto may = may_write_recorded_profile(call.value(option)); !may) return refused(may.error(), call.json);
  const control::RpcResponse hello = session.ask("hello");
  std::vector<std::int64_t> subscriptions;
  for (const auto& [to, variables] : {std::pair{"tap", asked->variables}, {"values", asked->given}}) {
    if (variables.empty()) continue;
    Json wanted = {{"to", to}, {"variables", variables}};
    if (to == std::string("values")) wanted["period_ms"] = 20;  // the shortest
    const control::RpcResponse subscribed = session.ask("subscribe", wanted);
    if (!subscribed.is_good()) return refused(subscribed, call.json);
    subscriptions.push_back(whole_of(*subscribed.result, "subscription"));
  }
  Scope scope(asked.value().request);
  if (asked->request.pre.count > 0 && !call.json && screen.err != nullptr) {
    std::fprintf(screen.err, "recording the pre-trigger of %s first; the trigger is armed after that\n",
                 duration_text(asked->request.pre.count).c_str());
    std::fflush(screen.err);
  }
  const auto end = record(session, scope, asked.value());
  for (const std::int64_t subscription : subscriptions) session.ask("unsubscribe", {{"subscription", subscription}});
  if (end && !scope.is_triggered()) return refused(*end, call.json);
  if (!scope.is_triggered()) {
    const std::string early = scope.early_edges() == 0 ? ""
                                                       : " after the pre-trigger was full (" +
                                                             std::to_string(scope.early_edges()) + " came before that)";
    const std::string within = " within " + duration_text(asked.value().wait.count) + early;
    return refused(wrong(asked.value().request.trigger ? "no trigger '" + call.value("--trigger") + "'" + within
                                                       : "nothing was published" + within),
                   call.json);
  }
  CommandResult said =
      show_recording(scope, call, hello.is_good() ? text_of(*hello.result, "subsystem") : "", screen.width);
  if (end && said.code == kOk) {  // the recorded rows are kept; later rows are unknown
    said.err += "the recording ended early: " + std::string(end->message.view()) + "\n";
    said.code = kRefused;
  }
  return said;
}

}  // namespace chimera::cli
