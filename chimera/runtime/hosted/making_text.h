// SPDX-License-Identifier: Apache-2.0
// At which step of making a task a process died, in words.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace chimera {

/// Of a word that show_making() wrote: "while it loaded /lib/gain.so, the component of task 'amp'". Context: setup.
std::string making_text(std::uint32_t word, std::string_view task, std::string_view object);

}  // namespace chimera
