// SPDX-License-Identifier: Apache-2.0
// The right name nearest to a wrong one, for every message that can offer one.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace chimera {

/// Letters to insert, delete, replace or swap with their neighbour to make `b` of `a`. Context: setup; may block.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The name nearest to `wrong` (the first of equals), or "" when none is within a third of its length
/// (at least 1 letter, at most 3); then the first that begins with `wrong`, of 3 letters or more. A name that differs
/// in case alone is near. Context: setup; may block.
std::string nearest(std::string_view wrong, std::span<const std::string> names);

/// "; did you mean 'near'?" for the end of a message, with double quotes where the message has them; "" if `near` is
/// empty. Context: setup; may block.
std::string did_you_mean(std::string_view near, char quote = '\'');

/// "no task 'pdi'; did you mean 'pid'?": `what` is the kind of thing. Context: setup; may block.
std::string no_such(std::string_view what, std::string_view wrong, std::span<const std::string> names);

}  // namespace chimera
