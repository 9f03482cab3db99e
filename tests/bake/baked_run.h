// SPDX-License-Identifier: Apache-2.0
// For tests: runs baked tables on this machine with the components of the build tree.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "chimera/catalogue/workplace.h"
#include "chimera/cli/run/digest_text.h"
#include "chimera/load/shared_object.h"
#include "chimera/runtime/hosted/heap_memory.h"
#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/record/digest.h"
#include "chimera/runtime/virtual/virtual_executor.h"

namespace chimera {

inline const Library& built_library() {
  static const Result<Library> kLibrary =
      Workplace::around(std::string(std::getenv("CHIMERA_BUILD")) + "/bin/chimera").library();
  EXPECT_TRUE(kLibrary);
  return *kLibrary;
}

/// The digest of the application, whose jobs take no time. `replaced`: object files in place of those of the library.
inline std::string digest_of(const ApplicationSpec& spec, std::span<const ScriptAct> acts, Nanoseconds duration,
                             const std::map<std::string, std::string>& replaced = {}) {
  std::vector<const chimera_component*> components;
  std::map<std::string, SharedObject> opened;
  for (const TaskSpec& task : spec.tasks) {
    const std::string name(task.component);
    const LibraryEntry* const entry = built_library().find(name);
    EXPECT_NE(entry, nullptr) << name;
    if (entry == nullptr) return {};
    auto object = SharedObject::open(replaced.contains(name) ? replaced.at(name) : entry->object_file);
    EXPECT_TRUE(object) << object.error().message.c_str();
    if (!object) return {};
    components.push_back(*opened.emplace(name, *std::move(object)).first->second.component(name));
  }
  auto set = HeapTaskSet::create(spec, components);
  EXPECT_TRUE(set) << set.error().message.c_str();
  if (!set) return {};
  HeapMemory memory;
  cli::DigestText text;
  Digest digest(spec.tasks.size(), text, memory);
  RunOptions options;
  options.script = Script(acts);
  options.digest = &digest;
  VirtualOptions how;
  how.times = JobTimes::none();
  VirtualExecutor executor(**set, options, how);
  EXPECT_TRUE(executor.start());
  executor.run(duration);
  digest.end();
  executor.shut_down();
  return text.text(spec);
}

}  // namespace chimera
