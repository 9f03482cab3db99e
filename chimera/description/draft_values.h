// SPDX-License-Identifier: Apache-2.0
// Turns one written value into one typed value, or into one fault: the text found and the form expected. `what` names
// the value in messages: "'rate' of task 'pid'".
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "chimera/base/time.h"
#include "chimera/description/draft.h"
#include "chimera/description/node.h"
#include "chimera/description/report.h"

namespace chimera {

/// A letter or '_', then letters, digits, '_'; at most 64 bytes. Context: any.
bool is_name(std::string_view text) noexcept;

/// "nothing", "a list", "a map", "'1 kHz'": for messages. Context: setup.
std::string written(const Node& node);

/// Each of these functions returns nullopt after adding one fault to `report`. Context: setup.
std::optional<Word> read_name(const Node& node, const std::string& what, Report& report);
/// Checks that a key or a list item is a name.
bool check_name(const Word& word, const std::string& what, Report& report);
/// Any scalar, as text.
std::optional<Word> read_text(const Node& node, const std::string& what, Report& report);
std::optional<Located<Rate>> read_rate(const Node& node, const std::string& what, Report& report);
std::optional<Located<Nanoseconds>> read_duration(const Node& node, const std::string& what, Report& report);
std::optional<Located<std::uint32_t>> read_whole(const Node& node, std::uint32_t min, std::uint32_t max,
                                                 const std::string& what, Report& report);
std::optional<Located<std::uint64_t>> read_bytes(const Node& node, std::uint64_t min, std::uint64_t max,
                                                 const std::string& what, Report& report);
/// One of `words`, as its index.
std::optional<Located<std::size_t>> read_choice(const Node& node, std::span<const std::string_view> words,
                                                const std::string& what, Report& report);
/// False, with a fault, if `node` is not of `kind`. With `may_be_nothing`, an empty node is legal too.
bool expect(const Node& node, Node::Kind kind, const std::string& what, Report& report, bool may_be_nothing = false);
/// One fault for each key that is not in `keys`.
void refuse_unknown_keys(const Node& map, std::span<const std::string_view> keys, const std::string& what,
                         Report& report);

/// "'a', 'b', 'c'". Context: setup.
std::string listed(std::span<const std::string_view> names);
std::string listed(std::span<const std::string> names);
/// The name most like `word`; empty if none is close. Context: setup.
std::string closest(std::string_view word, std::span<const std::string_view> names);

}  // namespace chimera
