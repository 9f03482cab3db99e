// SPDX-License-Identifier: Apache-2.0
// Writes the tables of an image, each before the one that names it.
#include "chimera/bake/tables.h"

#include <array>
#include <set>

#include "chimera/bake/source_text.h"
#include "chimera/bake/target_table.h"
#include "chimera/base/hosted/wording.h"

namespace chimera::bake {
namespace {

constexpr std::array kKinds = {"CHIMERA_IN_VAR",   "CHIMERA_OUT_VAR",   "CHIMERA_IN_CONST", "CHIMERA_OUT_CONST",
                               "CHIMERA_RESOURCE", "CHIMERA_IN_STREAM", "CHIMERA_OUT_STREAM"};
constexpr std::array kTypes = {"CHIMERA_BOOL",    "CHIMERA_INT32",  "CHIMERA_INT64",  "CHIMERA_FLOAT32",
                               "CHIMERA_FLOAT64", "CHIMERA_STRING", "CHIMERA_STRUCT", "CHIMERA_ANY"};
constexpr std::array kPolicies = {"kRm", "kEdf", "kLlf", "kMuf", "kMufLaxity"};
constexpr std::array kOnMiss = {"kContinue", "kHold", "kSkip", "kAbort", "kDemote", "kError", "kSwitch", "kFlag",
                                "kStop"};
constexpr std::array kOnFault = {"kError", "kFlag", "kStop", "kSwitch", "kRestart"};
constexpr std::array kRelations = {"kLess", "kAtMost", "kMore", "kAtLeast", "kEqual", "kUnequal"};
constexpr std::array kActs = {"kSignal", "kRaiseFlag", "kLowerFlag", "kSet", "kSwitch", "kDie"};
constexpr std::array kSignals = {"kSpawn", "kOn", "kOff", "kKill", "kClear", "kReinit", "kWakeup"};

/// "OnMiss::kSkip"; "" for the default, which is left out.
template <class Enum, std::size_t n>
std::string enumerator(const char* type, const std::array<const char*, n>& names, Enum value, Enum otherwise) {
  return value == otherwise ? "" : std::string(type) + "::" + names[static_cast<std::size_t>(value)];
}

std::string listed_text(const std::uint32_t (&listed)[CHIMERA_MAX_EXTENTS]) {
  if (listed[0] == 0 && listed[1] == 0) return {};
  return "{" + std::to_string(listed[0]) + ", " + std::to_string(listed[1]) + "}";
}

std::string extents_text(const ExtentSpec (&extents)[CHIMERA_MAX_EXTENTS]) {
  std::string all;
  bool is_default = true;
  for (const ExtentSpec& extent : extents) {
    is_default = is_default && extent.max == 1 && !extent.constant.is_valid();
    append_joined(all, ", ", Initialiser()
                                 .add("max", extent.max, std::uint32_t{1})
                                 .add_id("constant", "ConstantId", extent.constant)
                                 .text());
  }
  return is_default ? "" : "{" + all + "}";
}

/// A running task can have a fault whose text names the port.
bool is_named_in_faults(const PortSpec& port) {
  return port.safety || port.extent[0].constant.is_valid() || port.extent[1].constant.is_valid();
}

std::string port_of_text(const PortOf& port) {
  return Initialiser()
      .add_id("task", "TaskId", port.task)
      .add("index", port.index, std::uint32_t{0})
      .add("intermittent", port.intermittent, false)
      .text();
}

/// An image has less words than a host.
std::string bits_text(const TaskBits& bits) {
  const std::span words = std::span(bits.words).first(kMostTasksOfImage / 64);
  return "{{" + join(words, ", ", [](std::uint64_t word) { return std::to_string(word) + "u"; }) + "}}";
}

class Tables {
 public:
  Tables(const ApplicationSpec& spec, const baked::Run& run, const Target& target)
      : spec_(spec), run_(run), target_(target) {}

  std::string take() {
    const std::string spec = application();
    const std::string run = run_text();
    const std::string target = target_table(spec_, target_, all_);
    std::vector<std::string> components;
    for (const TaskSpec& task : spec_.tasks) components.push_back("&chimera_component_" + std::string(task.component));
    const std::string by_task = all_.array("const chimera_component* const", "kComponentOf", components);
    return head() + all_.text() + "\n}  // namespace\n\nconstinit const ApplicationSpec kSpec = " + spec +
           ";\nconstinit const std::span<const chimera_component* const> kComponents = " +
           (by_task.empty() ? "{}" : by_task) + ";\nconstinit const Run kRun = " + run +
           ";\nconstinit const TargetSpec kTarget = " + target + ";\n\n}  // namespace chimera::baked\n";
  }

 private:
  std::string head() const {
    std::set<std::string_view> components;
    for (const TaskSpec& task : spec_.tasks) components.insert(task.component);
    std::string text =
        "// Made by `chimera bake`: docs/formats/baked.md. A change belongs into the description or the target.\n"
        "#include \"chimera/runtime/executive/baked.h\"\n"
        "#include \"chimera/runtime/executive/baked_sizes.h\"\n\nextern \"C\" {\n";
    for (const std::string_view name : components)
      text += "extern const chimera_component chimera_component_" + std::string(name) + ";\n";
    return text + "}\n\nnamespace chimera::baked {\nnamespace {\n\n[[maybe_unused]] constexpr std::byte operator\"\"_b("
                  "unsigned long long byte) { return static_cast<std::byte>(byte); }\n\n";
  }

  std::string ids(const std::string& name, std::span<const TaskId> order) {
    return all_.array("TaskId", name, names_of(order, [](TaskId task) { return literal("TaskId", task); }));
  }

  std::string ports_of(const std::string& name, std::span<const PortOf> ports) {
    return all_.array("PortOf", name, names_of(ports, port_of_text));
  }

  /// A resource text is no array of elements; its alignment costs nothing.
  std::string port(const PortSpec& spec) {
    const PortSpec none;
    return Initialiser()
        .add("declared", spec.declared, none.declared)
        .add_text("kind", kKinds[spec.kind])
        .add("instance", spec.instance, none.instance)
        .add_id("variable", "VariableId", spec.variable)
        .add_id("constant", "ConstantId", spec.constant)
        .add("unit", spec.unit, none.unit)
        .add("element_bytes", spec.element_bytes, none.element_bytes)
        .add_text("extent", extents_text(spec.extent))
        .add("safety", spec.safety, none.safety)
        .add("min", spec.min, none.min)
        .add("max", spec.max, none.max)
        .add("has_range", spec.has_range, none.has_range)
        .add_text("type", kTypes[spec.type])
        .add_text("value", all_.bytes(spec.value))
        .add_text("listed", listed_text(spec.listed))
        .add_text("max_step", all_.bytes(spec.max_step))
        .add("shared", spec.shared, none.shared)
        .add("intermittent", spec.intermittent, none.intermittent)
        .add("name", is_named_in_faults(spec) ? spec.name : std::string_view(), none.name)
        .text();
  }

  std::string task(const TaskSpec& spec, std::size_t index) {
    std::vector<std::string> ports;
    for (const PortSpec& each : spec.ports) ports.push_back(port(each));
    const TaskSpec none;
    return Initialiser()
        .add("name", spec.name, none.name)
        .add("component", spec.component, none.component)
        .add("period", spec.period, none.period)
        .add("offset", spec.offset, none.offset)
        .add("deadline", spec.deadline, none.deadline)
        .add("budget", spec.budget, none.budget)
        .add("min_time", spec.min_time, none.min_time)
        .add("criticality", spec.criticality, none.criticality)
        .add("user_priority", spec.user_priority, none.user_priority)
        .add_text("on_miss", enumerator("OnMiss", kOnMiss, spec.on_miss, none.on_miss))
        .add_text("on_overrun", enumerator("OnMiss", kOnMiss, spec.on_overrun, none.on_overrun))
        .add_text("on_fault", enumerator("OnFault", kOnFault, spec.on_fault, none.on_fault))
        .add("has_events", spec.has_events, none.has_events)
        .add("max_consecutive", spec.max_consecutive, none.max_consecutive)
        .add("tolerated_misses", spec.tolerated_misses, none.tolerated_misses)
        .add("tolerated_of", spec.tolerated_of, none.tolerated_of)
        .add("place", spec.place, none.place)
        .add("stack_bytes", spec.stack_bytes, none.stack_bytes)
        .add("aperiodic", spec.aperiodic, none.aperiodic)
        .add("is_hardware", spec.is_hardware, none.is_hardware)
        .add("on_miss_set", spec.on_miss_set, none.on_miss_set)
        .add_id("rtpu", "RtpuId", spec.rtpu)
        .add("on_overrun_set", spec.on_overrun_set, none.on_overrun_set)
        .add("on_fault_set", spec.on_fault_set, none.on_fault_set)
        .add_text("ports", all_.array("PortSpec", "kPorts" + std::to_string(index), ports))
        .text();
  }

  std::string variable(const Variable& spec, std::size_t index) {
    const std::string number = std::to_string(index);
    return Initialiser()
        .add("name", spec.name, {})
        .add_text("producers", ports_of("kProducers" + number, spec.producers))
        .add_text("consumers", ports_of("kConsumers" + number, spec.consumers))
        .add("operator_index", spec.operator_index, UINT32_MAX)
        .text();
  }

  std::string constant(const ConstantSpec& spec, std::size_t index) {
    return Initialiser()
        .add("name", spec.name, {})
        .add_text("type", kTypes[spec.type])
        .add("element_bytes", spec.element_bytes, ConstantSpec{}.element_bytes)
        .add_text("value", all_.bytes(spec.value))
        .add_text("listed", listed_text(spec.listed))
        .add_text("producers", ports_of("kConstantProducers" + std::to_string(index), spec.producers))
        .text();
  }

  std::string given(const GivenSpec& spec) {
    return Initialiser()
        .add("name", spec.name, {})
        .add_id("variable", "VariableId", spec.variable)
        .add_text("type", kTypes[spec.type])
        .add("element_bytes", spec.element_bytes, GivenSpec{}.element_bytes)
        .add_text("extent", extents_text(spec.extent))
        .add_text("value", all_.bytes(spec.value))
        .add_text("listed", listed_text(spec.listed))
        .text();
  }

  std::string set(const NamedSet& spec, std::size_t index) {
    const SafeCondition none, &safe = spec.safe_when;
    const std::string when =
        Initialiser()
            .add_id("variable", "VariableId", safe.variable)
            .add("element", safe.element, none.element)
            .add_text("comparison", enumerator("Relation", kRelations, safe.comparison, none.comparison))
            .add("limit", safe.limit, none.limit)
            .text();
    return Initialiser()
        .add("name", spec.name, {})
        .add_text("order", ids("kSet" + std::to_string(index), spec.order))
        .add_text("safe_when", safe.is_there() ? when : "")
        .text();
  }

  std::string deadline(const PlanAnswer& answer, const std::string& number) {
    if (answer) return {};  // as if it was not judged
    all_.add("constexpr PlanAnswer kDeadline" + number + " = " +
             Initialiser()
                 .add_text("why", "NoSwitch::kNotSchedulable")
                 .add_id("task", "TaskId", answer.task)
                 .add("takes", answer.takes, kNever)
                 .text() +
             ";\n");
    return "&kDeadline" + number;
  }

  std::string plan(const SwitchPlan& spec, std::size_t index) {
    const std::string number = std::to_string(index);
    const auto handover = [](const Handover& each) {
      return Initialiser()
          .add_id("variable", "VariableId", each.variable)
          .add_text("from", each.from.task.is_valid() ? port_of_text(each.from) : "")
          .add_text("to", port_of_text(each.to))
          .text();
    };
    return Initialiser()
        .add("before", spec.before, kNoSet)
        .add("after", spec.after, kNoSet)
        .add_text("arriving", ids("kArriving" + number, spec.arriving))
        .add_text("leaving", ids("kLeaving" + number, spec.leaving))
        .add_text("staying", ids("kStaying" + number, spec.staying))
        .add_text("handovers", all_.array("Handover", "kHandovers" + number, names_of(spec.handovers, handover)))
        .add_text("deadline", spec.deadline == nullptr ? "" : deadline(*spec.deadline, number))
        .text();
  }

  std::string plans() {
    if (spec_.plans == nullptr) return {};
    const std::span<const SwitchPlan> all(spec_.plans, spec_.sets.size() * spec_.sets.size());
    return all_.list("SwitchPlan", "kPlans", all, [&](auto& a, auto i) { return plan(a, i); });
  }

  std::string application() {
    const auto rtpu = [](const RtpuSpec& spec, std::size_t) {
      return Initialiser()
          .add("name", spec.name, {})
          .add("cpu", spec.cpu, std::uint32_t{0})
          .add_text("policy", enumerator("Policy", kPolicies, spec.policy, RtpuSpec{}.policy))
          .text();
    };
    const auto restart = [](const RestartSpec& spec, std::size_t) {
      return Initialiser()
          .add_id("task", "TaskId", spec.task)
          .add("most", spec.most, std::uint32_t{1})
          .add("within", spec.within, {})
          .add_text("then", enumerator("OnFault", kOnFault, spec.then, RestartSpec{}.then))
          .text();
    };
    const auto stale = [](const StaleSpec& spec, std::size_t) {
      return Initialiser().add_id("task", "TaskId", spec.task).add("after", spec.after, {}).text();
    };
    return Initialiser()
        .add("name", spec_.name, {})
        .add_text("rtpus", all_.list("RtpuSpec", "kRtpus", spec_.rtpus, rtpu))
        .add_text("tasks", all_.list("TaskSpec", "kTasks", spec_.tasks, [&](auto& a, auto i) { return task(a, i); }))
        .add_text("variables",
                  all_.list("Variable", "kVariables", spec_.variables, [&](auto& a, auto i) { return variable(a, i); }))
        .add_text("constants",
                  all_.list("ConstantSpec", "kConstants", spec_.constants,
                            [&](auto& a, auto i) { return constant(a, i); }))
        .add_text("operators",
                  all_.list("GivenSpec", "kOperators", spec_.operators, [&](auto& a, auto) { return given(a); }))
        .add_text("init_order", ids("kInitOrder", spec_.init_order))
        .add_text("start", ids("kStart", spec_.start))
        .add_text("on_order", ids("kOnOrder", spec_.on_order))
        .add_text("end_order", ids("kEndOrder", spec_.end_order))
        .add_text("sets", all_.list("NamedSet", "kSets", spec_.sets, [&](auto& a, auto i) { return set(a, i); }))
        .add_text("restarts", all_.list("RestartSpec", "kRestarts", spec_.restarts, restart))
        .add_text("stale", all_.list("StaleSpec", "kStale", spec_.stale, stale))
        .add_text("plans", plans())
        .text();
  }

  std::string act(const ScriptAct& spec, std::size_t index) {
    const ScriptAct none;
    std::string lists;
    if (spec.lists != nullptr) {
      lists = "kLists" + std::to_string(index);
      all_.add("constexpr TaskLists " + lists + " = {.plus = " + bits_text(spec.lists->plus) +
               ", .minus = " + bits_text(spec.lists->minus) + "};\n");
    }
    return Initialiser()
        .add("at", spec.at, none.at)
        .add_text("kind", enumerator("ScriptAct::Kind", kActs, spec.kind, none.kind))
        .add_text("signal", enumerator("Signal", kSignals, spec.signal, none.signal))
        .add_id("task", "TaskId", spec.task)
        .add("operator_index", spec.operator_index, none.operator_index)
        .add_text("value", all_.bytes(spec.value))
        .add("set", spec.set, none.set)
        .add_text("lists", lists.empty() ? "" : "&" + lists)
        .text();
  }

  std::string run_text() {
    return Initialiser()
        .add_text("policy", enumerator("Policy", kPolicies, run_.policy, Policy::kEdf))
        .add("tick", run_.tick, {})
        .add("duration", run_.duration, kNever)
        .add("link_period", run_.link_period, {})
        .add("link_stale_after", run_.link_stale_after, {})
        .add_text("acts", all_.list("ScriptAct", "kActs", run_.acts, [&](auto& a, auto i) { return act(a, i); }))
        .text();
  }

  const ApplicationSpec& spec_;
  const baked::Run& run_;
  const Target& target_;
  Definitions all_;
};

}  // namespace

std::string tables_text(const ApplicationSpec& spec, const baked::Run& run, const Target& target) {
  return Tables(spec, run, target).take();
}

}  // namespace chimera::bake
