// SPDX-License-Identifier: Apache-2.0
// Opens the shared objects of an rtpu's tasks and compares each with its descriptor.
#include "chimera/rtpu/components.h"

#include <map>
#include <string>

#include "chimera/load/descriptor.h"
#include "chimera/runtime/task_word.h"
#include "chimera/runtime/making.h"

namespace chimera {
namespace {

Result<const chimera_component*> verified(const SharedObject& object, const TaskSpec& task,
                                          const ComponentPlace& place) {
  auto component = object.component(task.component);
  if (!component) return component.error();
  const auto descriptor = describe(**component);
  if (!descriptor) return descriptor.error();
  if (fingerprint(*descriptor) == place.fingerprint) return component;
  return Error{ErrorCode::kRefused,
               {"component " + std::string(task.component) + " was rebuilt after it was verified; run again"},
               {place.object_file}};
}

}  // namespace

Result<std::vector<const chimera_component*>> load_components(const ApplicationImage& image,
                                                              const SealedObjects& objects, RtpuId rtpu,
                                                              std::atomic<std::uint32_t>& serving,
                                                              std::atomic<std::uint32_t>& making) {
  const auto tasks = image.spec().tasks;
  std::vector<const chimera_component*> components(tasks.size());
  std::map<std::string_view, SharedObject> opened;
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    if (tasks[t].rtpu != rtpu) continue;
    const ComponentPlace& place = image.places()[t];
    serving.store(TaskWord(TaskId(t), TaskWord::kOpening).word(), std::memory_order_release);
    show_making(making, t, Making::kLoads);
    auto found = opened.find(place.object_file);
    if (found == opened.end()) {
      auto object = objects.link(std::string(place.object_file));
      if (!object) return object.error();
      found = opened.emplace(place.object_file, *std::move(object)).first;
    }
    auto component = verified(found->second, tasks[t], place);
    if (!component) return component.error();
    components[t] = *component;
  }
  serving.store(0, std::memory_order_release);
  show_made(making);
  return components;
}

}  // namespace chimera
