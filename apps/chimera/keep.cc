// SPDX-License-Identifier: Apache-2.0
// Verifies a description, claims its CPUs, and runs its processes as their keeper.
#include "apps/chimera/keep.h"

#include <grp.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>

#include "apps/chimera/board_images.h"
#include "chimera/cli/files/file_refusal.h"
#include "chimera/cli/run/run_plan.h"
#include "chimera/keeper/keeper.h"
#include "chimera/load/descriptor.h"
#include "chimera/load/sealed_objects.h"
#include "chimera/manager/state/bundle.h"
#include "chimera/platform/realtime.h"
#include "chimera/platform/shared_memory.h"
#include "chimera/platform/socket_place.h"
#include "chimera/platform/standard_streams.h"
#include "chimera/runtime/hosted/application_image.h"

namespace {

using namespace chimera;  // NOLINT: a main() of this project

Result<FrozenBytes> make_image(const cli::RunPlan& plan, const RunSettings& settings) {
  std::vector<ComponentPlace> places;
  for (const ConfiguredTask& task : plan.configuration.tasks()) {
    const LibraryEntry* entry = plan.library.find(task.component);
    CHIMERA_ASSERT(entry != nullptr);  // verified
    places.push_back({entry->object_file, fingerprint(entry->descriptor)});
  }
  return FrozenBytes::create("chimera-image", encode(plan.configuration.spec(), places, settings));
}

/// The shared objects that every rtpu loads, in memory: the files may change from now on.
Result<FrozenBytes> make_objects(const cli::RunPlan& plan) {
  std::vector<std::string> paths;
  for (const ConfiguredTask& task : plan.configuration.tasks())
    paths.push_back(plan.library.find(task.component)->object_file);
  const auto packed = SealedObjects::pack(paths);
  if (!packed) return packed.error();
  return FrozenBytes::create("chimera-objects", *packed);
}

Result<FrozenBytes> make_bundle(const KeepRequest& request, const cli::RunPlan& plan) {
  const manager::Bundle bundle{CHIMERA_VERSION,       request.run.file,        plan.description, request.observe_group,
                               request.operate_group, request.configure_group, plan.library,     request.run.settings};
  const std::string text = encode(bundle);
  return FrozenBytes::create("chimera-bundle", std::as_bytes(std::span(text)));
}

/// One claim for each CPU on which tasks run at real-time priorities; none when this user gets no such priority.
Result<std::vector<CpuClaim>> claim_cpus(const cli::RunPlan& plan, int priority) {
  std::vector<CpuClaim> claims;
  if (priority == 0 || !may_be_realtime(priority)) return claims;
  std::vector<std::uint32_t> cpus;
  for (const ConfiguredTask& task : plan.configuration.tasks())
    if (const RtpuSpec& rtpu = plan.configuration.rtpus()[task.rtpu]; !rtpu.link.is_there()) cpus.push_back(rtpu.cpu);
  std::sort(cpus.begin(), cpus.end());
  cpus.erase(std::unique(cpus.begin(), cpus.end()), cpus.end());
  for (const std::uint32_t cpu : cpus) {
    auto claim = CpuClaim::take(static_cast<int>(cpu));
    if (!claim) return claim.error();
    claims.push_back(*std::move(claim));
  }
  return claims;
}

std::string exact(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::vector<std::string> face_of(const KeepRequest& request, const cli::RunPlan& plan, const std::string& socket) {
  std::vector<std::string> words = {program_path(), "attend", "--socket=" + socket,
                                    "--parent=" + std::to_string(::getpid())};
  words.insert(words.end(), request.face.begin(), request.face.end());
  for (const cli::Bound& bound : plan.bounds)
    words.push_back("--bound=" + exact(bound.value) + ":" + exact(bound.to_written.factor) + ":" +
                    exact(bound.to_written.offset));
  return words;
}

/// True if the guard must act on the death of an rtpu, or on its silence.
bool needs_guard(const cli::RunPlan& plan) {
  const auto is_limit = [](const StandbySpec& standby) { return standby.stale_after.count > 0; };
  return std::ranges::any_of(plan.configuration.tasks(), &ConfiguredTask::is_hardware) ||
         std::ranges::any_of(plan.configuration.spec().standbys, is_limit);
}

/// "TASK:PERIODS" of each task that may not be silent for long.
std::vector<std::string> limits_of(const cli::RunPlan& plan) {
  std::vector<std::string> limits;
  const auto& tasks = plan.configuration.draft().tasks;
  for (std::size_t t = 0; t < tasks.size(); ++t)
    if (tasks[t].safe_after && tasks[t].safe_after->value > 0)
      limits.push_back(std::to_string(t) + ":" + std::to_string(tasks[t].safe_after->value));
  return limits;
}

/// Beside this program.
std::string sibling(const char* name) {
  const std::string mine = program_path();
  return mine.substr(0, mine.rfind('/') + 1) + name;
}

/// The socket is not in the folder of another user: members of a group name its path.
void say_to_members(const KeepRequest& request, const std::string& socket) {
  for (const auto& [group, may] : {std::pair{request.observe_group, "observe"},
                                   {request.operate_group, "operate"}, {request.configure_group, "configure"}}) {
    const struct group* found = group ? ::getgrgid(*group) : nullptr;
    if (found == nullptr) continue;
    std::printf("members of %s may %s: chimera status --subsystem %s\n", found->gr_name, may, socket.c_str());
  }
  (void)flush_and_look(stdout);
}

Result<int> keep(const KeepRequest& request, const cli::RunPlan& plan) {
  RunSettings settings;
  settings.priority = request.run.priority;
  const bool for_others = request.observe_group || request.operate_group || request.configure_group;
  const auto place = SocketPlace::open(socket_folder().c_str(), plan.configuration.subsystem(), for_others);
  if (!place) return place.error();
  const auto claims = claim_cpus(plan, request.run.priority);
  if (!claims) return claims.error();
  const auto image = make_image(plan, settings);
  if (!image) return image.error();
  const auto objects = make_objects(plan);
  if (!objects) return objects.error();
  const auto bundle = make_bundle(request, plan);
  if (!bundle) return bundle.error();
  if (!request.run.json) say_to_members(request, place->path());
  const auto n_rtpus = static_cast<std::uint32_t>(plan.configuration.rtpus().size());
  Keeper keeper({.peers = {.rtpu_program = sibling("chimera-rtpu"),
                           .manager_program = sibling("chimera-manager"),
                           .guard_program = needs_guard(plan) ? sibling("chimera-guard") : "",
                           .guard_limits = limits_of(plan),
                           .n_rtpus = n_rtpus,
                           .image = image->descriptor(),
                           .objects = objects->descriptor(),
                           .bundle = bundle->descriptor(),
                           .listening = place->descriptor()},
                 .face = face_of(request, plan, place->path()),
                 .ending_limit = settings.method_limit * (n_rtpus + 1) + seconds(1)});
  (void)flush_and_look(stdout);  // the run client prints after it
  if (auto started = keeper.start(); !started) return started.error();
  const int code = keeper.run();
  if (!keeper.output_is_lost()) return code;
  loss_is_told();
  return std::max(code, cli::kRefused);
}

Result<int> keep_nothing(const std::string& subsystem, const Library& library) {
  if (!is_identifier(subsystem))
    return Error{ErrorCode::kBadInput, {"a name has small letters, digits and '_' only"}, {subsystem}};
  ApplicationSpec spec;
  spec.name = subsystem;
  const auto image = FrozenBytes::create("chimera-image", encode(spec, {}, {}));
  if (!image) return image.error();
  const manager::Bundle nothing{CHIMERA_VERSION, "", "", {}, {}, {}, library};
  const std::string text = encode(nothing);
  const auto bundle = FrozenBytes::create("chimera-bundle", std::as_bytes(std::span(text)));
  if (!bundle) return bundle.error();
  const auto place = SocketPlace::open(socket_folder().c_str(), subsystem, false);
  if (!place) return place.error();
  Keeper keeper({.peers = {.rtpu_program = sibling("chimera-rtpu"),
                           .manager_program = sibling("chimera-manager"),
                           .n_rtpus = 0,
                           .image = image->descriptor(),
                           .bundle = bundle->descriptor(),
                           .listening = place->descriptor()},
                 .face = {},
                 .ending_limit = seconds(1)});
  std::printf("%s: nothing is loaded; serves `check`, `schedule` and `library` at %s\n", subsystem.c_str(),
              place->path().c_str());
  (void)flush_and_look(stdout);
  if (auto started = keeper.start(); !started) return started.error();
  return keeper.run();
}

}  // namespace

int keep_idle(const std::string& subsystem, const Workplace& workplace) {
  if (auto may = may_share_memory_here(); !may) return cli::refuse_run({}, may.error(), stdout, stderr);
  const auto library = workplace.library();
  const auto code = library ? keep_nothing(subsystem, *library) : Result<int>(library.error());
  return code ? *code : cli::refuse_run({}, code.error(), stdout, stderr);
}

int keep(const KeepRequest& request, const Workplace& workplace) {
  if (auto may = may_share_memory_here(); !may) return cli::refuse_run(request.run, may.error(), stdout, stderr);
  int wrong = cli::kRefused;
  const auto plan = cli::plan_run(request.run, workplace, stdout, stderr, &wrong);
  if (!plan) return wrong;
  const auto boards = take_boards(*plan, request.run.file, workplace, request.flash);
  if (!boards) return cli::refuse_run(request.run, boards.error(), stdout, stderr);
  const auto code = keep(request, *plan);
  return code ? *code : cli::refuse_run(request.run, code.error(), stdout, stderr);
}
