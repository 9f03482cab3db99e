// SPDX-License-Identifier: Apache-2.0
// Describes in words at which step of making a task a process died.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace chimera {

/// Describes a word of show_making(): "while it loaded /lib/gain.so, the component of task 'amp'". Context: setup.
std::string making_text(std::uint32_t word, std::string_view task, std::string_view object);

}  // namespace chimera
