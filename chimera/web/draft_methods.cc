// SPDX-License-Identifier: Apache-2.0
// Carries out the methods of the draft: asks the analyst, changes the draft, and keeps it on the disk.
#include "chimera/web/draft_methods.h"

#include <algorithm>

#include "chimera/description/report.h"
#include "chimera/text/json.h"

namespace chimera::web {
namespace {

using control::MethodId;
using control::RpcResponse;
using manager::Question;

/// Acts count as questions of another connection, which never ends: an edit is carried out even if its page closes.
constexpr std::uint64_t kOfActs = std::uint64_t{1} << 63;
constexpr std::uint64_t kOfAll = UINT64_MAX;  // the analysis that all pages share

/// An object, with one more member that is JSON already.
class WithMember final : public control::Pieces {
 public:
  /// `begin`: the text up to the member.
  WithMember(std::string begin, const std::shared_ptr<const std::string>& member)
      : begin_(std::move(begin)), member_(member, *member) {}
  bool append_to(std::string& text) override {
    text += std::exchange(begin_, {});
    if (member_.append_to(text)) return true;
    text += '}';
    return false;
  }

 private:
  std::string begin_;
  control::TextPieces member_;
};

/// In the place of an analysis that failed: the text is there all the same.
std::string no_analysis(std::uint64_t version, const std::string& file, const std::string& text) {
  Json report = Json::parse(Report(file).json());
  report["legal"] = false;
  Json all = Json::object();
  all["version"] = version;
  all["text"] = text;
  all["report"] = std::move(report);
  for (const char* key : {"outline", "picture", "schedule"}) all[std::string_view(key)] = nullptr;
  return all.dump(Json::Style::kAsMade);
}

}  // namespace

std::shared_ptr<const std::string> text_of(const RpcResponse& answer) {
  if (answer.text != nullptr) return answer.text;
  std::string text;
  while (answer.pieces->append_to(text)) {
  }
  return std::make_shared<const std::string>(std::move(text));
}

DraftMethods::DraftMethods(const std::string& file, const std::string& folder, Analyst& analyst, Clock& clock,
                           Tell tell)
    : analyst_(analyst),
      clock_(clock),
      disk_(file),
      kept_(folder, file, std::move(tell)),
      draft_(disk_.read(), kept_.read()) {
  on_disk_ = draft_.to_keep();
  if (!on_disk_) keep();  // removes a kept draft that FILE has
}

void DraftMethods::call(MethodId method, const Json& parameters, const control::Caller& caller,
                        const control::Reply& reply) {
  look();
  if (method == MethodId::kDifferences) return differences(parameters, caller.connection, reply);
  if (method == MethodId::kWrite || method == MethodId::kKeep) see(disk_.read());
  const Json* version = parameters.find("version");
  if (version != nullptr && version->as_uint64() != draft_.version()) return reply(stale());
  switch (method) {
    case MethodId::kEdit:
      return change_to(draft_.text(), parameters.at("acts").dump(), caller.connection, reply);
    case MethodId::kReplace:
      return change_to(parameters.at("text").as_string(), "", caller.connection, reply);
    case MethodId::kRemedies:
    case MethodId::kTransitions:
      return analyst_.ask({method == MethodId::kRemedies ? Question::Kind::kOffers : Question::Kind::kModes,
                           disk_.path(), draft_.text(), "", draft_.version()},
                          caller.connection, [reply](const RpcResponse& given, std::string_view) { reply(given); });
    case MethodId::kWrite:
      return reply(write());
    case MethodId::kKeep:
      if (const RpcResponse settled = settle(parameters.at("what").as_string()); !settled.is_good())
        return reply(settled);
      break;
    default:
      break;
  }
  give(caller.connection, reply);
}

void DraftMethods::forget(std::uint64_t connection) {
  std::erase_if(waiters_, [connection](const Waiter& one) { return one.connection == connection; });
}

void DraftMethods::look() {
  if (auto file = disk_.read_changed(clock_.now())) see(*std::move(file));
}

void DraftMethods::see(FileNow file) {
  if (file == draft_.file()) return;
  draft_.see(std::move(file));
  changed();
}

/// The draft, or what it is based on, has changed.
void DraftMethods::changed() {
  if (draft_.to_keep() != on_disk_) keep_due_ = std::min(keep_due_, clock_.now() + kKeepAfter);
}

void DraftMethods::serve() {
  if (clock_.now() >= keep_due_) keep();
}

void DraftMethods::keep() {
  const auto wanted = draft_.to_keep();
  const auto done = kept_.keep(wanted);
  keep_due_ = done ? kNever : clock_.now() + kKeepAgain;
  keep_problem_.clear();
  if (done) {
    on_disk_ = wanted;
  } else {
    keep_problem_ = "the draft cannot be kept: " + std::string(done.error().where.view()) + ": " +
                    std::string(done.error().message.view());
  }
}

std::string DraftMethods::problem() const {
  if (!draft_.file().problem.empty()) return draft_.file().problem;
  return keep_problem_.empty() ? kept_.aside() : keep_problem_;
}

Json DraftMethods::facts(const std::string& problem) const {
  Json facts = Json::object();
  facts["version"] = draft_.version();
  facts["file"] = disk_.path();
  facts["exists"] = draft_.file().exists;
  facts["touched"] = draft_.is_touched();
  facts["outside"] = draft_.is_outside();
  facts["problem"] = problem.empty() ? Json() : Json(problem);
  return facts;
}

Json DraftMethods::note() {
  look();
  return facts(problem());
}

RpcResponse DraftMethods::stale() const {
  return RpcResponse::error(control::kRefused,
                            "the draft has changed: its version is " + std::to_string(draft_.version()),
                            {{"kind", "stale"}, {"where", "version"}, {"version", draft_.version()}});
}

RpcResponse DraftMethods::file_refusal(const std::string& what) const {
  if (!draft_.file().problem.empty()) return RpcResponse::refused("file", draft_.file().problem, disk_.path());
  if (draft_.is_outside())
    return RpcResponse::refused("outside", "another program changed " + disk_.path() + " while the draft was touched",
                                disk_.path(), "keep the draft or the file");
  return what.empty() ? RpcResponse{} : RpcResponse::refused("file", what, disk_.path());
}

RpcResponse DraftMethods::answer(const std::shared_ptr<const std::string>& analysis, const std::string& problem) const {
  std::string begin = facts(problem).dump(Json::Style::kAsMade);
  begin.back() = ',';
  return RpcResponse::in_pieces(std::make_shared<WithMember>(begin + "\"analysis\":", analysis));
}

/// The answer of `draft`, at once or after the analysis that is under way.
void DraftMethods::give(std::uint64_t connection, const control::Reply& reply) {
  const bool is_new = analysis_.version != draft_.version() || analysis_.library != analyst_.library();
  if (!is_new && analysis_.text != nullptr) return reply(answer(analysis_.text, problem()));
  if (waiters_.size() >= kMaxWaiters)
    return reply(RpcResponse::error(control::kTooFast, "64 requests wait for the analysis", {{"retry_ms", 100}}));
  waiters_.push_back({connection, reply});
  if (is_new || waiters_.size() == 1) analyse();
}

void DraftMethods::analyse() {
  analysis_ = {draft_.version(), analyst_.library(), nullptr};
  analyst_.ask({Question::Kind::kDraft, disk_.path(), draft_.text(), "", draft_.version()}, kOfAll,
               [this, asked = analysis_](const RpcResponse& given, std::string_view) { take_analysis(asked, given); });
}

void DraftMethods::take_analysis(const Analysis& asked, const RpcResponse& given) {
  if (!(asked == analysis_)) return;  // a later one is under way, or there already
  if (asked.version != draft_.version()) {
    analysis_ = {};
    if (!waiters_.empty()) analyse();
  } else if (given.is_good()) {
    analysis_.text = text_of(given);
    answer_all({});
  } else {
    analysis_ = {};
    answer_all(given);
  }
}

/// `given`: the refusal of the analysis; good: it is there.
void DraftMethods::answer_all(const RpcResponse& given) {
  const bool is_refused = given.code == control::kRefused;
  const auto failed =
      std::make_shared<const std::string>(is_refused ? no_analysis(draft_.version(), disk_.path(), draft_.text()) : "");
  for (const Waiter& one : std::exchange(waiters_, {})) {
    if (given.is_good())
      one.reply(answer(analysis_.text, problem()));
    else
      one.reply(is_refused ? answer(failed, given.message) : given);
  }
}

void DraftMethods::change_to(const std::string& text, const std::string& acts, std::uint64_t connection,
                             const control::Reply& reply) {
  if (const std::string why = text_problem(text); !why.empty()) return reply(RpcResponse::refused("edit", why, "text"));
  const std::uint64_t version = draft_.version(), library = analyst_.library();
  analyst_.ask({Question::Kind::kDraft, disk_.path(), text, acts, version + 1}, connection | kOfActs,
               [this, version, library, reply](const RpcResponse& given, std::string_view edited) {
                 take_change(version, library, given, edited, reply);
               });
}

void DraftMethods::take_change(std::uint64_t version, std::uint64_t library, const RpcResponse& given,
                               std::string_view edited, const control::Reply& reply) {
  if (!given.is_good()) return reply(given);
  if (draft_.version() != version) return reply(stale());
  if (const std::string why = text_problem(edited); !why.empty())
    return reply(RpcResponse::refused("edit", why, "text"));
  draft_.change(std::string(edited));
  changed();
  analysis_ = {draft_.version(), library, text_of(given)};
  reply(answer(analysis_.text, problem()));
  answer_all({});
}

void DraftMethods::differences(const Json& parameters, std::uint64_t connection, const control::Reply& reply) {
  const Json* given = parameters.find("text");
  const std::string with = given != nullptr ? given->as_string() : draft_.file().text;
  if (const std::string why = text_problem(with); !why.empty()) return reply(RpcResponse::refused("edit", why, "text"));
  if (given == nullptr && !draft_.file().problem.empty()) return reply(file_refusal(""));
  analyst_.ask({Question::Kind::kDifferences, disk_.path(), draft_.text(), with, draft_.version()}, connection,
               [reply](const RpcResponse& said, std::string_view) { reply(said); });
}

RpcResponse DraftMethods::write() {
  if (const RpcResponse refusal = file_refusal(""); !refusal.is_good()) return refusal;
  const bool is_touched = draft_.is_touched();
  if (is_touched) {
    if (const auto written = disk_.write(draft_.text()); !written) {
      see(disk_.read());
      return file_refusal(disk_.path() + ": " + std::string(written.error().message.view()));
    }
    draft_.written();
    keep();
  }
  return RpcResponse::good({{"version", draft_.version()}, {"file", disk_.path()}, {"changed", is_touched}});
}

RpcResponse DraftMethods::settle(const std::string& what) {
  if (!draft_.file().problem.empty()) return file_refusal("");
  if (what == "draft") {
    draft_.keep_draft();
  } else if (draft_.file().is_read()) {
    draft_.keep_file();
  } else {
    return RpcResponse::refused("file", disk_.path() + " is not there", disk_.path(), "keep the draft");
  }
  changed();
  return {};
}

RpcResponse DraftMethods::may_start() {
  see(disk_.read());
  if (!draft_.file().problem.empty()) return file_refusal("");
  if (!draft_.file().exists)
    return RpcResponse::refused("file", disk_.path() + " is not there", disk_.path(), "write it");
  if (draft_.is_touched())
    return RpcResponse::refused("touched", "the draft is not written to " + disk_.path(), disk_.path(), "write it");
  return {};
}

}  // namespace chimera::web
