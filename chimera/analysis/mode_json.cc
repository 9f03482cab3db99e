// SPDX-License-Identifier: Apache-2.0
// Writes the configurations of a description and the switches between them as JSON.

#include "chimera/analysis/mode_report.h"
#include "chimera/text/json.h"

namespace chimera {
namespace {

Json time_json(Nanoseconds time) { return time == kNever ? Json() : Json(time.count); }

const char* cause_word(ModeCause cause) {
  constexpr const char* kWords[] = {"on_miss", "on_overrun", "on_fault", "constant"};
  return kWords[static_cast<std::size_t>(cause)];
}

Json json_of(const Configuration& configuration, const CpuTransition& cpu) {
  const bool is_well = cpu.guarantee == Guarantee::kYes;
  return {{"cpu", cpu.cpu},
          {"schedulable", schedulable_word(cpu.guarantee)},
          {"task", is_well ? Json() : Json(configuration.tasks()[cpu.task.index].name)},
          {"takes_ns", cpu.is_lost() ? time_json(cpu.takes) : Json()},
          {"settled_ns", time_json(cpu.settled)},
          {"promised_before", cpu.was_promised}};
}

const char* way_word(ModeWay way) {
  constexpr const char* kWords[] = {"fast", "slow-unless-same", "slow", "takeover"};
  return kWords[static_cast<std::size_t>(way)];
}

Json names_json(const Configuration& configuration, const std::vector<std::size_t>& tasks) {
  Json names = Json::array();
  for (const std::size_t task : tasks) names.push_back(configuration.tasks()[task].name);
  return names;
}

Json json_of(const Configuration& configuration, const ModeConstant& constant) {
  return {{"constant", constant.name},
          {"before", configuration.tasks()[constant.before].name},
          {"after", configuration.tasks()[constant.after].name},
          {"tasks", names_json(configuration, constant.users)}};
}

Json json_of(const Configuration& configuration, const ModeResource& resource) {
  return {{"resource", resource.text},
          {"before", configuration.tasks()[resource.before].name},
          {"after", configuration.tasks()[resource.after].name}};
}

Json json_of(const Configuration& configuration, const ModeNode& node) {
  return {{"name", node.name},
          {"configuration", configuration.sets()[node.set].name},
          {"primary", configuration.tasks()[node.primary.index].name},
          {"standby", configuration.tasks()[node.standby.index].name}};
}

Json json_of(const Configuration& configuration, const ModeReport& report, const ModeEdge& edge) {
  Json askers = Json::array(), cpus = Json::array(), constants = Json::array(),
       resources = Json::array();
  for (const ModeAsker& asker : edge.askers)
    askers.push_back({{"cause", cause_word(asker.cause)},
                      {"task", configuration.tasks()[asker.task].name},
                      {"constant", asker.constant.empty() ? Json() : Json(asker.constant)}});
  for (const CpuTransition& cpu : edge.cpus) cpus.push_back(json_of(configuration, cpu));
  for (const ModeConstant& constant : edge.constants) constants.push_back(json_of(configuration, constant));
  for (const ModeResource& resource : edge.resources) resources.push_back(json_of(configuration, resource));
  return {{"from", report.nodes[edge.from].name},
          {"to", report.nodes[edge.to].name},
          {"asked_by", std::move(askers)},
          {"legal", true},
          {"way", way_word(edge.way())},
          {"cpus", std::move(cpus)},
          {"constants", std::move(constants)},
          {"resources", std::move(resources)},
          {"initialised_anew", names_json(configuration, edge.anew)}};
}

}  // namespace

std::string mode_json(const Configuration& configuration, const ModeReport& report) {
  Json sets = Json::array(), takeovers = Json::array(), edges = Json::array(), alone = Json::array();
  for (std::size_t set = 0; set < configuration.sets().size(); ++set)
    sets.push_back({{"name", configuration.sets()[set].name}, {"start", set == configuration.start()}});
  for (const ModeNode& node : report.nodes)
    if (node.standby.is_valid()) takeovers.push_back(json_of(configuration, node));
  for (const ModeEdge& edge : report.edges) edges.push_back(json_of(configuration, report, edge));
  for (const std::size_t set : report.by_operator) alone.push_back(configuration.sets()[set].name);
  const Json all = {{"subsystem", configuration.subsystem()},
                    {"accepted", report.is_accepted()},
                    {"configurations", std::move(sets)},
                    {"takeovers", std::move(takeovers)},
                    {"transitions", std::move(edges)},
                    {"by_operator_only", std::move(alone)},
                    {"warnings", report.warnings}};
  return all.dump(Json::Style::kAsMade);
}

}  // namespace chimera
