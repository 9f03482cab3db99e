// SPDX-License-Identifier: Apache-2.0
// Prints the memory of an image by task, and the cost of its numbers of double precision.
#include "chimera/cli/batch/bake_text.h"

#include "chimera/base/hosted/wording.h"
#include "chimera/cli/print/columns.h"
#include "chimera/text/time_text.h"

namespace chimera::cli {
namespace {

std::string kib(std::size_t bytes) { return formatted("%.1f KiB", static_cast<double>(bytes) / 1024); }

/// Instructions for one product and one sum with each number of type float64.
std::size_t double_instructions(const bake::TaskMemoryNeed& need) {
  return (need.float64_in + need.float64_out) * (bake::kDoubleAdd + bake::kDoubleMultiply);
}

Nanoseconds time_of(std::size_t instructions, const bake::Target& target) {
  const std::size_t cycles = instructions * bake::kCyclesPerInstruction;
  return {static_cast<std::int64_t>(cycles) * 1'000'000'000 / target.clock_hz};
}

std::vector<std::string> used(const bake::BakeResult& result) {
  std::vector<std::string> names;
  for (const bake::Mechanism& each : result.mechanisms)
    if (each.is_used) names.emplace_back(each.name);
  return names;
}

}  // namespace

std::string bake_text(const Configuration& configuration, const bake::Target& target, const bake::BakeResult& result) {
  Columns table({"task", ">period", ">flash B", ">RAM B", ">float64 in", ">out", ">instructions", ">time"});
  for (std::size_t t = 0; t < result.memory.tasks.size(); ++t) {
    const bake::TaskMemoryNeed& need = result.memory.tasks[t];
    const std::size_t instructions = double_instructions(need);
    table.add({configuration.tasks()[t].name, time_text(configuration.spec().tasks[t].period),
               std::to_string(need.flash_bytes), std::to_string(need.ram_bytes), std::to_string(need.float64_in),
               std::to_string(need.float64_out), std::to_string(instructions),
               time_text(time_of(instructions, target))});
  }
  return table.text() + "instructions, time: one product and one sum with each float64, which " + target.cpu +
         " computes in software\n" +
         "(an addition " + std::to_string(bake::kDoubleAdd) + ", a product " + std::to_string(bake::kDoubleMultiply) +
         ", a quotient " + std::to_string(bake::kDoubleDivide) + ", a comparison " +
         std::to_string(bake::kDoubleCompare) +
         " instructions)\n" + "flash: tables " + kib(result.memory.flash_bytes()) + " of " + kib(target.flash.bytes) +
         "\nRAM: at least " + kib(result.memory.ram_bytes()) + " of " + kib(target.ram.bytes) + ", with stacks of " +
         kib(target.stack_bytes) + " and " + kib(target.handler_stack_bytes) + ", and records of " +
         std::to_string(result.memory.record_bytes) + " B for each task" +
         "\nCode and the other members of components: known to the compiler of the target.\nparts of the runtime: " +
         join(used(result), " ") + "\n";
}

Json bake_json(const Configuration& configuration, const bake::Target& target, const bake::BakeResult& result) {
  Json tasks = Json::array();
  for (std::size_t t = 0; t < result.memory.tasks.size(); ++t) {
    const bake::TaskMemoryNeed& need = result.memory.tasks[t];
    Json task = Json::object();
    task["name"] = configuration.tasks()[t].name;
    task["flash_bytes"] = need.flash_bytes;
    task["ram_bytes"] = need.ram_bytes;
    task["float64_in"] = need.float64_in;
    task["float64_out"] = need.float64_out;
    task["double_instructions"] = double_instructions(need);
    tasks.push_back(std::move(task));
  }
  Json files = Json::array();
  for (const bake::BakedFile& file : result.files) files.push_back(file.name);
  Json all = Json::object();
  all["baked"] = result.is_baked();
  all["subsystem"] = configuration.subsystem();
  all["target"] = target.name;
  all["files"] = std::move(files);
  all["tasks"] = std::move(tasks);
  all["flash_bytes"] = result.memory.flash_bytes();
  all["flash_limit_bytes"] = target.flash.bytes;
  all["ram_bytes"] = result.memory.ram_bytes();
  all["ram_limit_bytes"] = target.ram.bytes;
  all["stack_bytes"] = result.memory.stack_bytes;
  all["mechanisms"] = Json(used(result));
  all["notes"] = Json(result.notes);
  all["description_faults"] = Json::parse(result.description.json());
  all["target_faults"] = Json::parse(result.target.json());
  return all;
}

}  // namespace chimera::cli
