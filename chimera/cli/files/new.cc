// SPDX-License-Identifier: Apache-2.0
// Copies a template and fills in names.
#include "chimera/cli/files/new.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "chimera/base/hosted/wording.h"
#include "chimera/base/message.h"
#include "chimera/load/descriptor.h"

namespace chimera::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 40;

/// The values of @NAME@ and the other marks of the templates.
struct Filling {
  std::string name, type, package, program, schema, firmware;
};

struct NewFile {
  std::string path, text;
  bool is_program = false;
};

/// "low_pass" -> "LowPass"
std::string type_of(const std::string& name) {
  std::string type;
  bool is_start = true;
  for (const char c : name) {
    if (c != '_') type += is_start && c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    is_start = c == '_';
  }
  return type;
}

void replace(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// The text without the licence line: a new file belongs to the user who makes it.
std::string without_licence(const std::string& text) {
  std::string kept;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.find("SPDX-License-Identifier") == std::string::npos) kept += line + "\n";
  return kept;
}

std::string template_name(NewKind kind) {
  switch (kind) {
    case NewKind::kComponent: return "component";
    case NewKind::kComponentInC: return "component_c";
    case NewKind::kHardwareComponent: return "component_hardware";
    case NewKind::kFirmware: return "firmware";
    case NewKind::kApplication: break;
  }
  return "app";
}

/// A folder of the installation, or `in_checkout` of the checkout around a build tree (build/PRESET).
Result<fs::path> folder_of(const fs::path& prefix, const char* what, const fs::path& place,
                           const fs::path& in_checkout) {
  for (const fs::path& folder : {prefix / place, prefix.parent_path().parent_path() / in_checkout})
    if (fs::is_directory(folder)) return folder;
  return (Message() << "there are no " << what << ": no " << place.string()
                    << "; the Debian package chimera-dev has them")
      .error(ErrorCode::kNotFound, prefix.string());
}
Result<fs::path> template_folder(const fs::path& prefix, NewKind kind) {
  const fs::path place = fs::path("share/chimera/templates") / template_name(kind);
  return folder_of(prefix, "templates", place, place);
}
/// The programs that make an image.
Result<fs::path> firmware_tools(const fs::path& prefix) {
  return folder_of(prefix, "sources of images", "share/chimera/tools/firmware", "tools/firmware");
}

/// The file by which editors complete and check a description, or "": none is installed.
std::string schema(const fs::path& prefix) {
  for (const fs::path& file : {prefix / "share/chimera/schema/description.schema.json",
                               prefix.parent_path().parent_path() / "docs/formats/description.schema.json"})
    if (fs::exists(file)) return file.string();
  return "";
}

NewFile fill_in(const fs::path& file, const Filling& words) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  NewFile made{file.filename().string(), without_licence(text.str()), file.extension() == ".sh"};
  if (made.path.starts_with("NAME")) made.path.replace(0, 4, words.name);
  replace(made.text, "@NAME@", words.name);
  replace(made.text, "@TYPE@", words.type);
  replace(made.text, "@PACKAGE@", words.package);
  replace(made.text, "@PROGRAM@", words.program);
  replace(made.text, "@FIRMWARE@", words.firmware);
  if (words.schema.empty() && made.text.starts_with("# yaml-language-server"))
    made.text.erase(0, made.text.find('\n') + 1);
  replace(made.text, "@SCHEMA@", words.schema);
  return made;
}

Result<void> check(const NewRequest& request) {
  if (!is_identifier(request.name) || request.name.size() > kLongestName) {
    return (Message() << "\"" << request.name << "\" is no legal name: [a-z][a-z0-9_]*, at most " << kLongestName
                      << " letters")
        .error(ErrorCode::kBadInput);
  }
  if (!fs::is_directory(request.parent))
    return (Message() << "there is no such folder").error(ErrorCode::kNotFound, request.parent);
  const fs::path folder = (fs::path(request.parent) / request.name).lexically_normal();
  if (fs::exists(fs::symlink_status(folder)))
    return (Message() << "exists already: nothing is overwritten").error(ErrorCode::kRefused, folder.string());
  return {};
}

std::string next_steps(const fs::path& folder, const std::string& package, const std::vector<NewFile>& files,
                       NewKind kind) {
  std::string text = "made " + folder.string() + ":";
  for (const NewFile& file : files) text += " " + file.path;
  text += "\nnext:\n  cd " + folder.string();
  if (kind == NewKind::kFirmware) return text + "\n  ./run.sh\n";
  return text + "\n  cmake -B build -Dchimera_DIR=" + package +
         "\n  cmake --build build\n  ctest --test-dir build --output-on-failure\n" +
         (kind == NewKind::kApplication ? "  ./run.sh --virtual\n" : "");
}

Result<std::string> make(const NewRequest& request, const fs::path& program) {
  if (const auto legal = check(request); !legal) return legal.error();
  const fs::path prefix = fs::absolute(program).parent_path().parent_path();
  const auto templates = template_folder(prefix, request.kind);
  if (!templates) return templates.error();
  Filling words{request.name, type_of(request.name), shell_word((prefix / "lib/cmake/chimera").string()),
                shell_word(fs::absolute(program).string()), schema(prefix), ""};
  if (request.kind == NewKind::kFirmware) {
    const auto tools = firmware_tools(prefix);
    if (!tools) return tools.error();
    words.firmware = shell_word(tools->string());
  }
  std::vector<fs::path> sources;
  for (const auto& entry : fs::directory_iterator(*templates)) sources.push_back(entry.path());
  std::sort(sources.begin(), sources.end());
  std::vector<NewFile> files;
  files.reserve(sources.size());
  for (const fs::path& source : sources) files.push_back(fill_in(source, words));

  const fs::path folder = (fs::path(request.parent) / request.name).lexically_normal();
  std::error_code failed;
  if (!fs::create_directory(folder, failed)) {
    const std::string why = failed.message(), parent = fs::absolute(request.parent).lexically_normal().string();
    return (Message() << "cannot be made in " << parent << ": " << why << ". Go to a folder that you may write in.")
        .error(ErrorCode::kSystem, folder.string());
  }
  for (const NewFile& file : files) {
    std::ofstream out(folder / file.path, std::ios::binary);
    out << file.text;
    out.close();
    if (!out) return (Message() << "cannot be written").error(ErrorCode::kSystem, (folder / file.path).string());
    if (file.is_program) fs::permissions(folder / file.path, fs::perms::owner_exec, fs::perm_options::add);
  }
  return next_steps(folder, words.package, files, request.kind);
}

}  // namespace

CommandResult new_project(const NewRequest& request, const std::string& program) {
  try {
    auto made = make(request, program);
    if (!made) return file_refusal(made.error(), false);
    return {*std::move(made), "", kOk};
  } catch (const fs::filesystem_error& error) {
    const std::string why = error.code().message();
    return file_refusal((Message() << why).error(ErrorCode::kSystem, error.path1().string()), false);
  }
}

}  // namespace chimera::cli
