// SPDX-License-Identifier: Apache-2.0
// Acts that edit a description, as plain values. docs/formats/edit.md defines them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace chimera {

class UnitSystem;

/// A place in the tree of a description: names of keys from the top, and numbers of list items from 0.
using EditPath = std::vector<std::string>;

/// "tasks/pid/alias/q_ref" as a path. Context: setup.
EditPath edit_path(std::string_view text);
/// The path with a slash between its parts. Context: setup.
std::string text_of(const EditPath& path);

/// A port of a task.
struct TaskPort {
  std::string task, port;
};

/// Gives the place a value, in words of a description: "1 kHz", "[1 rad, 2 rad]", "\"0:0\"".
struct SetValue {
  EditPath path;
  std::string value;
  const UnitSystem* units = nullptr;  ///< present: what says the same in other units stays as it is written
};

struct RemoveValue {
  EditPath path;
};

/// Renames a key. A task, rtpu, configuration, constant or variable gets the name in all places that name it.
struct RenameKey {
  EditPath path;
  std::string to;
  std::vector<TaskPort> ports;  ///< ports linked to the variable or constant by their own name; each gets an alias
  bool lacks_ports = false;     ///< `ports` is left out: name_ports() (verify/outline.h) fills it
};

struct AddTask {
  std::string name, component;
  std::string subsystem = "untitled";  ///< for a text without the key
};

/// Links a port to a variable by an alias. A variable with the name of the port needs none.
struct LinkPort {
  std::string task, port, variable;
  std::optional<std::size_t> instance;  ///< of a repeated port
};

enum class JoinBy : std::uint8_t { kMean, kPriority, kSelect };

/// Puts a joining component between a variable and its producers (1994 paper, figure 3).
struct JoinProducers {
  std::string variable;
  JoinBy by = JoinBy::kMean;
  std::vector<TaskPort> producers;  ///< output ports; a standby shares the input of its primary
  bool lacks_ports = false;         ///< `producers` is left out, as RenameKey::ports
};

using EditAct = std::variant<SetValue, RemoveValue, RenameKey, AddTask, LinkPort, JoinProducers>;

}  // namespace chimera
