// SPDX-License-Identifier: Apache-2.0
// An assembly as far as it is known, also of an illegal description: what a page draws while a person still works on
// it. docs/formats/web.md, "The outline", defines the JSON.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "chimera/text/json.h"
#include "chimera/verify/verify.h"

namespace chimera {

/// An instance of a port.
struct OutlinePort {
  std::string name;      ///< as declared; an instance of a repeated port as "in[2]"
  std::string declared;  ///< "in"
  std::uint32_t kind = 0;
  std::string type, unit, shape;  ///< solved; without a solution as declared: "T", "U/s", "[n]"
  bool is_solved = false;
  std::string variable;     ///< that the text links; empty: none
  bool is_shared = false;   ///< a resource that several tasks may open at once
  bool is_parted = false;   ///< a fault keeps the port apart from `variable`
  Node own;                 ///< written under `constants`, `initial` or `resources`; kNone: nothing
  bool is_own_item = false;  ///< `own` is an item of a written list
  std::string preset;       ///< default or initial value of the component; empty: none
  std::string doc;
};

/// A repeated port, to which instances can be added.
struct OutlineRepeated {
  std::string name;
  std::uint32_t kind = 0;
  std::uint32_t instances = 0, max_instances = 0;
  std::string doc;
};

struct OutlineTask {
  std::string name, component;
  std::uint32_t line = 0;  ///< of the key in the text
  bool is_known = false;  ///< the library has the component; if not, there are no ports
  std::string doc;        ///< one sentence of the component
  std::string rtpu;
  double rate_hz = 0;        ///< 0: none
  bool has_own_rate = false;  ///< the text gives it, not the component
  Nanoseconds period, deadline, budget;  ///< 0: none
  std::uint32_t criticality = 0;
  std::string standby_for;  ///< empty: not a standby
  bool is_aperiodic = false;
  std::vector<OutlinePort> ports;
  std::vector<OutlineRepeated> repeated;
};

/// The part of a description that gives a variable its value.
enum class Origin : std::uint8_t { kNobody, kOperator, kConstants, kDefault };

/// A variable with all ports that the text links to it, including parted ones.
struct OutlineVariable {
  std::string name;
  bool is_constant = false;
  Origin origin = Origin::kNobody;
  Node given;  ///< of kOperator and kConstants
  std::string type, unit, shape;  ///< of the first producer, otherwise of the first consumer
  std::vector<PortRef> producers, consumers;  ///< by number of the task and of the port
};

struct OutlineSet {
  std::string name;
  std::vector<std::string> tasks;  ///< known ones, in the order of the text
  std::string safe_when;           ///< "speed < 0.1 rad/s"; empty: no condition
};

struct Outline {
  std::string subsystem;
  std::vector<OutlineTask> tasks;
  std::vector<OutlineVariable> variables;
  std::vector<OutlineSet> configurations;  ///< `all` if the text has none
  std::size_t start = 0;                   ///< in `configurations`
  std::vector<DraftRtpu> rtpus;            ///< `main` if the text has none
  std::optional<DraftSequence> sequence;   ///< also one with faults
};

/// A verdict and the outline behind it; none if the text is no tree.
struct Outlined {
  Verdict verdict;
  std::optional<Outline> outline;
};

/// Judges as verify() does, in the same pass. Context: setup.
Outlined verify_with_outline(const ReadDescription& reading, const Library& library,
                             Overload overload = Overload::kRefused);

/// The task and port at `ref`, as acts name them. Context: setup.
TaskPort task_port(const Outline& outline, PortRef ref);
/// Fills what an act leaves out: for `rename` the ports linked to the variable by their own name, for `join` all
/// producers. Context: setup.
void name_ports(EditAct& act, const Outline& outline);

Json outline_json(const Outline& outline);

/// The outline of a judged model; only verify() calls it.
Outline outline_of(const Model& model);

}  // namespace chimera
