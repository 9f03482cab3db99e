// SPDX-License-Identifier: Apache-2.0
// Numeric addresses of devices on the network.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>

#include <cstdint>
#include <string>

namespace chimera::library {

/// The address "ADDRESS:PORT", such as "192.168.0.7:5000"; its port is 0 if the text is none. Context: setup; no name
/// lookup.
inline sockaddr_in net_address(const std::string& text) {
  sockaddr_in made{};
  made.sin_family = AF_INET;
  const std::size_t colon = text.rfind(':');
  const std::string digits = colon == std::string::npos ? "" : text.substr(colon + 1);
  if (digits.empty() || digits.size() > 5 || digits.find_first_not_of("0123456789") != std::string::npos) return made;
  const int port = std::stoi(digits);
  if (port > 65535 || ::inet_pton(AF_INET, text.substr(0, colon).c_str(), &made.sin_addr) != 1) return made;
  made.sin_port = htons(static_cast<std::uint16_t>(port));
  return made;
}

}  // namespace chimera::library
