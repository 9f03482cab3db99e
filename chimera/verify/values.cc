// SPDX-License-Identifier: Apache-2.0
// Converts written values to bytes: units, broadcast to the shape, and the range of the port.
#include "chimera/verify/values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "chimera/base/hosted/wording.h"
#include "chimera/description/draft_values.h"
#include "chimera/description/text_limits.h"
#include "chimera/runtime/plan/task_lists.h"
#include "chimera/text/nearest.h"
#include "chimera/units/quantity.h"

namespace chimera {
namespace {

/// The target of a scalar: a plain element or a field of a struct.
struct Cell {
  std::uint32_t type;
  std::uint32_t size;
  const Unit& unit;
  const std::string& unit_text;
  bool has_range = false;
  double min = 0, max = 0;
  std::span<const std::string> words{};  ///< the legal words of a text; empty: any
  bool names_configuration = false;      ///< a text is a configuration, lists of tasks, or empty
};

template <class T>
void store(std::byte* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

class ValueWriter {
 public:
  ValueWriter(Model& model, const ValueTarget& target) : model_(model), target_(target), port_(target.port) {}

  std::optional<std::vector<std::byte>> write(const Node& node) {
    bytes_.assign(std::size_t{element_count(port_.extents)} * port_.element_bytes, std::byte{0});
    fine_ = true;
    const bool is_list = node.is_list();
    if (!is_list)
      fill(node);
    else
      list(node, 0);
    if (!fine_) return std::nullopt;
    return std::move(bytes_);
  }

 private:
  void refuse(std::string_view rule, Place at, const std::string& message, std::string found, std::string expected,
              std::string near = {}, std::string remedy = {}) {
    fine_ = false;
    if (target_.is_quiet) return;
    const Spot spot = target_.set != nullptr ? Spot(at).in(*target_.set) : Spot(at, port_);
    model_.error(rule, spot, target_.what + ": " + message, std::move(found), std::move(expected), std::move(near),
                 std::move(remedy));
  }

  /// One value for every element.
  void fill(const Node& node) {
    element(node, bytes_.data());
    for (std::size_t at = port_.element_bytes; at < bytes_.size(); at += port_.element_bytes)
      std::memcpy(bytes_.data() + at, bytes_.data(), port_.element_bytes);
  }

  /// Packs rows by the number of written elements, as a component sees them.
  void list(const Node& node, std::size_t dimension) {
    if (dimension >= port_.extents.size()) {
      refuse("value-shape", node.at, "found a list; expected " + shape(dimension), "a list", shape(dimension));
      return;
    }
    const SolvedExtent& extent = port_.extents[dimension];
    const bool fits =
        extent.known ? node.items.size() == *extent.known : !node.items.empty() && node.items.size() <= extent.max;
    if (!fits) {
      const std::string expected = extent.known ? std::to_string(*extent.known) : "1 to " + std::to_string(extent.max);
      refuse("value-shape", node.at,
             "found a list of " + std::to_string(node.items.size()) + "; expected " + expected + " (shape " +
                 shape_text(port_.extents) + ")",
             std::to_string(node.items.size()), expected);
      return;
    }
    if (!extent.known && !extent.constant.empty() && !agrees(node, extent)) return;
    for (const Node& item : node.items) {
      if (dimension + 1 < port_.extents.size()) {
        row(item, dimension + 1);
      } else {
        element(item, bytes_.data() + next_);
        next_ += port_.element_bytes;
      }
    }
  }
  /// Lists for one constant extent must have one length; a short one would leave elements zero without a message.
  bool agrees(const Node& node, const SolvedExtent& extent) {
    const WrittenLength mine{node.items.size(), node.at};
    const WrittenLength& first = model_.written_lengths.try_emplace(extent.constant, mine).first->second;
    if (first.count == mine.count) return true;
    const std::string expected = std::to_string(first.count);
    refuse("value-shape", node.at,
           "found a list of " + std::to_string(mine.count) + "; expected " + expected + ", as in the list for '" +
               extent.constant + "' at " + Model::say(first.at),
           std::to_string(mine.count), expected);
    return false;
  }
  void row(const Node& node, std::size_t dimension) {
    if (node.is_list()) {
      list(node, dimension);
      return;
    }
    refuse("value-shape", node.at, "found " + written(node) + "; expected a list for each row", written(node),
           "a list");
  }

  std::string shape(std::size_t dimension) const { return dimension == 0 ? "one value" : "one value for each element"; }

  void element(const Node& node, std::byte* to) {
    if (*port_.type == CHIMERA_STRUCT) {
      fields(node, to);
      return;
    }
    const PortDescriptor& declared = *port_.declared;
    cell(node,
         {*port_.type, port_.element_bytes, *port_.unit, port_.unit_text, declared.has_range, declared.min,
          declared.max, declared.one_of, declared.names_configuration},
         to);
  }

  void fields(const Node& node, std::byte* to) {
    const PortDescriptor& declared = *port_.declared;
    const auto names = names_of(declared.fields, &FieldDescriptor::name);
    if (!node.is_map()) {
      refuse("value-type", node.at,
             "found " + written(node) + "; expected a map of the fields of " + declared.type_name, written(node),
             "a map", {}, "write {" + names[0] + ": ...} with the fields " + listed(names));
      return;
    }
    for (const Word& key : node.keys) {
      if (std::find(names.begin(), names.end(), key.text) != names.end()) continue;
      const std::string near = nearest(key.text, names);
      refuse("value-field", key.at, declared.type_name + " has no field '" + key.text + "'", key.text, listed(names),
             near, near.empty() ? "its fields: " + listed(names) : "");
    }
    for (const FieldDescriptor& field : declared.fields) {
      const Node* value = node.find(field.name);
      if (value != nullptr)
        this->field(*value, field, to + field.offset);
      else
        refuse("value-field", node.at, "field '" + field.name + "' of " + declared.type_name + " is missing", {},
               field.name, {}, "write " + field.name + ": ... too");
    }
  }
  void field(const Node& node, const FieldDescriptor& field, std::byte* to) {
    const auto unit = model_.library.units().parse(field.unit);
    const Unit one{};
    const Cell each{field.type, field.size, unit ? *unit : one, field.unit};
    if (!node.is_list()) {
      for (std::uint32_t i = 0; i < field.count; ++i) cell(node, each, to + std::size_t{i} * field.size);
    } else if (node.items.size() != field.count || field.count == 1) {
      refuse("value-shape", node.at,
             "field '" + field.name + "': found a list of " + std::to_string(node.items.size()) + "; expected " +
                 std::to_string(field.count),
             std::to_string(node.items.size()), std::to_string(field.count));
    } else {
      for (std::uint32_t i = 0; i < field.count; ++i) cell(node.items[i], each, to + std::size_t{i} * field.size);
    }
  }

  void cell(const Node& node, const Cell& cell, std::byte* to) {
    if (cell.type == CHIMERA_STRING) return string(node, cell, to);
    if (!node.is_scalar() || node.quoted) {
      const std::string wanted(cell.type == CHIMERA_BOOL ? "true or false" : "a number");
      refuse(node.is_list() ? "value-shape" : "value-type", node.at, "found " + written(node) + "; expected " + wanted,
             written(node), wanted, {}, node.quoted ? "take the quotes off" : "");
      return;
    }
    if (cell.type == CHIMERA_BOOL) return truth(node, to);
    number(node, cell, to);
  }

  void string(const Node& node, const Cell& cell, std::byte* to) {
    if (!node.is_scalar()) {
      refuse("value-type", node.at, "found " + written(node) + "; expected a text", written(node), "a text");
    } else if (node.text.find('\0') != std::string::npos) {
      refuse("text-encoding", node.at, "found a text with the byte 0", {}, "a text", {}, kNoZero);
    } else if (node.text.size() >= cell.size) {
      refuse("value-range", node.at,
             "found a text of " + std::to_string(node.text.size()) + " bytes; expected at most " +
                 std::to_string(cell.size - 1),
             node.text, "at most " + std::to_string(cell.size - 1) + " bytes");
    } else if (!cell.words.empty() && std::ranges::find(cell.words, node.text) == cell.words.end()) {
      const std::string words = listed(std::vector<std::string>(cell.words.begin(), cell.words.end()));
      refuse("word-unknown", node.at, "found " + written(node) + "; expected one of " + words, node.text, words,
             nearest(node.text, cell.words));
    } else if (!cell.names_configuration || node.text.empty() ||
               (has_lists(node.text) ? are_lists(node) : is_configuration(node))) {
      std::memcpy(to, node.text.data(), node.text.size());
    }
  }

  bool is_configuration(const Node& node) {
    const auto names = names_of(model_.sets, &SetModel::name);
    if (std::ranges::find(names, node.text) != names.end()) return true;
    refuse("configuration-unknown", node.at, "found " + written(node) + "; expected a configuration: " + listed(names),
           node.text, listed(names), nearest(node.text, names));
    return false;
  }

  /// "--on pid --off lqr".
  bool are_lists(const Node& node) {
    const auto find = [this](std::string_view name) {
      const auto task = model_.task_named(name);
      return task ? TaskId(*task) : TaskId{};
    };
    TaskLists lists;
    const ListsFault fault = read_lists(node.text, find, lists);
    if (fault.kind == ListsFault::Kind::kUnknownTask) {
      const auto names = names_of(model_.tasks, &TaskModel::name);
      const std::string word(fault.word);
      refuse("task-unknown", node.at, "found " + written(node) + ", and there is no task '" + word + "'", word,
             listed(names), nearest(word, names));
    } else if (fault) {
      refuse("configuration-unknown", node.at,
             "found " + written(node) + "; expected a configuration, or '--on TASK... --off TASK...'", node.text,
             "--on TASK... --off TASK...");
    }
    return !fault;
  }

  void truth(const Node& node, std::byte* to) {
    if (node.text == "true" || node.text == "false")
      store<std::uint8_t>(to, node.text == "true");
    else
      refuse("value-type", node.at, "found " + written(node) + "; expected true or false", node.text, "true or false",
             {},
             node.text == "yes" || node.text == "on"   ? "write true"
             : node.text == "no" || node.text == "off" ? "write false"
                                                       : "");
  }

  void number(const Node& node, const Cell& cell, std::byte* to) {
    if (node.text == "true" || node.text == "false")
      return refuse("value-type", node.at, "found " + written(node) + "; expected a number", node.text, "a number");
    const auto quantity = parse_quantity(node.text, model_.library.units());
    if (!quantity)
      return refuse("quantity-bad", node.at, std::string(quantity.error().message.view()), node.text, "a quantity");
    const auto value = value_in(*quantity, cell.unit, cell.unit_text);
    if (!value && value.error().code == ErrorCode::kRefused) return refuse_infinite(node, cell);
    if (!value)
      return refuse("value-unit", node.at, std::string(value.error().message.view()), quantity->unit_text,
                    cell.unit_text);
    if (!std::isfinite(*value) && !may_be_infinite(cell, *value)) return refuse_infinite(node, cell);
    if (cell.type == CHIMERA_INT32 || cell.type == CHIMERA_INT64)
      integer(node, cell, *value, to);
    else
      real(node, cell, *value, to);
  }

  /// True for a constant with a declared range that ends at infinity: its component handles it.
  bool may_be_infinite(const Cell& cell, double value) const {
    if (!port_.is(CHIMERA_IN_CONST) || !cell.has_range) return false;
    return value == cell.min || value == cell.max;
  }

  void refuse_infinite(const Node& node, const Cell& cell) {
    refuse("value-range", node.at, "found " + written(node) + ", which is not finite in \"" + cell.unit_text + "\"",
           node.text, "a finite number", {}, "write a finite number");
  }

  bool in_range(const Node& node, const Cell& cell, double value) {
    const auto text = [](double x) {
      char out[32];
      return std::string(out, std::to_chars(out, out + sizeof out, x).ptr);
    };
    if (target_.is_step && !(value > 0)) {
      refuse("value-range", node.at, "found " + written(node) + "; expected more than 0", node.text, "above 0");
      return false;
    }
    if (!cell.has_range || target_.is_step || (value >= cell.min && value <= cell.max)) return true;
    const std::string range = with_unit(text(cell.min) + " to " + text(cell.max), cell.unit_text);
    refuse("value-range", node.at, "found " + written(node) + "; expected " + range, node.text, range);
    return false;
  }

  void integer(const Node& node, const Cell& cell, double value, std::byte* to) {
    const bool narrow = cell.type == CHIMERA_INT32;
    const double limit = narrow ? 2147483648.0 : 9223372036854775808.0;
    std::int64_t exact = 0;
    const auto [end, fault] = std::from_chars(node.text.data(), node.text.data() + node.text.size(), exact);
    const bool as_written = fault == std::errc{} && end == node.text.data() + node.text.size();
    if (!as_written && (value != std::floor(value) || !std::isfinite(value)))
      return refuse("value-type", node.at, "found " + written(node) + "; expected a whole number", node.text,
                    "a whole number");
    if (!as_written && value >= -limit && value < limit) exact = static_cast<std::int64_t>(value);
    const bool fits = narrow ? value >= -limit && value < limit : as_written || (value >= -limit && value < limit);
    if (!fits)
      return refuse("value-range", node.at,
                    "found " + written(node) + "; expected a number that fits " + std::string(type_name(cell.type)),
                    node.text, std::string(type_name(cell.type)));
    if (!in_range(node, cell, value)) return;
    if (narrow)
      store(to, static_cast<std::int32_t>(exact));
    else
      store(to, exact);
  }

  void real(const Node& node, const Cell& cell, double value, std::byte* to) {
    if (!in_range(node, cell, value)) return;
    if (cell.type == CHIMERA_FLOAT64) return store(to, value);
    if (std::isfinite(value) && std::fabs(value) > std::numeric_limits<float>::max())
      return refuse("value-range", node.at, "found " + written(node) + "; expected a number that fits float32",
                    node.text, "float32");
    store(to, static_cast<float>(value));
  }

  Model& model_;
  const ValueTarget& target_;
  const LinkedPort& port_;
  std::vector<std::byte> bytes_;
  std::size_t next_ = 0;
  bool fine_ = true;
};

}  // namespace

std::optional<std::vector<std::byte>> value_bytes(Model& model, const Node& node, const ValueTarget& target) {
  return ValueWriter(model, target).write(node);
}

std::string value_name(const Model& model, const LinkedPort& port) {
  const std::string key = port.is(CHIMERA_IN_CONST) ? "constant '" : "initial value '";
  return key + port.declared->name + "' of task '" + model.tasks[port.task].name() + "'";
}

std::string value_name(const VariableModel& variable) {
  return (variable.is_constant ? "constant '" : "operator variable '") + variable.name + "'";
}

bool is_solved(const LinkedPort& port) {
  return port.type && port.has_extents && (port.unit || *port.type == CHIMERA_STRUCT);
}

std::vector<std::byte> declared_bytes(const LinkedPort& port) {
  const std::vector<std::byte>& initial = port.declared->initial;
  if (initial.empty()) return {};
  std::vector<std::byte> out(std::size_t{element_count(port.extents)} * port.element_bytes);
  if (initial.size() == port.element_bytes)
    for (std::size_t at = 0; at < out.size(); at += port.element_bytes)
      std::memcpy(out.data() + at, initial.data(), port.element_bytes);
  else
    std::memcpy(out.data(), initial.data(), std::min(out.size(), initial.size()));
  return out;
}

std::uint32_t element_count(std::span<const SolvedExtent> extents) {
  std::uint32_t count = 1;
  for (const SolvedExtent& extent : extents) count *= extent.max;
  return count;
}

std::string shape_text(std::span<const SolvedExtent> extents) {
  std::string out;
  for (const SolvedExtent& extent : extents) {
    const std::string max = std::to_string(extent.max);
    const std::string count = extent.known ? std::to_string(*extent.known) : "<=" + max;
    out += '[' + (extent.constant.empty() ? count : extent.constant + "<=" + max) + ']';
  }
  return out;
}

}  // namespace chimera
