// SPDX-License-Identifier: Apache-2.0
// Encoding and decoding of an image: the fields are listed once, and the reader judges each of them.
#include "chimera/runtime/hosted/application_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <deque>
#include <set>
#include <type_traits>
#include <utility>

#include "chimera/base/assert.h"
#include "chimera/runtime/hosted/image_archive.h"
#include "chimera/runtime/hosted/links.h"
#include "chimera/runtime/hosted/pages.h"
#include "chimera/table/layout.h"

namespace chimera {

struct ApplicationImage::Parts {
  ApplicationSpec spec;
  RunSettings settings;
  std::vector<RtpuSpec> rtpus;
  std::vector<TaskSpec> tasks;
  std::deque<std::vector<PortSpec>> ports;  // of one task each
  std::vector<Variable> variables;
  std::vector<ConstantSpec> constants;
  std::vector<GivenSpec> operators;
  std::vector<TaskId> init_order, start, on_order, end_order;
  std::vector<StandbySpec> standbys;
  std::vector<RestartSpec> restarts;
  std::vector<StaleSpec> stale;
  std::vector<NamedSet> sets;
  std::deque<std::vector<TaskId>> set_orders;  // of one set each
  Links links;
  std::vector<ComponentPlace> places;
};

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t kMagic = 0x31474d49'4d494843;  // "CHIMIMG1" in memory
constexpr std::uint32_t kVersion = 13;

struct Header {
  std::uint64_t magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t header_bytes = sizeof(Header);
  std::uint64_t total_bytes = 0;
  std::uint64_t hash = 0;  ///< of everything behind the header
};
static_assert(sizeof(Header) == 32);

std::uint64_t hash_of(std::span<const std::byte> bytes) noexcept {
  std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a
  for (const std::byte b : bytes) hash = (hash ^ static_cast<unsigned char>(b)) * 0x100000001b3u;
  return hash;
}

template <class T>
bool is_valued(const T& item) {
  const std::uint64_t count = std::uint64_t{item.extent[0].max} * item.extent[1].max;
  const bool fits = item.extent[0].max <= kMaxPayloadBytes && item.extent[1].max <= kMaxPayloadBytes && count > 0 &&
                    item.element_bytes <= kMaxPayloadBytes && count <= kMaxPayloadBytes &&
                    count * item.element_bytes <= kMaxPayloadBytes;
  return fits && (item.value.empty() || item.element_bytes == 0 || item.value.size() == count * item.element_bytes);
}

/// Lengths of the lists that ids point into; known before the first id is read.
struct Counts {
  std::size_t variables = 0, constants = 0;
};

// The fields that PortSpec and GivenSpec share.
template <class Archive, class Item>
void value_fields(Archive& archive, Item& item, const Counts& counts) {
  archive.number(item.type);
  archive.number(item.element_bytes);
  for (auto& extent : item.extent) {
    archive.number(extent.max);
    archive.number(extent.constant);
    archive.require(!extent.constant.is_valid() || extent.constant.index < counts.constants,
                    "an extent of a constant that does not exist");
  }
  archive.values(item.value);
  for (auto& listed : item.listed) archive.number(listed);
  archive.require(item.type < CHIMERA_ANY, "a type that does not exist");
  archive.require(is_valued(item), "a value that does not fill its variable");
}

// An in-const alone may be linked to nothing: then its value is its own.
template <class Archive, class Port>
void link_fields(Archive& archive, Port& port, const Counts& counts) {
  archive.number(port.variable);
  archive.number(port.constant);
  const bool is_variable = port.kind == CHIMERA_IN_VAR || port.kind == CHIMERA_OUT_VAR;
  const bool is_constant =
      port.kind == CHIMERA_OUT_CONST || (port.kind == CHIMERA_IN_CONST && port.constant.is_valid());
  archive.require(is_variable ? port.variable.index < counts.variables : !port.variable.is_valid(),
                  "a variable that does not exist");
  archive.require(is_constant ? port.constant.index < counts.constants : !port.constant.is_valid(),
                  "a constant that does not exist");
}

template <class Archive, class Port>
void port_fields(Archive& archive, Port& port, const Counts& counts) {
  archive.number(port.declared);
  archive.number(port.kind);
  archive.number(port.instance);
  archive.require(port.declared < CHIMERA_MAX_PORTS && port.kind <= CHIMERA_OUT_STREAM &&
                      port.instance < CHIMERA_MAX_INSTANCES, "a port that cannot be declared");
  link_fields(archive, port, counts);
  archive.text(port.unit);
  archive.choice(port.safety, true);
  archive.choice(port.has_range, true);
  archive.number(port.min);
  archive.number(port.max);
  value_fields(archive, port, counts);
  archive.values(port.max_step);
  archive.require(port.max_step.empty() ||
                      (port.kind == CHIMERA_OUT_VAR && port.max_step.size() == port.max_bytes()),
                  "a largest step that does not fill an output");
  archive.choice(port.shared, true);
  archive.choice(port.intermittent, true);
}

// Its producers are the out-consts that carry its id.
template <class Archive, class Constant>
void constant_fields(Archive& archive, Constant& constant) {
  archive.text(constant.name);
  archive.number(constant.type);
  archive.number(constant.element_bytes);
  archive.values(constant.value);
  for (auto& listed : constant.listed) archive.number(listed);
  archive.require(constant.type < CHIMERA_ANY, "a type that does not exist");
  archive.require(constant.value.size() <= kMaxPayloadBytes &&
                      (constant.element_bytes == 0 ? constant.value.empty()
                                                   : constant.value.size() % constant.element_bytes == 0),
                  "a value that does not fill its constant");
}

template <class Archive, class Task>
void server_fields(Archive& archive, Task& task) {
  bool is_served = task.server.has_value();
  archive.choice(is_served, true);
  if (!is_served) return;
  ServerSpec server = task.server.value_or(ServerSpec{});
  archive.choice(server.kind, ServerKind::kSporadic);
  archive.number(server.capacity);
  archive.number(server.period);
  archive.require(server.capacity > Nanoseconds{} && server.capacity <= server.period && task.aperiodic &&
                      server.period == task.period, "a server that is not in order");
  if constexpr (!std::is_const_v<Task>) task.server = server;
}

template <class Archive, class Task>
void task_fields(Archive& archive, Task& task, std::vector<PortSpec>& ports, std::size_t n_rtpus,
                 const Counts& counts) {
  archive.text(task.name);
  archive.text(task.component);
  for (auto* time : {&task.period, &task.offset, &task.deadline, &task.budget, &task.min_time}) archive.number(*time);
  archive.number(task.criticality);
  archive.number(task.user_priority);
  archive.choice(task.on_miss, OnMiss::kStop);
  archive.choice(task.on_overrun, OnMiss::kStop);
  archive.choice(task.on_fault, OnFault::kRestart);
  for (auto* set : {&task.on_miss_set, &task.on_overrun_set, &task.on_fault_set}) archive.number(*set);
  archive.number(task.max_consecutive);
  archive.number(task.tolerated_misses);
  archive.number(task.tolerated_of);
  archive.number(task.place);
  archive.number(task.stack_bytes);
  archive.choice(task.aperiodic, true);
  archive.choice(task.is_hardware, true);
  archive.choice(task.has_events, true);
  server_fields(archive, task);
  archive.require(!task.has_events || (task.aperiodic && !task.server),
                  "events of a periodic task, or behind a server");
  archive.number(task.rtpu);
  archive.list(task.ports, ports, CHIMERA_MAX_PORTS, "too many ports",
               [&](auto& port) { port_fields(archive, port, counts); });
  const Nanoseconds zero;
  archive.require(task.period > zero && task.deadline > zero && task.deadline <= task.period && task.offset >= zero &&
                      task.budget >= zero && task.min_time >= zero, "times that are not in order");
  archive.require(task.tolerated_of <= 64 && task.stack_bytes <= 64u << 20, "a task out of range");
  archive.require(task.rtpu.index < n_rtpus, "an rtpu that does not exist");
}

template <class Archive, class Ids>
void task_ids(Archive& archive, Ids& ids, std::vector<TaskId>& storage, std::size_t n_tasks) {
  archive.list(ids, storage, n_tasks, "more tasks in an order than there are", [&](auto& id) {
    archive.number(id);
    archive.require(id.index < n_tasks, "a task that does not exist");
  });
}

// Far beyond what a description of 256 KiB can hold.
constexpr std::size_t kMostTasks = 4096, kMostLinks = 65536, kMostSets = 4096, kMostStandbys = 256;

// The lists that ids point into come before the ids.
template <class Archive>
Counts linked_fields(Archive& archive, ApplicationImage::Parts& parts, ApplicationSpec& spec) {
  archive.list(spec.variables, parts.variables, kMostLinks, "too many variables",
               [&](auto& variable) { archive.text(variable.name); });
  archive.list(spec.constants, parts.constants, kMostLinks, "too many constants",
               [&](auto& constant) { constant_fields(archive, constant); });
  return {spec.variables.size(), spec.constants.size()};
}

template <class Archive>
void operator_fields(Archive& archive, ApplicationImage::Parts& parts, ApplicationSpec& spec, const Counts& counts) {
  archive.list(spec.operators, parts.operators, kMostLinks, "too many operator variables", [&](auto& given) {
    archive.number(given.variable);
    value_fields(archive, given, counts);
    archive.require(given.variable.index < counts.variables, "a variable that does not exist");
  });
}

template <class Archive, class Link>
void board_fields(Archive& archive, Link& link) {
  archive.text(link.address);
  archive.choice(link.is_udp, true);
  archive.number(link.baud);
  archive.number(link.period);
  archive.number(link.stale_after);
  archive.require(!link.is_there() || (link.baud > 0 && link.period > Nanoseconds{} &&
                                       link.stale_after.count / 2 >= link.period.count), "a link out of range");
}

template <class Archive, class Condition>
void condition_fields(Archive& archive, Condition& condition, std::size_t n_variables) {
  archive.number(condition.variable);
  archive.number(condition.element);
  archive.choice(condition.comparison, Relation::kUnequal);
  archive.number(condition.limit);
  archive.require(!condition.is_there() || condition.variable.index < n_variables, "a variable that does not exist");
  archive.require(std::isfinite(condition.limit), "a limit that is no finite number");
}

template <class Archive>
void set_fields(Archive& archive, ApplicationImage::Parts& parts, ApplicationSpec& spec) {
  archive.list(spec.sets, parts.sets, kMostSets, "too many sets", [&](auto& set) {
    archive.text(set.name);
    task_ids(archive, set.order, parts.set_orders.emplace_back(), spec.tasks.size());
    condition_fields(archive, set.safe_when, spec.variables.size());
  });
}

template <class Archive>
void recovery_fields(Archive& archive, ApplicationImage::Parts& parts, ApplicationSpec& spec) {
  const auto is_task = [&](TaskId id) { archive.require(id.index < spec.tasks.size(), "a task that does not exist"); };
  archive.list(spec.standbys, parts.standbys, kMostStandbys, "too many standbys", [&](auto& standby) {
    archive.number(standby.primary);
    archive.number(standby.standby);
    archive.number(standby.stale_after);
    archive.choice(standby.hot, true);
    is_task(standby.primary);
    is_task(standby.standby);
  });
  archive.list(spec.restarts, parts.restarts, kMostTasks, "too many restarts", [&](auto& restart) {
    archive.number(restart.task);
    archive.number(restart.most);
    archive.number(restart.within);
    archive.choice(restart.then, OnFault::kSwitch);
    is_task(restart.task);
    archive.require(restart.most >= 1 && restart.most <= kMostRestarts && restart.within > Nanoseconds{},
                    "a restart out of range");
  });
  archive.list(spec.stale, parts.stale, kMostTasks, "too many limits of age", [&](auto& stale) {
    archive.number(stale.task);
    archive.number(stale.after);
    is_task(stale.task);
    archive.require(stale.after > Nanoseconds{}, "a limit of age out of range");
  });
}

// `parts` holds what an ImageReader makes; an ImageWriter only looks at what spec and places point at.
template <class Archive>
void image_fields(Archive& archive, ApplicationImage::Parts& parts, ApplicationSpec& spec,
                  std::span<const ComponentPlace>& places, RunSettings& settings) {
  archive.number(settings.priority);
  archive.number(settings.method_limit);
  archive.require(settings.priority >= 0 && settings.priority <= 99 && settings.method_limit >= Nanoseconds{},
                  "settings out of range");
  archive.text(spec.name);
  archive.list(spec.rtpus, parts.rtpus, kMaxRtpus, "too many rtpus", [&](auto& rtpu) {
    archive.text(rtpu.name);
    archive.number(rtpu.cpu);
    archive.choice(rtpu.policy, Policy::kMufLaxity);
    archive.choice(rtpu.preemptive, true);
    board_fields(archive, rtpu.link);
  });
  const Counts counts = linked_fields(archive, parts, spec);
  archive.list(spec.tasks, parts.tasks, kMostTasks, "too many tasks", [&](auto& task) {
    task_fields(archive, task, parts.ports.emplace_back(), spec.rtpus.size(), counts);
  });
  archive.list(places, parts.places, kMostTasks, "too many places", [&](auto& place) {
    archive.text(place.object_file);
    archive.number(place.fingerprint);
  });
  archive.require(places.size() == spec.tasks.size(), "not one place for each task");
  operator_fields(archive, parts, spec, counts);
  task_ids(archive, spec.init_order, parts.init_order, spec.tasks.size());
  task_ids(archive, spec.start, parts.start, spec.tasks.size());
  task_ids(archive, spec.on_order, parts.on_order, spec.tasks.size());
  task_ids(archive, spec.end_order, parts.end_order, spec.tasks.size());
  set_fields(archive, parts, spec);
  recovery_fields(archive, parts, spec);
}

bool holds_none_twice(std::span<const TaskId> order, std::size_t n_tasks) {
  std::vector<char> seen(n_tasks, 0);
  return std::all_of(order.begin(), order.end(), [&](TaskId id) { return std::exchange(seen[id.index], 1) == 0; });
}

bool holds_every_task_once(std::span<const TaskId> order, std::size_t n_tasks) {
  return order.size() == n_tasks && holds_none_twice(order, n_tasks);
}

void judge_sets(const ApplicationImage::Parts& parts, ImageReader& reader) {
  const auto is_start = [&](const NamedSet& set) { return std::ranges::equal(set.order, parts.start); };
  reader.require(parts.sets.empty() || std::ranges::any_of(parts.sets, is_start), "a start that is none of the sets");
  reader.require(holds_none_twice(parts.start, parts.tasks.size()), "a set that holds a task twice");
  std::set<std::string_view> names;
  for (const NamedSet& set : parts.sets) {
    reader.require(holds_none_twice(set.order, parts.tasks.size()), "a set that holds a task twice");
    reader.require(names.insert(set.name).second, "two sets of one name");
  }
}

void judge_reactions(const ApplicationImage::Parts& parts, ImageReader& reader) {
  const auto judge = [&](bool is_switch, std::uint16_t set) {
    reader.require(is_switch ? set < parts.sets.size() : set == UINT16_MAX, "a reaction with a wrong set");
  };
  for (const TaskSpec& task : parts.tasks) {
    judge(task.on_miss == OnMiss::kSwitch, task.on_miss_set);
    judge(task.on_overrun == OnMiss::kSwitch, task.on_overrun_set);
    if (task.on_fault != OnFault::kRestart) judge(task.on_fault == OnFault::kSwitch, task.on_fault_set);
  }
  std::vector<char> restarts(parts.tasks.size(), 0);
  for (const RestartSpec& restart : parts.restarts) {
    const TaskSpec& task = parts.tasks[restart.task.index];
    reader.require(std::exchange(restarts[restart.task.index], 1) == 0, "two restarts of a task");
    reader.require(task.on_fault == OnFault::kRestart, "a restart of a task without that reaction");
    judge(restart.then == OnFault::kSwitch, task.on_fault_set);
  }
  const auto restarted = [](const TaskSpec& task) { return task.on_fault == OnFault::kRestart; };
  reader.require(std::ranges::count_if(parts.tasks, restarted) == static_cast<std::ptrdiff_t>(parts.restarts.size()),
                 "a reaction restart that is not told");
}

// A primary is no standby, a standby has one primary, and all outputs of it.
void judge_recovery(const ApplicationImage::Parts& parts, ImageReader& reader) {
  const auto outputs = [&](TaskId id) {
    std::set<std::uint32_t> variables;
    for (const PortSpec& port : parts.tasks[id.index].ports)
      if (port.kind == CHIMERA_OUT_VAR) variables.insert(port.variable.index);
    return variables;
  };
  std::set<std::uint32_t> primaries, standbys;
  for (const StandbySpec& each : parts.standbys) {
    primaries.insert(each.primary.index);
    reader.require(standbys.insert(each.standby.index).second, "a standby of two tasks");
    reader.require(std::ranges::includes(outputs(each.standby), outputs(each.primary)),
                   "a standby without an output of its primary");
  }
  reader.require(std::ranges::none_of(primaries, [&](std::uint32_t id) { return standbys.contains(id); }),
                 "a standby of a standby");
  for (const StandbySpec& each : parts.standbys) {
    const TaskSpec &primary = parts.tasks[each.primary.index], &standby = parts.tasks[each.standby.index];
    const auto keeps_back = [](const PortSpec& port) {
      return port.kind == CHIMERA_RESOURCE || port.kind == CHIMERA_OUT_CONST;
    };
    reader.require(!each.hot || (!standby.aperiodic && std::ranges::none_of(standby.ports, keeps_back)),
                   "a hot standby that others would notice");
    const bool fits = !primary.aperiodic && primary.rtpu != standby.rtpu &&
                      each.stale_after.count / kStalePeriods >= primary.period.count;
    reader.require(each.stale_after.count == 0 || fits, "a primary that cannot be killed for its silence");
  }
  std::set<std::uint32_t> judged;
  for (const StaleSpec& each : parts.stale)
    reader.require(judged.insert(each.task.index).second, "two limits of age for a task");
}

// Collects the links of ports, and refuses links that verification never makes.
void link(ApplicationImage::Parts& parts, ImageReader& reader) {
  for (GivenSpec& given : parts.operators) given.name = parts.variables[given.variable.index].name;
  parts.links.fill(parts.tasks, parts.operators, parts.variables, parts.constants);
  for (std::size_t o = 0; o < parts.operators.size(); ++o)
    reader.require(parts.variables[parts.operators[o].variable.index].operator_index == o,
                   "a variable with two operator values");
  for (const Variable& variable : parts.variables)
    reader.require(!variable.consumers.empty() || !variable.producers.empty(), "a variable without a port");
  for (const ConstantSpec& constant : parts.constants)
    reader.require(constant.value.empty() != constant.producers.empty(),
                   "a constant that is not either given or produced");
  for (const auto* order : {&parts.init_order, &parts.on_order, &parts.end_order})
    reader.require(holds_every_task_once(*order, parts.tasks.size()), "an order that does not hold every task once");
  judge_sets(parts, reader);
  judge_reactions(parts, reader);
  judge_recovery(parts, reader);
}

Error refusal(std::string text) { return {ErrorCode::kBadInput, {std::move(text)}, {}}; }

}  // namespace

std::vector<std::byte> encode(const ApplicationSpec& spec, std::span<const ComponentPlace> places,
                              const RunSettings& settings) {
  CHIMERA_ASSERT(places.size() == spec.tasks.size());
  ImageWriter writer;
  writer.number(Header{});
  ApplicationImage::Parts unused;
  ApplicationSpec same = spec;
  RunSettings same_settings = settings;
  image_fields(writer, unused, same, places, same_settings);
  Header header;
  header.total_bytes = writer.bytes().size();
  header.hash = hash_of(writer.bytes().subspan(sizeof header));
  std::memcpy(writer.bytes().data(), &header, sizeof header);
  return std::move(writer).bytes();
}

Result<ApplicationImage> ApplicationImage::decode(std::span<const std::byte> bytes) {
  Header header;
  if (bytes.size() < sizeof header) {
    return refusal("not an application image: " + std::to_string(bytes.size()) + " bytes");
  }
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != kMagic || header.header_bytes != sizeof header) return refusal("not an application image");
  if (header.version != kVersion) {
    return refusal("image version " + std::to_string(header.version) + ", this program reads " +
                   std::to_string(kVersion));
  }
  if (header.total_bytes != bytes.size()) {
    return refusal("the image says it has " + std::to_string(header.total_bytes) + " bytes, here are " +
                   std::to_string(bytes.size()));
  }
  const auto body = bytes.subspan(sizeof header);
  if (header.hash != hash_of(body)) return refusal("damaged image: its bytes have another hash");
  auto parts = std::make_shared<Parts>();
  ImageReader reader(body);
  std::span<const ComponentPlace> places;
  image_fields(reader, *parts, parts->spec, places, parts->settings);
  reader.require(reader.position() == body.size(), "more than there should be");
  if (reader.is_good()) link(*parts, reader);
  if (!reader.is_good()) {
    return refusal("damaged image: " + std::string(reader.why()) + ", before byte " +
                   std::to_string(sizeof header + reader.position()));
  }
  return ApplicationImage(std::move(parts));
}

const ApplicationSpec& ApplicationImage::spec() const noexcept { return parts_->spec; }
std::span<const ComponentPlace> ApplicationImage::places() const noexcept { return parts_->places; }
const RunSettings& ApplicationImage::settings() const noexcept { return parts_->settings; }

}  // namespace chimera
