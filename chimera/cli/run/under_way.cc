// SPDX-License-Identifier: Apache-2.0
// Writes into shared memory which component is being loaded or which method runs.
#include "chimera/cli/run/under_way.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <new>

#include "chimera/runtime/hosted/making_text.h"
#include "chimera/runtime/making.h"
#include "chimera/runtime/task_word.h"
#include "chimera/task/signal.h"
#include "chimera/text/not_off.h"

namespace chimera::cli {
namespace {

UnderWay unread;
UnderWay* written = &unread;

template <std::size_t N>
void put(char (&to)[N], const std::string& text) {
  const std::size_t n = std::min(text.size(), N - 1);
  std::memcpy(to, text.data(), n);
  to[n] = '\0';
}

template <std::size_t N>
std::string got(const char (&from)[N]) {
  return {from, ::strnlen(from, N)};
}

}  // namespace

void UnderWay::know(const Configuration& configuration, const Library& library) {
  n_tasks = 0;
  for (const ConfiguredTask& task : configuration.tasks()) {
    if (n_tasks == kMostTasks) return;
    const LibraryEntry* entry = library.find(task.component);
    put(tasks[n_tasks].name, task.name);
    put(tasks[n_tasks++].object, entry == nullptr ? task.component : entry->object_file);
  }
}

std::string UnderWay::text() const {
  if (has_returned) return "at its end";
  const std::size_t n = std::min<std::size_t>(n_tasks, kMostTasks);
  if (const std::uint32_t task = task_of_making(making, n); task < n)
    return making_text(making, got(tasks[task].name), got(tasks[task].object));
  const Method runs = method();
  return runs.task.empty() ? "" : "in " + runs.task + "." + runs.name;
}

UnderWay::Method UnderWay::method() const {
  const std::size_t n = std::min<std::size_t>(n_tasks, kMostTasks);
  for (const std::uint32_t word : {running.load(), serving.load()}) {
    const TaskWord found = TaskWord::found(word);
    if (found.task().index >= n || !found.has_method()) continue;
    return {got(tasks[found.task().index].name), method_name(found.method()), chimera::turns_off(found.method())};
  }
  return {};
}

UnderWay& under_way() noexcept { return *written; }
void write_under_way_to(UnderWay& place) noexcept { written = &place; }

UnderWay* make_shared_under_way() noexcept {
  void* place = ::mmap(nullptr, sizeof(UnderWay), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  return place == MAP_FAILED ? nullptr : new (place) UnderWay;
}

void release(UnderWay* place) noexcept {
  if (place != nullptr) ::munmap(place, sizeof(UnderWay));
}

}  // namespace chimera::cli
