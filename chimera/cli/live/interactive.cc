// SPDX-License-Identifier: Apache-2.0
// Reads commands from the terminal with history and completion, or from a script, and carries them out.
#include "chimera/cli/live/interactive.h"

#include <histedit.h>

#include <cerrno>
#include <clocale>
#include <csignal>
#include <cstring>
#include <iostream>
#include <memory>
#include <sstream>

#include "chimera/base/hosted/ordinary_file.h"
#include "chimera/base/hosted/terminal_text.h"
#include "chimera/cli/live/commands.h"
#include "chimera/cli/live/terminal.h"
#include "chimera/cli/live/words.h"
#include "chimera/cli/print/fields.h"
#include "chimera/control/state_folder.h"
#include "chimera/text/json.h"

namespace chimera::cli {
namespace {

constexpr std::size_t kMostScriptBytes = 1 << 20;

struct LineResult {
  int code = kOk;
  bool is_quit = false;
};

/// One line, wherever it comes from.
LineResult carry_out_line(Session& session, std::string_view line, std::FILE* out, std::FILE* err) {
  const auto words = words_of(line);
  if (!words) return {print(refused(words.error(), false, kUsage), out, err)};
  if (words.value().empty()) return {};
  const CallReading reading = read_call(shell_words(), words.value(), "");
  const Call& call = reading.call;
  if (!reading.fault.empty()) return {print({"", reading.fault, kUsage}, out, err)};
  if (reading.is_help) return {print({help_text(shell_words(), call.command, ""), "", kOk}, out, err)};
  if (call.command == &quit_words()) return {kOk, true};
  if (call.command != &help_words()) return {carry_out(session, call, out, err)};
  const std::string asked = call.operand(0);
  const Command* about = command_named(shell_words(), asked);
  if (about == nullptr && !asked.empty())
    return {print({"", "no command '" + asked + "'; `help` lists them\n", kUsage}, out, err)};
  return {print({help_text(shell_words(), about, ""), "", kOk}, out, err)};
}

/// The line editor with its history and completion. One at a time.
class Editor {
 public:
  Editor(const std::string& subsystem, Names names) : prompt_(subsystem + "> "), names_(std::move(names)) {
    std::setlocale(LC_CTYPE, "");
    edit_.reset(::el_init("chimera", stdin, stdout, stderr));
    history_.reset(::history_init());
    HistEvent event{};
    ::history(history_.get(), &event, H_SETSIZE, 1000);
    ::history(history_.get(), &event, H_SETUNIQUE, 1);
    if (control::make_state_folder()) file_ = control::state_folder() + "/history";
    if (!file_.empty()) ::history(history_.get(), &event, H_LOAD, file_.c_str());
    ::el_set(edit_.get(), EL_CLIENTDATA, this);
    ::el_set(edit_.get(), EL_PROMPT, &Editor::prompt);
    ::el_set(edit_.get(), EL_EDITOR, "emacs");
    // Ctrl-C at the prompt is a key that gives up the line; while a command runs it is the signal it always was.
    ::el_set(edit_.get(), EL_SETTY, "-d", "-isig", nullptr);
    ::el_set(edit_.get(), EL_HIST, ::history, history_.get());
    ::el_set(edit_.get(), EL_ADDFN, "complete", "complete a name", &Editor::complete);
    ::el_set(edit_.get(), EL_BIND, "^I", "complete", nullptr);
    ::el_set(edit_.get(), EL_ADDFN, "give-up", "give up the line", &Editor::give_up);
    ::el_set(edit_.get(), EL_BIND, "^C", "give-up", nullptr);
    ::el_set(edit_.get(), EL_BIND, "^R", "em-inc-search-prev", nullptr);
  }
  Editor(const Editor&) = delete;
  Editor& operator=(const Editor&) = delete;

  /// False at the end of the input. A line that was given up is empty.
  bool read(std::string& line) {
    int length = 0;
    is_given_up_ = false;
    const char* typed = ::el_gets(edit_.get(), &length);
    line.clear();
    if (typed == nullptr || length <= 0) {
      std::fputc('\n', stdout);
      return false;
    }
    if (is_given_up_) return true;
    line.assign(typed, static_cast<std::size_t>(length));
    HistEvent event{};
    if (line.find_first_not_of(" \t\n") != std::string::npos) {
      ::history(history_.get(), &event, H_ENTER, line.c_str());
      if (!file_.empty()) ::history(history_.get(), &event, H_SAVE, file_.c_str());
    }
    while (!line.empty() && line.back() == '\n') line.pop_back();
    return true;
  }

 private:
  struct End {
    void operator()(EditLine* edit) const { ::el_end(edit); }
    void operator()(History* history) const { ::history_end(history); }
  };

  static Editor& of(EditLine* edit) {
    void* self = nullptr;
    ::el_get(edit, EL_CLIENTDATA, &self);
    return *static_cast<Editor*>(self);
  }
  static char* prompt(EditLine* edit) { return of(edit).prompt_.data(); }
  static unsigned char complete(EditLine* edit, int) {
    const LineInfo* line = ::el_line(edit);
    const std::string before(line->buffer, static_cast<std::size_t>(line->cursor - line->buffer));
    const std::vector<std::string> words = completions(shell_words(), before, of(edit).names_);
    if (words.empty()) return CC_ERROR;
    const std::size_t typed = before.size() - (before.find_last_of(" \t") + 1);  // npos + 1 is 0
    std::string more = shared_beginning(words).substr(typed);
    if (words.size() == 1) more += ' ';
    if (!more.empty()) return ::el_insertstr(edit, more.c_str()) == 0 ? CC_REFRESH : CC_ERROR;
    std::fputc('\n', stdout);
    for (const std::string& word : words) std::printf("%s  ", word.c_str());
    std::fputc('\n', stdout);
    return CC_REDISPLAY;
  }

  static unsigned char give_up(EditLine* edit, int) {
    of(edit).is_given_up_ = true;
    std::fputs("^C\n", stdout);
    return CC_NEWLINE;
  }

  std::string prompt_, file_;
  bool is_given_up_ = false;
  Names names_;
  std::unique_ptr<EditLine, End> edit_;
  std::unique_ptr<History, End> history_;
};

int typed(Session& session) {
  const control::RpcResponse hello = session.ask("hello"), described = session.ask("describe");
  if (!hello.is_good()) return print(refused(hello, false), stdout, stderr);
  Editor editor(text_of(*hello.result, "subsystem"), described.is_good() ? names_of(*described.result) : Names{});
  for (std::string line;;) {
    // The editor takes Ctrl-C as a key, but for the moments in which it sets the terminal up.
    std::signal(SIGINT, SIG_IGN);
    const bool is_there = editor.read(line);
    std::signal(SIGINT, SIG_DFL);
    if (!is_there) return kOk;
    if (carry_out_line(session, line, stdout, stderr).is_quit) return kOk;
  }
}

}  // namespace

int run_script(Session& session, std::istream& script, const std::string& name, bool keeps_going, std::FILE* out,
               std::FILE* err) {
  int code = kOk, number = 0;
  for (std::string line; std::getline(script, line);) {
    ++number;
    const LineResult outcome = carry_out_line(session, line, out, err);
    if (outcome.is_quit) break;
    if (outcome.code == kOk) continue;
    if (code == kOk) code = outcome.code;
    std::fprintf(err, "%s:%d: refused: %s\n", name.c_str(), number, plain_line(line).c_str());
    if (!keeps_going) break;
  }
  return code;
}

int interactive(const Surroundings& surroundings, const std::string& script, bool keeps_going) {
  const bool is_file = !script.empty() && script != "-";
  const auto text = is_file ? read_ordinary(script, kMostScriptBytes) : Result<std::string>(std::string());
  if (!text) return print(refused(text.error(), false), stdout, stderr);
  std::istringstream file(*text);
  Surroundings known = surroundings;
  known.command = "chimera shell" + (script.empty() ? "" : " " + script) + (keeps_going ? " --keep-going" : "");
  auto session = Session::open(known);
  if (!session) return print(refused(session.error(), false), stdout, stderr);
  if (is_file) return run_script(*session, file, script, keeps_going, stdout, stderr);
  if (script == "-" || !is_terminal(kStandardInput))
    return run_script(*session, std::cin, "-", keeps_going, stdout, stderr);
  return typed(*session);
}

}  // namespace chimera::cli
