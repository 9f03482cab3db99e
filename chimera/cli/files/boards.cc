// SPDX-License-Identifier: Apache-2.0
// Reads the target of each board, takes its part of the description, and bakes that.
#include "chimera/cli/files/boards.h"

#include "chimera/bake/board_part.h"
#include "chimera/base/hosted/wording.h"
#include "chimera/cli/files/target_file.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/link/link_layout.h"
#include "chimera/text/time_text.h"

namespace chimera::cli {
namespace {

/// A fault in the file of the target, at the place in the description that names the target.
void add_of_target(const Report& target, const DraftRtpu& rtpu, Report& faults) {
  for (const Fault& fault : target.faults())
    if (fault.severity == Severity::kError)
      faults.add({.rule = "board-rtpu",
                  .at = rtpu.target->at,
                  .message = "target " + in_quotes(rtpu.target->text) + " of rtpu " + in_quotes(rtpu.name.text) + ": " +
                             fault.message,
                  .remedy = fault.remedy});
}

void judge_board(const Configuration& whole, RtpuId rtpu, const Library& library, const Workplace& workplace,
                 Boards& boards) {
  const DraftRtpu& draft = whole.draft().rtpus[rtpu.index];
  std::string file;
  const auto target = read_target_named(draft.target->text, workplace, file);
  if (!target) {
    boards.faults.add({.rule = "board-rtpu", .at = draft.target->at, .message = target.error().message.c_str(),
                       .remedy = "write a name of firmware/targets, or a path that ends in .yaml"});
    return;
  }
  add_of_target(target->report, draft, boards.faults);
  const Verdict part = bake::board_part(whole, rtpu, library);
  boards.faults.add_all(part.report);
  if (!target->target || !part.configuration) return;
  bake::BakeResult result = bake::bake({.configuration = *part.configuration,
                                        .target = *target->target,
                                        .target_file = file,
                                        .library = library,
                                        .acts = {},
                                        .link = whole.rtpus()[rtpu.index].link});
  for (const Fault& fault : result.description.faults())
    if (fault.severity == Severity::kError) boards.faults.add(fault);
  add_of_target(result.target, draft, boards.faults);
  boards.images.push_back({rtpu, *target->target, file, *part.configuration, std::move(result)});
}

}  // namespace

RtpuId board_named(const Configuration& configuration, const std::string& name) {
  for (std::size_t r = 0; r < configuration.rtpus().size(); ++r)
    if (configuration.rtpus()[r].link.is_there() && (name.empty() || configuration.rtpus()[r].name == name))
      return RtpuId(r);
  return {};
}

Boards judge_boards(const Configuration& configuration, const Library& library, const Workplace& workplace) {
  Boards boards{{}, Report(configuration.file(), configuration.draft().keys)};
  for (std::size_t r = 0; r < configuration.rtpus().size(); ++r)
    if (configuration.rtpus()[r].link.is_there()) judge_board(configuration, RtpuId(r), library, workplace, boards);
  boards.faults.sort();
  return boards;
}

std::string board_text(const Configuration& configuration, const BoardImage& board) {
  const RtpuSpec& rtpu = configuration.rtpus()[board.rtpu.index];
  HeapMemory memory;
  board_link::LinkLayout layout;
  layout.plan(configuration.spec(), board.rtpu, memory);
  return "  rtpu " + std::string(rtpu.name) + " is the board " + board.target.name + ", over " +
         std::string(rtpu.link.address) + ": every " + time_text(rtpu.link.period) + " a frame of " +
         std::to_string(layout.to_board_bytes()) + " B to it, and of " + std::to_string(layout.fault_at()) +
         " B from it; not valid " + time_text(rtpu.link.stale_after) + " after the last frame\n";
}

}  // namespace chimera::cli
