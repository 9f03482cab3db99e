// SPDX-License-Identifier: Apache-2.0
// The `chimera` command: reads the command line by the table of commands and carries out the row that was called.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <system_error>

#include "apps/chimera/commands.h"
#include "apps/chimera/option_values.h"
#include "chimera/base/hosted/terminal_text.h"
#include "chimera/cli/files/file_refusal.h"
#include "chimera/platform/realtime.h"
#include "chimera/platform/standard_streams.h"

namespace {

using namespace chimera;  // NOLINT: a main() of this project

std::terminate_handler tell_defect = nullptr;  // of the C++ library: says what was thrown, and leaves a core

bool memory_is_limited() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

/// The last words of a program that gets no memory, or no thread. Under a limit there may be no memory for an exception
/// either. Without a limit the cause is a defect, such as a thread of a component that was never joined.
[[noreturn]] void give_up() {
  const char* why = "out of memory: Cannot allocate memory";
  if (!std::current_exception() && !memory_is_limited()) tell_defect();
  try {
    if (std::current_exception()) throw;
  } catch (const std::filesystem::filesystem_error& error) {
    std::fprintf(stderr, "chimera: %s: %s\n", for_terminal(error.path1().string()).c_str(),
                 error.code().message().c_str());
    ::_exit(cli::kRefused);
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::resource_unavailable_try_again) tell_defect();
    why = "no thread can be started: Resource temporarily unavailable";
  } catch (const std::bad_alloc&) {
  } catch (...) {
    tell_defect();
  }
  std::fprintf(stderr, "chimera: %s\n", why);
  ::_exit(cli::kRefused);
}

std::string help_of_program(const std::string& documents) {
  return "Real-time control software assembled from components: check it, run it, look at it.\n"
         "Usage: chimera [OPTIONS] COMMAND\n\n"
         "Options:\n"
         "  -h,--help                   Print this help and exit\n"
         "  --version                   Print the version and exit\n"
         "  --json                      as behind a command that has it\n"
         "  --subsystem NAME            as behind a command on a running subsystem\n\n"
         "Commands:\n" +
         cli::help_text(all_commands(), nullptr, "chimera") +
         "\n`chimera COMMAND --help` has an example. Documents and examples: " + documents + "\n";
}

int run_program(int argc, char** argv) {
  const Workplace workplace = Workplace::around(program_path());
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  const cli::CallReading reading = cli::read_call(all_commands(), words, "chimera");
  const cli::Command* command = reading.call.command;
  if (!reading.fault.empty()) return print({"", reading.fault, cli::kUsage});
  if (reading.is_help && command == nullptr) return print({help_of_program(workplace.documents), "", cli::kOk});
  if (reading.is_help) return print({cli::help_text(all_commands(), command, "chimera"), "", cli::kOk});
  if (command->outlives_reader) std::signal(SIGPIPE, SIG_IGN);  // seen as a failed write
  return carry_out(reading.call, workplace);
}

}  // namespace

int main(int argc, char** argv) {
  hold_standard_streams();
  if (const auto may = may_run_here(); !may) {
    std::fputs(cli::error_line(may.error()).c_str(), stderr);
    return cli::kRefused;
  }
  tell_defect = std::set_terminate(give_up);
  return report_lost_output(run_program(argc, argv));
}
