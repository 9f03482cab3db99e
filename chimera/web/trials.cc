// SPDX-License-Identifier: Apache-2.0
// Makes the words of `chimera run --virtual` and `chimera scope`, starts and ends them, and reads what they wrote.
#include "chimera/web/trials.h"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/control/methods.h"
#include "chimera/platform/file.h"
#include "chimera/platform/process_state.h"
#include "chimera/text/json.h"
#include "chimera/units/quantity.h"
#include "chimera/web/draft_file.h"

namespace chimera::web {
namespace {

namespace fs = std::filesystem;
using control::MethodId;
using control::RpcResponse;

constexpr std::size_t kMostWords = 32, kMostWordBytes = 400;
constexpr std::int64_t kMostSamples = 2000;
constexpr std::size_t kMostOutput = std::size_t{1} << 20;

RpcResponse bad(const std::string& key, const std::string& message) {
  return RpcResponse::error(control::kBadParameters, "'" + key + "' " + message, {{"where", key}});
}

RpcResponse refusal_of(const Error& error) {
  return RpcResponse::refused("other", std::string(error.where.view()) + ": " + error.message.c_str(), "");
}

/// Each text becomes a word of a command line: it must be short, and end where C ends it.
RpcResponse judge_words(const Json& parameters) {
  for (const auto& [key, value] : parameters.items()) {
    const std::vector<std::string> words = value.is_string()  ? std::vector{value.as_string()}
                                           : value.is_array() ? value.as_strings()
                                                              : std::vector<std::string>();
    const bool is_needed = key == "watch" || key == "channels";
    if (words.size() > kMostWords || (words.empty() && is_needed))
      return bad(key,
                 "must have " + std::string(is_needed ? "1 to " : "at most ") + std::to_string(kMostWords) + " texts");
    for (const std::string& word : words)
      if (word.empty() || word.size() > kMostWordBytes || word.find('\0') != std::string::npos)
        return bad(key, "must have 1 to " + std::to_string(kMostWordBytes) + " bytes, none of them 0");
  }
  return {};
}

/// `written` without the quotes in which a description may write it.
std::string unquoted(const std::string& written) {
  const char mark = written.size() > 1 ? written[0] : '\0';
  const bool is_quoted = (mark == '"' || mark == '\'') && written.back() == mark;
  return is_quoted ? written.substr(1, written.size() - 2) : written;
}

/// Resources of the draft that several tasks may not open at once.
Json devices_of(const Json& outline) {
  Json all = Json::array();
  for (const Json& task : outline["tasks"])
    for (const Json& port : task["ports"])
      if (port["kind"] == Json("resource") && port["shared"] != Json(true))
        all.push_back({{"task", task["task"]},
                       {"port", port["port"]},
                       {"text", port["value"].is_string() ? unquoted(port["value"].as_string()) : ""}});
  return all;
}

RpcResponse ask_about(const Json& devices) {
  std::string names;
  for (const Json& one : devices)
    names += (names.empty() ? "" : ", ") + one["task"].as_string() + "." + one["port"].as_string() + " " +
             one["text"].as_string();
  return RpcResponse::error(control::kRefused, "the try opens what the resources name: " + names,
                            {{"kind", "devices"}, {"where", "devices"}, {"resources", devices}});
}

/// The shortest period, or a multiple that gives at most kMostSamples.
Nanoseconds sample_period(const Json& outline, Nanoseconds duration) {
  std::int64_t shortest = INT64_MAX;
  for (const Json& task : outline["tasks"])
    if (const Json& period = task["period_ns"]; period.is_whole() && task["aperiodic"] != Json(true))
      shortest = std::min(shortest, period.as_int64());
  if (shortest == INT64_MAX) shortest = milliseconds(1).count;
  const auto steps = std::max<std::int64_t>(duration.count - 1, 0) / kMostSamples / shortest + 1;
  return Nanoseconds{steps * shortest};
}

void add_words(std::vector<std::string>& words, const Json& parameters, const char* key, const std::string& option) {
  const Json* value = parameters.find(key);
  if (value == nullptr) return;
  for (const std::string& one : value->is_array() ? value->as_strings() : std::vector{value->as_string()})
    words.push_back(option + "=" + one);
}

std::string start_of_file(const std::string& path) {
  auto text = read_ordinary(path, kMostOutput);
  return text ? *std::move(text) : std::string();
}

/// Null without the file, and if it met its limit: the rest is missing.
Json whole_file(const std::string& path, std::uint64_t most) {
  const auto text = read_ordinary(path, most);
  return text && text->size() < most ? Json(*text) : Json();
}

}  // namespace

void Trials::call(MethodId method, const Json& parameters, const control::Caller& caller, const control::Reply& reply,
                  DraftMethods* draft) {
  serve();
  if (const RpcResponse judged = judge_words(parameters); !judged.is_good()) return reply(judged);
  if (method == MethodId::kTry && draft != nullptr) return try_draft(parameters, caller.connection, reply, *draft);
  if (method == MethodId::kTry)
    return reply(
        RpcResponse::refused("draft", "this page has no draft: no FILE was named", "", "type `chimera web FILE`"));
  if (method == MethodId::kScope) return reply(scope(parameters, caller.connection));
  const std::uint64_t number = parameters.at("number").as_uint64();
  const auto found = std::ranges::find(all_, number, &Trial::number);
  if (found == all_.end())
    return reply(RpcResponse::unknown(
        "there is no trial " + std::to_string(number) + ": the last " + std::to_string(kMostKept) + " are kept",
        "number", ""));
  if (method == MethodId::kResult) return reply(result(*found));
  stop(*found, "halted");
  reply(RpcResponse::good(Json::object()));
}

/// The draft is asked for as a page does: the answer has the text of this version, and its outline.
void Trials::try_draft(const Json& parameters, std::uint64_t connection, const control::Reply& reply,
                       DraftMethods& draft) {
  const auto take = [this, parameters, connection, reply](const RpcResponse& given) {
    if (!given.is_good()) return reply(given);
    const Json answer = Json::parse(*text_of(given));
    if (answer["version"] != parameters["version"])
      return reply(RpcResponse::error(control::kRefused, "the draft has changed",
                                      {{"kind", "stale"}, {"where", "version"}, {"version", answer["version"]}}));
    reply(try_text(parameters, answer["analysis"], connection));
  };
  draft.call(MethodId::kDraft, {{"version", parameters["version"]}}, {control::Role::kConfigure, connection, 0}, take);
}

RpcResponse Trials::try_text(const Json& parameters, const Json& analysis, std::uint64_t connection) {
  const auto duration = parse_duration(parameters["duration"].as_string());
  if (!duration) return bad("duration", duration.error().message.c_str());
  const Json& outline = analysis["outline"];
  if (!outline.is_object())
    return RpcResponse::refused("draft", "the draft is no description yet", "version", "mend the text first");
  if (const Json devices = devices_of(outline); !devices.empty() && parameters["devices"] != Json(true))
    return ask_about(devices);
  std::vector<std::string> words = {"--virtual", "--json", "--for=" + parameters["duration"].as_string()};
  add_words(words, parameters, "watch", "--watch");
  add_words(words, parameters, "at", "--at");
  add_words(words, parameters, "expect", "--expect");
  add_words(words, parameters, "every", "--every");
  if (!parameters.contains("every"))
    words.push_back("--every=" + std::to_string(sample_period(outline, *duration).count) + " ns");
  return start(std::move(words), analysis["text"].as_string(), kTryLimit, connection);
}

RpcResponse Trials::scope(const Json& parameters, std::uint64_t connection) {
  const std::string& machine = parameters.at("machine").as_string();
  if (machine.find('/') != std::string::npos) return bad("machine", "must be the name of a subsystem");
  std::vector<std::string> words = {"--json", "--subsystem=" + machine};
  for (const char* key : {"trigger", "pre", "for", "wait"}) add_words(words, parameters, key, "--" + std::string(key));
  words.emplace_back("--");  // a channel is never an option
  for (const std::string& channel : control::texts(parameters, "channels")) words.push_back(channel);
  return start(std::move(words), "", kNever, connection);
}

/// `text`: of the draft, for a try; "": a recording.
RpcResponse Trials::start(std::vector<std::string> words, const std::string& text, Nanoseconds limit,
                          std::uint64_t connection) {
  if (std::ranges::count_if(all_, [](const Trial& one) { return !one.end; }) >= std::ptrdiff_t{kMostRunning})
    return RpcResponse::refused("under-way", std::to_string(kMostRunning) + " trials run already", "",
                                "halt one of them, or wait for its end");
  if (const auto made = make_place(); !made) return refusal_of(made.error());
  Trial trial{.number = last_ + 1, .connection = connection, .folder = place_ + "/" + std::to_string(last_ + 1)};
  if (const auto prepared = prepare(trial, text); !prepared) return refusal_of(prepared.error());
  words.insert(words.begin(), "--csv=" + trial.folder + "/csv");
  if (text.empty())
    words.insert(words.begin(), {program_, "scope", "--svg=" + trial.folder + "/svg"});
  else
    words.insert(words.begin(), {program_, "run", trial.folder + "/text/" + fs::path(file_).filename().string()});
  std::vector<const char*> arguments;
  for (const std::string& word : words) arguments.push_back(word.c_str());
  const auto output = open_to_append(trial.folder + "/output"), error = open_to_append(trial.folder + "/error");
  if (!output) return refusal_of(output.error());
  if (!error) return refusal_of(error.error());
  auto started = Process::start_apart(
      program_.c_str(), arguments,
      {.output = output->fd, .error = error->fd, .is_bound = true, .memory = kMemory, .file = kMostBytes});
  if (!started) return refusal_of(started.error());
  trial.process = *std::move(started);
  trial.began = clock_.now();
  if (limit != kNever) trial.stop_at = trial.began + limit;
  ++last_;
  all_.push_back(std::move(trial));
  return RpcResponse::good({{"number", last_}});
}

/// The folder of this process, once; those of processes that were killed go.
Result<void> Trials::make_place() {
  if (!place_.empty()) return {};
  if (auto made = make_drafts_folder(folder_); !made) return made;
  std::error_code error;
  for (fs::directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    std::error_code ignored;
    const int process = std::atoi(at->path().filename().c_str());
    if (process > 0 && (process == own_process_id() || has_process_ended(process))) fs::remove_all(at->path(), ignored);
  }
  const std::string place = folder_ + "/" + std::to_string(own_process_id());
  if (!make_private_folder(place)) return Message("cannot be made").error(ErrorCode::kSystem, place);
  place_ = place;
  return {};
}

/// The text stands in a folder with the `build` of FILE: the run finds the same components.
Result<void> Trials::prepare(const Trial& trial, const std::string& text) const {
  std::error_code error;
  fs::remove_all(trial.folder, error);
  fs::create_directories(trial.folder + "/text", error);
  if (error) return Message("cannot be made").error(ErrorCode::kSystem, trial.folder);
  if (text.empty()) return {};
  const fs::path file(file_), place = fs::path(trial.folder) / "text";
  fs::create_directory_symlink(file.parent_path() / "build", place / "build", error);
  std::ofstream out(place / file.filename(), std::ios::binary);
  out << text;
  if (!out.flush()) return Message("cannot be written").error(ErrorCode::kSystem, (place / file.filename()).string());
  return {};
}

/// `text` with the path of FILE in place of that of its copy.
std::string Trials::plain(const Trial& trial, std::string text) const {
  const std::string copy = trial.folder + "/text/" + fs::path(file_).filename().string();
  for (std::size_t at = 0; !file_.empty() && (at = text.find(copy, at)) != std::string::npos; at += file_.size())
    text.replace(at, copy.size(), file_);
  return text;
}

RpcResponse Trials::result(const Trial& trial) const {
  Json answer = Json::object();
  answer["number"] = trial.number;
  answer["ended"] = !trial.end             ? Json()
                    : trial.end->by_signal ? Json{{"signal", std::string(signal_text(trial.end->code).view())}}
                                           : Json{{"code", trial.end->code}};
  answer["why"] = trial.why.empty() ? Json() : Json(trial.why);
  answer["ran_ms"] = ((trial.end ? trial.ended : clock_.now()) - trial.began).count / 1'000'000;
  for (const char* key : {"output", "error", "csv", "svg"}) answer[std::string_view(key)] = nullptr;
  if (trial.end) {
    const std::string output = plain(trial, start_of_file(trial.folder + "/output"));
    answer["output"] = Json::parse_or_none(output).value_or(Json(output));
    answer["error"] = plain(trial, start_of_file(trial.folder + "/error"));
    answer["csv"] = whole_file(trial.folder + "/csv", kMostBytes);
    answer["svg"] = whole_file(trial.folder + "/svg", kMostBytes);
  }
  return RpcResponse::ready(std::make_shared<const std::string>(answer.dump(Json::Style::kAsMade)));
}

void Trials::stop(Trial& trial, const char* why) {
  if (trial.end || trial.kill_at != kNever) return;
  trial.why = why;
  trial.stop_at = kNever;
  trial.kill_at = clock_.now() + kEndLimit;
  (void)trial.process.signal(SIGINT);
}

void Trials::forget(std::uint64_t connection) {
  for (Trial& one : all_)
    if (one.connection == connection) stop(one, "its page is gone");
}

void Trials::append_descriptors(std::vector<int>& all) const {
  for (const Trial& one : all_) all.push_back(one.process.pidfd());
}

Nanoseconds Trials::next_due() const noexcept {
  Nanoseconds due = kNever;
  for (const Trial& one : all_)
    if (!one.end) due = std::min({due, one.stop_at, one.kill_at});
  return due;
}

void Trials::serve() {
  const Nanoseconds now = clock_.now();
  for (Trial& one : all_) {
    if (one.end) continue;
    if (ProcessEnd end; one.process.has_ended(end)) {
      one.end = end;
      one.ended = now;
    } else if (now >= one.stop_at) {
      stop(one, "its 60 s are over");
    } else if (now >= one.kill_at) {
      one.kill_at = now + kEndLimit;
      (void)one.process.signal(SIGKILL);
    }
  }
  std::erase_if(all_, [this](const Trial& one) {
    std::error_code ignored;
    const bool is_old = one.end && one.number + kMostKept <= last_;
    if (is_old) fs::remove_all(one.folder, ignored);
    return is_old;
  });
}

void Trials::finish() {
  for (Trial& one : all_) {
    ProcessEnd end;
    if (!one.end && one.process.signal(SIGKILL)) (void)one.process.wait(end, kSigkillLimit.count);
  }
  all_.clear();
  std::error_code ignored;
  if (!place_.empty()) fs::remove_all(std::exchange(place_, {}), ignored);
}

}  // namespace chimera::web
