// SPDX-License-Identifier: Apache-2.0
// Writes the present operator values into the description that the subsystem was started from.
#include "chimera/cli/live/save_file.h"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/cli/print/answer_text.h"
#include "chimera/cli/print/fields.h"
#include "chimera/control/state_folder.h"
#include "chimera/description/draft.h"
#include "chimera/description/edit/text_edit.h"
#include "chimera/platform/clock.h"
#include "chimera/platform/file.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

constexpr std::size_t kMostBytes = 1 << 20;  // a description has at most 256 KiB

Error refusal(const std::string& message, const std::string& where = {}) {
  return {ErrorCode::kRefused, std::string_view(message), std::string_view(where)};
}

struct DescriptionFile {
  std::string path, text;
  FileState state;
};

Result<DescriptionFile> read_file(const std::string& path) {
  char real[PATH_MAX];
  DescriptionFile file;
  if (::realpath(path.c_str(), real) == nullptr) return refusal(std::strerror(errno), path);
  file.path = real;
  auto text = read_ordinary(file.path, kMostBytes);
  if (!text) return refusal(std::string(text.error().message.view()), path);
  const auto state = state_of_file(real);
  if (!state) return refusal("cannot be read", path);
  file.state = *state;
  file.text = *std::move(text);
  return file;
}

std::string own_record(const DescriptionFile& file) {
  return file.path + "\n" + std::to_string(file.state.inode) + " " + std::to_string(file.state.changed_ns) + "\n";
}

std::string record_path(const std::string& subsystem) { return control::state_folder() + "/saved-" + subsystem; }

/// The file is as it was when the subsystem read it, or as this command left it.
bool is_as_known(const DescriptionFile& file, std::int64_t started_wall_ns, const std::string& subsystem) {
  if (file.state.changed_ns < started_wall_ns) return true;
  std::ifstream record(record_path(subsystem), std::ios::binary);
  std::ostringstream text;
  text << record.rdbuf();
  return text.str() == own_record(file);
}

/// Path at which the keeper found the file. The name may be relative to the folder in which the keeper was started.
std::string file_of(const Json& hello) {
  std::string file = text_of(hello, "file");
  if (file.empty() || file[0] == '/') return file;
  return "/proc/" + std::to_string(whole_of(hello, "keeper_pid")) + "/cwd/" + file;
}

/// Nanoseconds since 1970 at which the subsystem started, from CLOCK_MONOTONIC.
std::int64_t started_wall_ns(const Json& status) {
  return whole_of(status, "origin_ns") + wall_clock_shift();
}

std::string first_fault(const Json& report) {
  for (const Json& fault : report["faults"])
    if (text_of(fault, "severity") == "error") return text_of(fault, "message");
  return "not legal";
}

Result<std::string> edited(Session& session, const DescriptionFile& file, const Json& values) {
  const auto units = UnitSystem::load(session.surroundings().unit_files);
  if (!units) return units.error();
  const ReadDescription reading = read_description(file.text, "");
  if (!reading.draft) return refusal("the description cannot be read");
  std::vector<EditAct> acts;
  for (const auto& [name, value] : values.items()) {
    const auto is_given = [&key = name](const NamedNode& node) { return node.name.text == key; };
    const auto given = std::ranges::find_if(reading.draft->operators, is_given);
    if (given == reading.draft->operators.end()) return refusal("is not under `operator:`", name);
    if (reading.draft->sequence && given->name.at == reading.draft->sequence->at) continue;  // `sequence_go`
    acts.emplace_back(SetValue{{"operator", name}, text_of(values, name), &units.value()});
  }
  auto text = edit_text(file.text, acts);
  if (!text || text.value() == file.text) return text;
  const control::RpcResponse checked = session.ask("check", {{"text", text.value()}, {"file", file.path}});
  if (!checked.is_good()) return refusal(checked.message);
  if (!truth_at(*checked.result, "legal"))
    return refusal("with these values the description is not legal: " + first_fault(*checked.result), file.path);
  return text;
}

}  // namespace

CommandResult save_to_file(Session& session, const Call& call) {
  const control::RpcResponse hello = session.ask("hello"), status = session.ask("status"), saved = session.ask("save");
  for (const control::RpcResponse* answer : {&hello, &status, &saved})
    if (!answer->is_good()) return refused(*answer, call.json);
  const std::string subsystem = text_of(*hello.result, "subsystem");
  const Json& values = (*saved.result)["operator"];
  auto file = read_file(file_of(*hello.result));
  if (!file) return refused(file.error(), call.json);
  if (!is_as_known(file.value(), started_wall_ns(*status.result), subsystem))
    return refused(refusal("has changed since the subsystem was started from it; nothing was written", file->path),
                   call.json);
  const auto text = edited(session, file.value(), values);
  if (!text) return refused(text.error(), call.json);
  const bool is_new = text.value() != file->text;
  if (is_new) {
    if (const auto replaced = replace_file(file->path, file->state, text.value()); !replaced)
      return refused(replaced.error(), call.json);
    DescriptionFile written = file.value();
    const auto state = state_of_file(written.path);
    if (state) written.state = *state;
    if (state && control::make_state_folder())
      std::ofstream(record_path(subsystem), std::ios::binary) << own_record(written);
  }
  if (call.json) return {json_line({{"file", file->path}, {"changed", is_new}, {"operator", values}}), "", kOk};
  return {file->path + (is_new ? ": written\n" : ": has these values already\n"), "", kOk};
}

}  // namespace chimera::cli
