// SPDX-License-Identifier: Apache-2.0
// Shows answers again and again, or what a subscription brings.
#include "chimera/cli/live/live.h"

#include <algorithm>
#include <optional>

#include "chimera/base/hosted/terminal_text.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/cli/live/events_command.h"
#include "chimera/cli/live/terminal.h"
#include "chimera/cli/live/top.h"
#include "chimera/cli/live/watch.h"
#include "chimera/cli/print/fields.h"
#include "chimera/cli/print/sparkline.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/text/json.h"
#include "chimera/units/quantity.h"

namespace chimera::cli {
namespace {

using By = Wakeup::By;

/// The period of --every in whole milliseconds, as the protocol takes it.
Result<std::int64_t> period_ms(const Call& call, std::int64_t otherwise) {
  if (!call.has("--every")) return otherwise;
  const auto every = parse_duration(call.value("--every"));
  if (!every) return Error{ErrorCode::kBadInput, {"--every: " + std::string(every.error().message.view())}, {}};
  const std::int64_t ms = every->count / 1'000'000;
  if (ms < 20 || ms > 60'000)
    return Error{ErrorCode::kBadInput, {"--every: found '" + call.value("--every") + "', expected 20 ms to 60 s"}, {}};
  return ms;
}

/// Ends a continuous command after the user stopped it. The next command of a shell needs a connection without
/// subscriptions.
int end_of_notes(Session& session) {
  session.client().drop();
  return kOk;
}

const char* style(TopLine::Look look) {
  switch (look) {
    case TopLine::Look::kHeading:
      return "\x1b[7m";
    case TopLine::Look::kAlarm:
      return "\x1b[1;31m";
    case TopLine::Look::kFaint:
      return "\x1b[2m";
    default:
      return "";
  }
}

std::string drawn(const std::vector<TopLine>& lines) {
  return join(lines, "\r\n", [](const TopLine& line) { return style(line.look) + line.text + "\x1b[0m"; });
}

/// One screen for what is no terminal: without the keys and what is empty at its end.
std::string printed(const Json& status) {
  ScreenSize size = screen_size(kStandardOutput);
  size.height = std::max<std::size_t>(5 + status["rtpus"].size() + status["tasks"].size(), 6);
  std::string text;
  for (TopLine& line : top_lines(status, nullptr, {.width = size.width, .height = size.height, .has_keys = false})) {
    line.text.erase(line.text.find_last_not_of(' ') + 1);
    text += line.text + "\n";
  }
  return text;
}

/// Moves the view as a key asks; false when it asks for the end.
bool apply_key(int key, TopView& view, const Json& status) {
  if (key == 'q' || key == 'Q' || key == kKeyEnd) return false;
  if (key == 'h' || key == '?') view.is_help = !view.is_help;
  if (const auto order = order_of_key(key)) view.order = *order, view.skipped = 0;
  const std::size_t page = view.height / 2;
  if (key == kKeyUp || key == kKeyPageUp) view.skipped -= std::min(view.skipped, key == kKeyUp ? 1 : page);
  if (key == kKeyDown || key == kKeyPageDown) view.skipped += key == kKeyDown ? 1 : page;
  view.skipped = std::min(view.skipped, most_skipped(status, view));
  return true;
}

/// Shows `top` until the user ends it, or returns the error that ended it. Waits for a manager that restarts.
std::optional<Error> top_on_screen(Session& session, const Json& first, const Json& subscription) {
  InputWait attention(true);
  FullScreen screen;
  Json now = first, before;
  TopView view;
  for (;;) {
    const ScreenSize size = screen_size(kStandardOutput);
    view.width = size.width;
    view.height = size.height;
    screen.show(drawn(view.is_help ? help_lines(view) : top_lines(now, before, view)));
    Wakeup woken = attention.wait(&session.client(), seconds(60));
    if (woken.by == By::kStop || (woken.by == By::kKey && !apply_key(woken.key, view, now))) return std::nullopt;
    if (woken.by == By::kLost && !session.ask("subscribe", subscription).is_good())
      return woken.error;
    if (woken.by == By::kNote && woken.note.method == "status") before = std::move(now), now = *woken.note.parameters;
  }
}

Result<std::vector<ChannelName>> channels_of(const Call& call) {
  std::vector<ChannelName> channels;
  for (const std::string& operand : call.operands) {
    auto channel = read_channel(operand);
    if (!channel) return channel.error();
    channels.push_back(std::move(*channel));
  }
  return channels;
}

Json variables_of(const std::vector<ChannelName>& channels) {
  Json names = Json::array();
  for (const ChannelName& channel : channels)
    if (std::find(names.begin(), names.end(), channel.variable) == names.end()) names.push_back(channel.variable);
  return names;
}

/// Draws over the lines of the last time. They are no wider than the terminal, so that none wraps.
void redraw(const std::vector<std::string>& lines, bool is_first, std::FILE* out) {
  std::string text = is_first ? "" : "\r\x1b[" + std::to_string(lines.size()) + "A";
  for (const std::string& line : lines) text += line + "\x1b[K\n";
  std::fputs(text.c_str(), out);
  (void)flush_and_look(out);
}

/// Prints the notifications of a subscription until the user ends it or printing fails. Waits for a manager that
/// restarts. `show` prints one notification, and may change the subscription that a new manager is asked for.
template <class Show>
int follow(Session& session, const Call& call, Json subscription, std::FILE* out, std::FILE* err, const Show& show) {
  const control::RpcResponse subscribed = session.ask("subscribe", subscription);
  if (!subscribed.is_good()) return print(refused(subscribed, call.json), out, err);
  InputWait attention(false);
  for (;;) {
    Wakeup woken = attention.wait(&session.client(), seconds(60));
    if (woken.by == By::kStop) return end_of_notes(session);
    if (woken.by == By::kLost && !session.ask("subscribe", subscription).is_good())
      return print(refused(woken.error, call.json), out, err);
    if (woken.by != By::kNote) continue;
    show(woken.note, subscription);
    if (call.json) std::fprintf(out, "%s\n", for_terminal(woken.note.parameters->dump()).c_str());
    if (flush_and_look(out) != 0) return kRefused;  // the output is lost
  }
}

}  // namespace

int top(Session& session, const Call& call, std::FILE* out, std::FILE* err) {
  const auto period = period_ms(call, 500);
  if (!period) return print(refused(period.error(), call.json, kUsage), out, err);
  const control::RpcResponse first = session.ask("status");
  if (!first.is_good()) return print(refused(first, call.json), out, err);
  const bool is_live = is_terminal(kStandardOutput) && is_terminal(kStandardInput) && !call.json;
  if (!is_live) return print({call.json ? first.result->dump() + "\n" : printed(*first.result), "", kOk}, out, err);
  const Json subscription = {{"to", "status"}, {"period_ms", period.value()}};
  const control::RpcResponse subscribed = session.ask("subscribe", subscription);
  if (!subscribed.is_good()) return print(refused(subscribed, call.json), out, err);
  const auto end = top_on_screen(session, *first.result, subscription);
  return end ? print(refused(*end, call.json), out, err) : end_of_notes(session);
}

int watch(Session& session, const Call& call, std::FILE* out, std::FILE* err) {
  const bool is_live = is_terminal(kStandardOutput);
  const auto period = period_ms(call, is_live ? 100 : 1000);
  if (!period) return print(refused(period.error(), call.json, kUsage), out, err);
  const auto channels = channels_of(call);
  if (!channels) return print(refused(channels.error(), call.json, kUsage), out, err);
  Watch shown(channels.value());
  bool is_first = true;
  const Json wanted = {{"to", "values"}, {"period_ms", period.value()}, {"variables", variables_of(channels.value())}};
  return follow(session, call, wanted, out, err, [&](control::Note& note, Json&) {
    if (call.json) return;
    shown.add((*note.parameters)["values"]);
    const std::size_t width = screen_size(kStandardOutput).width;
    if (is_live)
      redraw(shown.lines(width > 1 ? width - 1 : 1, writes_unicode()), is_first, out);
    else
      std::fprintf(out, "%s\n", shown.plain().c_str());
    is_first = false;
  });
}

int follow_events(Session& session, const Call& call, std::FILE* out, std::FILE* err) {
  const auto choice = read_choice(call);
  if (!choice) return print(refused(choice.error(), call.json, kUsage), out, err);
  EventLines lines = choice->lines;
  const Json wanted = {{"to", "events"}, {"since", choice->since.number}};
  return follow(session, call, wanted, out, err, [&](control::Note& note, Json& next) {
    for (const Json& event : (*note.parameters)["events"]) next["since"] = whole_of(event, "number") + 1;
    note.parameters = std::make_shared<const Json>(only(lines, *note.parameters));
    if (call.json) return;
    if (const std::int64_t gone = whole_of(*note.parameters, "lost"); gone > 0)
      std::fprintf(out, "(%lld older events are gone)\n", static_cast<long long>(gone));
    for (const Json& event : (*note.parameters)["events"]) std::fputs(lines.add(event).c_str(), out);
    std::fputs(lines.end().c_str(), out);
  });
}

int get_every(Session& session, const Call& call, std::FILE* out, std::FILE* err) {
  const auto period = period_ms(call, 1000);
  if (!period) return print(refused(period.error(), call.json, kUsage), out, err);
  InputWait attention(false);
  for (;;) {
    const CommandResult said = one_shot(session, call, {});
    if (print(said, out, err) != kOk) return said.code;
    if (flush_and_look(out) != 0) return kRefused;  // the output is lost
    const Wakeup woken = attention.wait(nullptr, milliseconds(period.value()));
    if (woken.by == By::kStop) return kOk;
  }
}

}  // namespace chimera::cli
