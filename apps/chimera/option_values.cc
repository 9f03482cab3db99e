// SPDX-License-Identifier: Apache-2.0
// Reads the values of options that several commands share.
#include "apps/chimera/option_values.h"

#include <csignal>
#include <cstdio>

#include "chimera/cli/run/run.h"
#include "chimera/units/quantity.h"

using namespace chimera;  // NOLINT: a part of a main()

cli::Option set_option(const char* manual) {
  return {.name = "--set",
          .value = "VAR VALUE",
          .help =
              "this value instead of the file's; VAR is an operator variable, a constant, or TASK.CONSTANT; may be "
              "repeated",
          .manual = manual,
          .repeats = cli::Option::Repeats::kOneEach};
}

std::vector<Setting> settings_of(const cli::Call& call) {
  const std::vector<std::string> words = call.values("--set");
  std::vector<Setting> settings;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2)
    settings.push_back({words[i], words[i + 1], "--set " + words[i] + " '" + words[i + 1] + "'"});
  return settings;
}

bool read_duration(const cli::Call& call, const char* option, Nanoseconds& to) {
  const std::string text = call.value(option);
  if (text.empty()) return true;
  const auto value = parse_duration(text);
  if (value && value->count > 0) return to = *value, true;
  std::fprintf(stderr, "%s: %s\n", option, value ? "must be longer than 0" : value.error().message.c_str());
  return false;
}

int print(const cli::CommandResult& result) { return cli::print(result, stdout, stderr); }

void stop_run_at_signals() {
  std::signal(SIGINT, [](int) { cli::request_stop(); });
  std::signal(SIGTERM, [](int) { cli::request_stop(); });
}
