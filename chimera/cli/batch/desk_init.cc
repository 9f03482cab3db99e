// SPDX-License-Identifier: Apache-2.0
// Loads the components of an image and initialises its tasks in a child, which says what they refuse.
#include "chimera/cli/batch/desk_init.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/run/own_process.h"
#include "chimera/cli/run/under_way.h"
#include "chimera/load/shared_object.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/making.h"
#include "chimera/runtime/virtual/virtual_executor.h"

namespace chimera::cli {
namespace {

/// Each line is a mark and a sentence. A file, because the process that writes it may end at any time.
class Lines {
 public:
  static constexpr char kRefusal = '-', kUntried = '?';

  Lines() : file_(std::tmpfile()) {}
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;
  ~Lines() {
    if (file_ != nullptr) std::fclose(file_);
  }
  void add(char mark, std::string text) {
    if (file_ == nullptr) return;
    std::ranges::replace(text, '\n', ' ');
    std::fprintf(file_, "%c%s\n", mark, text.c_str());
    std::fflush(file_);
  }
  DeskInit read() {
    DeskInit found;
    if (file_ == nullptr) return found;
    std::rewind(file_);
    std::string line;
    for (int c; (c = std::fgetc(file_)) != EOF;) {
      if (c != '\n') {
        line += static_cast<char>(c);
        continue;
      }
      if (!line.empty()) (line[0] == kUntried ? found.untried : found.refusals).push_back(line.substr(1));
      line.clear();
    }
    return found;
  }

 private:
  std::FILE* file_;
};

bool needs_the_board(const ConfiguredTask& task) {
  for (const ConfiguredPort& port : task.ports)
    if (port.kind == CHIMERA_RESOURCE && bake::is_of_board(bake::declared_name(port))) return true;
  return false;
}

class Inits {
 public:
  Inits(const bake::BakedApplication& application, const Library& library, Lines& lines)
      : application_(application), library_(library), lines_(lines), is_left_out_(application.spec().tasks.size()) {}

  void run() {
    UnderWay& told = under_way();
    told.know(application_.configuration(), library_);
    if (!open_all(told)) return;
    ContextPlace place;
    place.running = &told.running;
    place.serving = &told.serving;
    place.making = &told.making;
    show_made(told.making);
    const auto made = HeapTaskSet::create(application_.spec(), components_, place);
    if (!made) return lines_.add(Lines::kRefusal, made.error().message.c_str());
    VirtualExecutor executor(**made, {}, {});
    for (const TaskId id : application_.spec().init_order) init(**made, id);
    executor.shut_down();
  }

 private:
  bool open_all(UnderWay& told) {
    for (const TaskSpec& task : application_.spec().tasks) {
      show_making(told.making, components_.size(), Making::kLoads);
      const LibraryEntry* const entry = library_.find(task.component);
      auto found = opened_.find(entry->object_file);
      if (found == opened_.end()) {
        auto object = SharedObject::open(entry->object_file);
        if (!object) return lines_.add(Lines::kRefusal, object.error().message.c_str()), false;
        found = opened_.emplace(entry->object_file, *std::move(object)).first;
      }
      const auto component = found->second.matching(entry->descriptor);
      if (!component) return lines_.add(Lines::kRefusal, component.error().message.c_str()), false;
      components_.push_back(*component);
    }
    return true;
  }

  bool lacks_a_constant(TaskId id) const {
    for (std::size_t t = 0; t < is_left_out_.size(); ++t)
      if (is_left_out_[t] && application_.spec().uses_constant_of(id, TaskId(t))) return true;
    return false;
  }

  void init(TaskSet& set, TaskId id) {
    const ConfiguredTask& task = application_.configuration().tasks()[id.index];
    const bool is_of_board = needs_the_board(task);
    if (is_of_board || lacks_a_constant(id)) {
      is_left_out_[id.index] = true;
      return lines_.add(Lines::kUntried, task.name);
    }
    const SignalReport report = set.life().signal({&id, 1}, Signal::kSpawn, {});
    if (report && set.tasks()[id.index].state == State::kOff) return;
    if (!report && report.why != Refusal::kFault) return;  // a rival has the resource
    is_left_out_[id.index] = true;
    lines_.add(Lines::kRefusal,
               "task " + in_quotes(task.name) + ": 'init' refuses: " + set.tasks()[id.index].faults.last.text);
  }

  const bake::BakedApplication& application_;
  const Library& library_;
  Lines& lines_;
  std::vector<bool> is_left_out_;
  std::map<std::string, SharedObject> opened_;
  std::vector<const chimera_component*> components_;
};

}  // namespace

DeskInit init_at_desk(const bake::BakedApplication& application, const Library& library) {
  Lines lines;
  std::string died;
  (void)in_own_process([&] { return Inits(application, library, lines).run(), 0; },
                       [&](const BrokenRun& broken) { return died = broken.text, 0; });
  DeskInit found = lines.read();
  if (!died.empty()) found.refusals.push_back("'init' at the desk: " + died);
  return found;
}

}  // namespace chimera::cli
