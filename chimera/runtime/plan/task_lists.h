// SPDX-License-Identifier: Apache-2.0
// Tasks that are to be ON and tasks that are not, in place of the name of a configuration: "--on A B --off C", as
// `chimera switch`, `--at` and Cycle::request() take it. runtime/hosted/asked_set.h finds the set that they lead to.
#pragma once

#include <string_view>

#include "chimera/runtime/plan/switch_agreement.h"

namespace chimera {

/// Plain value.
struct TaskLists {
  TaskBits plus;   ///< behind `--on`
  TaskBits minus;  ///< behind `--off`

  constexpr bool are_there() const noexcept { return *this != TaskLists{}; }
  /// Nothing changes where these tasks are ON.
  constexpr bool are_met_by(const TaskBits& on) const noexcept {
    for (std::size_t i = 0; i < on.words.size(); ++i)
      if ((plus.words[i] & ~on.words[i]) != 0 || (minus.words[i] & on.words[i]) != 0) return false;
    return true;
  }
  constexpr bool operator==(const TaskLists&) const noexcept = default;
};

/// The text names tasks, and no configuration, whose name never begins so.
constexpr bool has_lists(std::string_view text) noexcept { return text.starts_with('-'); }

/// Fault in a text of lists.
struct ListsFault {
  enum class Kind : std::uint8_t { kNone, kEmpty, kOutOfPlace, kUnknownTask };
  Kind kind = Kind::kNone;
  std::string_view word;  ///< that is not a task, or neither `--on` nor `--off`

  constexpr explicit operator bool() const noexcept { return kind != Kind::kNone; }
};

/// Reads "--on A B --off C"; `find(word)` answers the TaskId, one that is not valid where there is none of the name.
/// Context: any; wait-free where `find` is.
template <class Find>
constexpr ListsFault read_lists(std::string_view text, Find find, TaskLists& lists) noexcept {
  constexpr auto is_blank = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
  TaskBits* list = nullptr;
  for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1) {
    for (end = at; end < text.size() && !is_blank(text[end]);) ++end;
    const std::string_view word = text.substr(at, end - at);
    if (word.empty()) continue;
    if (word == "--on" || word == "--off") {
      list = word == "--on" ? &lists.plus : &lists.minus;
    } else if (list == nullptr || word.starts_with("--")) {
      return {ListsFault::Kind::kOutOfPlace, word};
    } else if (const TaskId task = find(word); task.is_valid()) {
      list->add(task);
    } else {
      return {ListsFault::Kind::kUnknownTask, word};
    }
  }
  return {lists.are_there() ? ListsFault::Kind::kNone : ListsFault::Kind::kEmpty, {}};
}

}  // namespace chimera
