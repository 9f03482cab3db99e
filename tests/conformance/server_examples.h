// SPDX-License-Identifier: Apache-2.0
// The textbook examples of both servers: in virtual time to the letter, in real time unit by unit.
// Buttazzo, Hard Real-Time Computing Systems: the deferrable server of 5.3, both sporadic servers of 5.5, the dynamic
// sporadic server of chapter 6 (Spuri & Buttazzo 1996). Where a book leaves periodic tasks or requests open they are
// stated here, and the schedule is worked out by hand from the definition of the server.
#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "tests/conformance/runner.h"
#include "tests/conformance/timeline.h"

namespace chimera::toy {

struct Periodic {
  char name;
  int work, period;
  std::uint32_t criticality = 0;
};

struct Request {
  int at, work;
};

/// Two periodic tasks and the server S with its requests.
struct Example {
  Policy policy;
  Periodic periodic[2];
  ServerKind kind;
  int capacity, period;
  std::uint32_t criticality;
  std::vector<Request> requests;
  std::string timeline;
};

// The deferrable server's own period is its deadline, the sporadic one's is its replenishment.
inline constexpr ServerKind kDeferrable = ServerKind::kDeferrable, kSporadic = ServerKind::kSporadic;
inline const std::vector<Request> kFour = {{2, 2}, {8, 1}, {12, 2}, {19, 1}};
inline const Example kExamples[] = {
    // 5.3: the request at 2 is served at once and at 4 only the task of period 4 goes before the server.
    {Policy::kRm, {{'A', 1, 4}, {'B', 2, 6}}, kDeferrable, 2, 5, 0, kFour, "ABSSABBBAS..ASSBABBSAB.."},
    {Policy::kEdf, {{'A', 1, 4}, {'B', 2, 6}}, kDeferrable, 2, 5, 0, kFour, "ABSSBABBSA..SSABBABSAB.."},
    {Policy::kMuf, {{'A', 1, 4}, {'B', 2, 6}}, kDeferrable, 2, 5, 0, kFour, "ABSSBABBSA..SSABBABSAB.."},
    // 5.5, medium priority.
    {Policy::kRm, {{'A', 1, 5}, {'B', 4, 15}}, kSporadic, 5, 10, 0, {{4, 2}, {8, 2}}, "ABBBSASBSSA....ABBBBA..."},
    // 5.5, highest priority: the request at 6 waits for what the one at 2 has used.
    {Policy::kRm, {{'A', 3, 10}, {'B', 4, 15}}, kSporadic, 2, 8, 0, {{2, 2}, {6, 2}}, "AASSABBBB.SSAAABBBB.AAA."},
    // Dynamic: due at 9 by the request at 3, at 12 by that at 6, and at 15 by what comes back at 9.
    {Policy::kEdf, {{'A', 2, 8}, {'B', 3, 12}}, kSporadic, 3, 6, 0, {{3, 2}, {6, 2}}, "AABSSBBSASA.BBB.AA......"},
    // The same under maximum urgency: A is more critical than the server, B less.
    {Policy::kMuf, {{'A', 2, 8, 2}, {'B', 3, 12, 0}}, kSporadic, 3, 6, 1, {{3, 2}, {6, 2}},
     "AABSSBSBAAS.BBB.AA......"},
};

inline constexpr std::size_t kExampleUnits = 24;
inline constexpr double kALittleLess = 0.97;  // of a unit of work, where nothing is exact

inline ScriptAct ring(Nanoseconds at, TaskId task) { return {at, ScriptAct::Kind::kSignal, Signal::kWakeup, task}; }

inline TaskSpec& add_served(Application& app, const char* name, ServerKind kind, Nanoseconds capacity,
                            Nanoseconds period) {
  TaskSpec& spec = app.add(name, period);
  spec.aperiodic = true;
  spec.server = ServerSpec{kind, capacity, period};
  return spec;
}

/// Every cycle of the task takes the next of `works`.
inline void take_in_turn(Toy& toy, std::deque<Nanoseconds> works) {
  auto left = std::make_shared<std::deque<Nanoseconds>>(std::move(works));
  toy.during = [left](const chimera_call& call) {
    call.host->spend(call.context, left->front().count);
    left->pop_front();
    return CHIMERA_OK;
  };
}

/// The tasks of `example`, in order, at `unit`; a unit of work takes `share` of one. Answers with the rings.
inline std::vector<ScriptAct> add_example(Application& app, const Example& example, Nanoseconds unit, double share) {
  const auto work = [&](int units) {
    return Nanoseconds{static_cast<std::int64_t>(static_cast<double>((unit * units).count) * share)};
  };
  for (const Periodic& p : example.periodic)
    app.add(std::string(1, p.name), unit * p.period, work(p.work)).criticality = p.criticality;
  add_served(app, "S", example.kind, unit * example.capacity, unit * example.period).criticality = example.criticality;
  std::vector<ScriptAct> acts;
  std::deque<Nanoseconds> works;
  for (const Request& request : example.requests) {
    acts.push_back(ring(unit * request.at, app.id("S")));
    works.push_back(work(request.work));
  }
  take_in_turn(app.toy("S"), works);
  return acts;
}

}  // namespace chimera::toy
