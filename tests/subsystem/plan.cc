// SPDX-License-Identifier: Apache-2.0
#include "tests/subsystem/plan.h"

#include <algorithm>

namespace chimera::simulated {

Plan::Plan(Chance& chance) {
  for (std::size_t r = 0; r < kRtpus; ++r) {
    RtpuSpec rtpu;
    rtpu.name = name("r" + std::to_string(r));
    rtpus_.push_back(rtpu);
  }
  const std::size_t primaries = 14 + chance.below(7);
  const std::size_t alternatives = 6 + chance.below(3);
  add_primaries(chance, primaries);
  add_alternatives(chance, alternatives);
  add_constants(chance);
  finish();
}

std::string_view Plan::name(std::string text) { return names_.emplace_back(std::move(text)); }

void Plan::add_port(std::size_t task, std::uint32_t kind, std::string_view variable) {
  PortSpec port;
  port.kind = kind;
  links_.link(port, variable);
  ports_[task].push_back(port);
}

// Task i produces v<i>, some w<i> too, and reads what others produce, later ones too: loops.
void Plan::add_primaries(Chance& chance, std::size_t n) {
  tasks_.resize(n);
  ports_.resize(n);
  for (std::size_t t = 0; t < n; ++t) {
    tasks_[t].name = name("t" + std::to_string(t));
    tasks_[t].rtpu = RtpuId(chance.below(kRtpus));
    tasks_[t].aperiodic = chance.percent(30);
    tasks_[t].is_hardware = chance.percent(15);
    add_port(t, CHIMERA_OUT_VAR, name("v" + std::to_string(t)));
    if (chance.percent(25)) add_port(t, CHIMERA_OUT_VAR, name("w" + std::to_string(t)));
    start_.push_back(TaskId(t));
  }
  for (std::size_t t = 1; t < n; ++t)
    for (std::size_t inputs = chance.below(3); inputs > 0; --inputs) {
      const std::size_t from = chance.percent(15) ? chance.below(n) : chance.below(t);
      if (from != t) add_port(t, CHIMERA_IN_VAR, name("v" + std::to_string(from)));
    }
}

void Plan::add_alternatives(Chance& chance, std::size_t n) {
  const std::size_t primaries = tasks_.size();
  for (std::size_t a = 0; a < n; ++a) {
    const std::size_t of = chance.below(primaries);
    TaskSpec task = tasks_[of];
    task.name = name("a" + std::to_string(a));
    task.rtpu = RtpuId(chance.below(kRtpus));
    tasks_.push_back(task);
    ports_.push_back(ports_[of]);
  }
}

// A maker comes before its users in the order of initialisation.
void Plan::add_constants(Chance& chance) {
  for (std::size_t t = 0; t < tasks_.size(); ++t) init_order_.push_back(TaskId(t));
  for (std::size_t c = 0; c < 4; ++c) {
    const std::size_t maker = chance.below(tasks_.size() - 1);
    const std::string_view constant = name("c" + std::to_string(c));
    add_port(maker, CHIMERA_OUT_CONST, constant);
    for (int users = 0; users < 3; ++users)
      add_port(maker + 1 + chance.below(tasks_.size() - maker - 1), CHIMERA_IN_CONST, constant);
  }
}

void Plan::finish() {
  std::stable_sort(start_.begin(), start_.end(), [this](TaskId a, TaskId b) {
    return tasks_[a.index].is_hardware && !tasks_[b.index].is_hardware;
  });
  blind_ports_ = ports_;
  for (auto& ports : blind_ports_)
    std::erase_if(ports, [](const PortSpec& p) { return p.kind == CHIMERA_IN_VAR || p.kind == CHIMERA_OUT_VAR; });
  for (TaskSpec& task : tasks_) task.period = task.deadline = milliseconds(1);
  blind_tasks_ = tasks_;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    tasks_[t].ports = ports_[t];
    blind_tasks_[t].ports = blind_ports_[t];
  }
  spec.name = "plan";
  spec.rtpus = rtpus_;
  spec.tasks = tasks_;
  spec.init_order = init_order_;
  spec.start = start_;
  links_.finish(spec);
  blind = spec;
  blind.variables = {};
  blind.tasks = blind_tasks_;
}

}  // namespace chimera::simulated
