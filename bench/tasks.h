// SPDX-License-Identifier: Apache-2.0
// An application of n small tasks for the rows that measure executors: each reads six values of its predecessor
// and publishes six of its own.
#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "chimera/runtime/hosted/heap_task_set.h"
#include "chimera/runtime/testing/named_links.h"

namespace chimera::bench {

inline constexpr int kAxes = 6;

struct AxisState {
  chimera_port in;
  chimera_port out;
};

inline std::int32_t axis_cycle(void* memory, const chimera_call*) {
  const AxisState& state = *static_cast<AxisState*>(memory);
  const double* in = static_cast<const double*>(state.in.value);
  double* out = static_cast<double*>(state.out.value);
  for (int i = 0; i < kAxes; ++i) out[i] = 0.5 * in[i] + 1.0;
  return CHIMERA_OK;
}

inline const chimera_component& axis_component() {
  static const auto port = [](const char* name, std::uint32_t kind, std::size_t offset) {
    chimera_port_decl p{};
    p.name = name;
    p.doc = p.frame = p.type_name = "";
    p.shape = "[6]";
    p.unit = "1";
    p.kind = kind;
    p.type = CHIMERA_FLOAT64;
    p.element_size = 8;
    p.max_instances = 1;
    p.live_offset = static_cast<std::uint32_t>(offset);
    return p;
  };
  static const std::array<chimera_port_decl, 2> ports = {port("in", CHIMERA_IN_VAR, offsetof(AxisState, in)),
                                                         port("out", CHIMERA_OUT_VAR, offsetof(AxisState, out))};
  static const chimera_component component = [] {
    chimera_component c{};
    c.abi_version = CHIMERA_ABI_VERSION;
    c.struct_size = sizeof c;
    c.name = "axis";
    c.doc = c.source = "";
    c.state_size = sizeof(AxisState);
    c.state_align = alignof(AxisState);
    c.n_ports = 2;
    c.ports = ports.data();
    c.construct = [](void*, chimera_fault*) -> std::int32_t { return CHIMERA_OK; };
    c.destroy = [](void*) {};
    c.methods[CHIMERA_CYCLE] = axis_cycle;
    return c;
  }();
  return component;
}

/// Properties of the tasks that a benchmark may change.
struct AxesForm {
  bool preemptive = false;
  Nanoseconds offset_step;
  Nanoseconds budget = microseconds(1);
  const chimera_component* component = nullptr;  ///< null: axis_component()
  OnMiss on_overrun = OnMiss::kContinue;
  std::vector<Nanoseconds> budgets;  ///< of each task, instead of `budget`
  std::uint32_t critical = 0;        ///< number of tasks, from the first, of high criticality
};

/// n tasks in a ring. `period(i)` is that of task i.
class Axes {
 public:
  template <class Period>
  Axes(std::uint32_t n, Period period, const AxesForm& form = AxesForm()) {
    for (std::uint32_t i = 0; i < n; ++i) {
      names_.push_back(std::make_unique<std::string>("axis" + std::to_string(i)));
      components_.push_back(form.component != nullptr ? form.component : &axis_component());
      ids_.push_back(TaskId(i));
    }
    ports_.resize(n);
    for (std::uint32_t i = 0; i < n; ++i) {
      for (std::uint32_t p = 0; p < 2; ++p) {
        ports_[i][p].declared = p;
        ports_[i][p].element_bytes = 8;
        ports_[i][p].extent[0].max = kAxes;
      }
      ports_[i][0].variable = links_.variable(*names_[(i + n - 1) % n]);
      ports_[i][1].variable = links_.variable(*names_[i]);
      ports_[i][1].kind = CHIMERA_OUT_VAR;
      ports_[i][1].value = zeros_;
      TaskSpec task;
      task.name = *names_[i];
      task.component = "axis";
      task.period = task.deadline = period(i);
      task.budget = form.budgets.empty() ? form.budget : form.budgets[i];
      task.criticality = i < form.critical ? 2 : 0;
      task.offset = form.offset_step * i;
      task.on_overrun = form.on_overrun;
      task.rtpu = RtpuId(0u);
      task.ports = ports_[i];
      tasks_.push_back(task);
    }
    spec_.name = "axes";
    spec_.rtpus = rtpus_;
    spec_.tasks = tasks_;
    spec_.init_order = spec_.start = ids_;
    links_.finish(spec_);
    ContextPlace place;
    place.preemptive = form.preemptive;
    auto made = HeapTaskSet::create(spec_, components_, place);
    if (!made) std::fprintf(stderr, "%s\n", made.error().message.c_str()), std::exit(1);
    set_ = *std::move(made);
  }
  TaskSet& set() { return *set_; }

 private:
  std::vector<std::unique_ptr<std::string>> names_;
  std::vector<const chimera_component*> components_;
  std::vector<TaskId> ids_;
  std::vector<std::array<PortSpec, 2>> ports_;
  std::array<std::byte, kAxes * sizeof(double)> zeros_{};
  std::vector<RtpuSpec> rtpus_{RtpuSpec{"only", 0, Policy::kEdf}};
  std::vector<TaskSpec> tasks_;
  chimera::NamedLinks links_;
  ApplicationSpec spec_;
  std::unique_ptr<HeapTaskSet> set_;
};

/// How many whole periods make up n jobs of `tasks`, what is left kept for the next call.
class Periods {
 public:
  explicit Periods(std::uint64_t tasks) : tasks_(tasks) {}
  std::int64_t of(std::uint64_t n) {
    credit_ += n;
    const std::uint64_t periods = credit_ / tasks_;
    credit_ -= periods * tasks_;
    return static_cast<std::int64_t>(periods);
  }

 private:
  std::uint64_t tasks_;
  std::uint64_t credit_ = 0;
};

}  // namespace chimera::bench
