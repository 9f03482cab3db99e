// SPDX-License-Identifier: Apache-2.0
// Finds the target, judges the description for it, and writes the files of the image.
#include "chimera/cli/batch/bake.h"

#include <filesystem>
#include <optional>

#include "chimera/bake/bake.h"
#include "chimera/bake/board_part.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/cli/batch/bake_text.h"
#include "chimera/cli/batch/desk_init.h"
#include "chimera/cli/files/boards.h"
#include "chimera/cli/files/file_refusal.h"
#include "chimera/cli/files/output_file.h"
#include "chimera/cli/files/target_file.h"
#include "chimera/cli/run/run.h"
#include "chimera/cli/run/run_plan.h"
#include "chimera/text/time_text.h"
#include "chimera/verify/verify.h"

namespace chimera::cli {
namespace {

/// Warnings about budgets are left out: they belong to the machine of the description.
Report without_budgets(const Report& report) {
  Report kept(report.file(), report.keys());
  for (const Fault& fault : report.faults())
    if (fault.rule != "utilisation") kept.add(fault);
  return kept;
}

CommandResult refuse(const Report& description, const Report& target, bool json) {
  if (!json) return {"", description.text() + target.text(), kRefused};
  Json all = Json::object();
  all["baked"] = false;
  all["description_faults"] = Json::parse(description.json());
  all["target_faults"] = Json::parse(target.json());
  return {all.dump(Json::Style::kDense) + "\n", "", kRefused};
}

Result<void> write_files(const std::string& folder, std::span<const bake::BakedFile> files) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Error{ErrorCode::kSystem, {"cannot be made: " + error.message()}, {folder}};
  for (const bake::BakedFile& file : files)
    if (auto written = write_whole(folder + "/" + file.name, file.text); !written) return written;
  return {};
}

CommandResult report(const BakeRequest& request, const RunPlan& plan, const bake::Target& target,
                     const bake::BakeResult& result, const DeskInit& inits) {
  CommandResult output;
  output.code = result.is_baked() ? kOk : kRefused;
  if (request.json) {
    Json all = bake_json(plan.configuration, target, result);
    all["init_faults"] = Json(inits.refusals);
    output.out = all.dump(Json::Style::kDense) + "\n";
    return output;
  }
  output.err = result.description.text() + result.target.text();
  for (const std::string& refusal : inits.refusals) output.err += request.file + ": error: " + refusal + "\n";
  for (const std::string& note : result.notes) output.err += "note: " + note + "\n";
  if (result.is_baked())
    output.out = plan.configuration.subsystem() + " for " + target.name + ": baked into " + request.out + "\n";
  output.out += bake_text(plan.configuration, target, result);
  return output;
}

/// Both files are legal: what remains is whether they suit each other.
CommandResult bake_for(const BakeRequest& request, const bake::Target& target, const std::string& target_file,
                       RunPlan plan, const LinkSpec& link) {
  if (!request.settings.empty()) {
    auto set = with_settings(plan.configuration, plan.library, request.settings, Overload::kTold);
    if (!set) return file_refusal(set.error(), request.json);
    plan.configuration = *std::move(set);
  }
  RunRequest run;
  run.file = request.file;
  run.at = request.at;
  run.duration = request.duration;
  if (auto judged = judge_acts(run, plan); !judged) return file_refusal(judged.error(), request.json, kUsage);
  for (const ScriptAct& act : plan.acts)
    if (act.kind == ScriptAct::Kind::kSwitch && act.lists != nullptr)
      return file_refusal({ErrorCode::kRefused,
                           {"--at " + time_text(act.at) + ": an image has plans of switches between configurations "
                            "only; write 'switch CONFIGURATION'"},
                           {request.file}},
                          request.json, kUsage);
  std::optional<RecordedProfile> profile;
  if (!request.profile.empty()) {
    auto read = read_recorded_profile(request.profile);
    if (!read) return file_refusal(read.error(), request.json);
    profile = *std::move(read);
  }
  bake::BakeResult result = bake::bake({.configuration = plan.configuration,
                                        .target = target,
                                        .target_file = target_file,
                                        .library = plan.library,
                                        .profile = profile ? &*profile : nullptr,
                                        .acts = plan.acts,
                                        .duration = request.duration,
                                        .link = link});
  DeskInit inits;
  if (result.is_baked()) {
    inits = init_at_desk({plan.configuration, target, profile ? &*profile : nullptr}, plan.library);
    if (!inits.untried.empty())
      result.notes.push_back("'init' is not tried here, because it needs the board: " + join(inits.untried, ", "));
    if (!inits.refusals.empty()) result.files.clear();
  }
  if (result.is_baked())
    if (auto written = write_files(request.out, result.files); !written)
      return file_refusal(written.error(), request.json);
  return report(request, plan, target, result, inits);
}

/// Replaces the verdict by that of the part of a board, if the description has one. `target`: as asked for, else as the
/// description says.
Result<void> take_board(const BakeRequest& request, const Library& library, Verdict& verdict, LinkSpec& link,
                        std::string& target) {
  const RtpuId board = verdict.configuration ? board_named(*verdict.configuration, request.rtpu) : RtpuId();
  if (board.is_valid()) {
    const Configuration whole = *verdict.configuration;
    if (target.empty()) target = whole.draft().rtpus[board.index].target->text;
    link = whole.rtpus()[board.index].link;
    verdict = bake::board_part(whole, board, library);
    if (request.duration != kNever || !request.at.empty() || !request.settings.empty())
      return Error{ErrorCode::kBadInput, {"--for, --at and --set are not for a board with a link: Linux decides"}, {}};
    return {};
  }
  if (verdict.configuration && !request.rtpu.empty())
    return Error{ErrorCode::kBadInput, {"'" + request.rtpu + "' is no rtpu with 'target' and 'link'"}, {request.file}};
  if (target.empty() && verdict.configuration) return Error{ErrorCode::kBadInput, {"give --target NAME"}, {}};
  if (target.empty()) target = "mps2-an385";  // the description is refused anyway
  return {};
}

}  // namespace

CommandResult bake(const BakeRequest& request, const Workplace& workplace) {
  auto library = workplace.library(request.file);
  if (!library) return file_refusal(library.error(), request.json);
  ReadDescription reading = read_description_file(request.file);
  Verdict verdict = verify(reading, *library, Overload::kTold);
  LinkSpec link;
  std::string name = request.target;
  if (auto part = take_board(request, *library, verdict, link, name); !part)
    return file_refusal(part.error(), request.json, kUsage);
  std::string target_file;
  const auto target = read_target_named(name, workplace, target_file);
  if (!target) return file_refusal(target.error(), request.json);
  const Report description = without_budgets(verdict.report);
  if (!verdict.configuration || !target->target) return refuse(description, target->report, request.json);
  CommandResult output = bake_for(request, *target->target, target_file,
                                  RunPlan{*std::move(library), std::move(reading.text), *verdict.configuration,
                                          {}, {}, {}, {}, {}, {}}, link);
  if (!request.json) output.err = description.text() + output.err;
  return output;
}

}  // namespace chimera::cli
