// SPDX-License-Identifier: Apache-2.0
// Starts tools/firmware/board.py for each board: it builds the image, and starts it in QEMU.
#include "apps/chimera/board_images.h"

#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "chimera/cli/files/boards.h"
#include "chimera/platform/descriptor.h"

namespace {

using namespace chimera;  // NOLINT: a part of a main()

constexpr Nanoseconds kLongestBuild = seconds(900);

Result<Process> flash_board(const cli::RunPlan& plan, const std::string& file, const Workplace& workplace,
                            const std::string& rtpu) {
  const std::string script = workplace.documents + "/tools/firmware/board.py";
  if (!std::filesystem::exists(script))
    return Error{ErrorCode::kRefused, {"--flash needs the sources of Chimera: there is no " + script}, {}};
  const std::string out = "build/boards/" + plan.configuration.subsystem() + "." + rtpu;
  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (error) return Error{ErrorCode::kSystem, {out + " cannot be made: " + error.message()}, {}};
  auto said = Pipe::open();
  if (!said) return said.error();
  const std::string program = program_path();
  const char* const words[] = {"python3", script.c_str(), program.c_str(), file.c_str(),
                               rtpu.c_str(), out.c_str(), "start"};
  std::printf("building %s/image.elf\n", out.c_str());
  std::fflush(stdout);
  ChildPlace place;
  place.output = said->writing.fd;
  place.error = STDERR_FILENO;
  auto started = Process::start_apart("/usr/bin/python3", words, place);
  if (!started) return started.error();
  said->writing = OwnedDescriptor();
  if (said->first_line(kLongestBuild) == "started") return started;
  return Error{ErrorCode::kRefused, {"the image of rtpu '" + rtpu + "' was not built or not started"}, {file}};
}

}  // namespace

Result<std::vector<Process>> take_boards(const cli::RunPlan& plan, const std::string& file, const Workplace& workplace,
                                         bool flash) {
  std::vector<Process> held;
  const cli::Boards boards = cli::judge_boards(plan.configuration, plan.library, workplace);
  if (!boards.faults.is_legal()) {
    std::fputs(boards.faults.text().c_str(), stderr);
    return Error{ErrorCode::kRefused, {"a board cannot run its part of the description"}, {file}};
  }
  if (flash && boards.images.empty())
    return Error{ErrorCode::kRefused, {"--flash: no rtpu has 'target' and 'link'"}, {file}};
  for (const cli::BoardImage& board : boards.images) {
    if (!flash) continue;
    auto started = flash_board(plan, file, workplace, std::string(plan.configuration.rtpus()[board.rtpu.index].name));
    if (!started) return started.error();
    held.push_back(*std::move(started));
  }
  return held;
}
