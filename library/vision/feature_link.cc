// SPDX-License-Identifier: Apache-2.0
// Opens a datagram socket by its address, and reads and writes lines of features.
#include "library/vision/feature_link.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "library/device/recording_file.h"

namespace chimera::library {
namespace {

constexpr char kHeader[] = "t,u,v,size";

Error bad(const std::string& text) {
  Error error;
  error.message = FixedString<400>(text);
  return error;
}

Error refused_by_system(const std::string& link) { return bad(link + ": " + std::strerror(errno)); }

/// An IPv4 or Unix address.
struct Address {
  sockaddr_storage storage{};
  socklen_t size = 0;
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

Result<Address> internet_address(const std::string& link) {
  const std::size_t colon = link.rfind(':');
  sockaddr_in to{};
  to.sin_family = AF_INET;
  unsigned port = 0;
  const char* end = link.data() + link.size();
  const auto [stop, error] = std::from_chars(link.data() + colon + 1, end, port);
  const bool is_port = error == std::errc() && stop == end && port >= 1 && port <= 65535;
  if (colon <= 4 || !is_port || ::inet_pton(AF_INET, link.substr(4, colon - 4).c_str(), &to.sin_addr) != 1) {
    return bad(link + ": expected udp:ADDRESS:PORT, as udp:127.0.0.1:5600");
  }
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  Address address;
  std::memcpy(&address.storage, &to, sizeof to);
  address.size = sizeof to;
  return address;
}

Result<Address> local_address(const std::string& link) {
  const std::string path = link.substr(5);
  sockaddr_un to{};
  to.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof to.sun_path) return bad(link + ": expected unix:PATH of 1 to 107 bytes");
  path.copy(to.sun_path, path.size());
  if (path[0] == '@') to.sun_path[0] = '\0';
  Address address;
  std::memcpy(&address.storage, &to, sizeof to);
  address.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size());
  return address;
}

/// A unique abstract address.
Result<Address> own_address(const std::string& link) {
  const std::string name = link.substr(5);
  if (name.empty() || name.size() > 64) return bad(link + ": expected here:NAME of 1 to 64 bytes");
  return local_address("unix:@" + name + "." + std::to_string(::getpid()));
}

Result<Address> address_of(const std::string& link) {
  if (link.starts_with("udp:")) return internet_address(link);
  if (link.starts_with("unix:")) return local_address(link);
  if (link.starts_with("here:")) return own_address(link);
  return bad(link + ": expected udp:ADDRESS:PORT, unix:PATH, here:NAME or file:PATH");
}

int datagram_socket(const Address& address) {
  return ::socket(address.storage.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

}  // namespace

std::size_t feature_text(const Feature& f, char (&text)[96]) {
  const std::pair<double, int> numbers[] = {{f.time, 6}, {f.u, 4}, {f.v, 4}, {f.size, 5}};
  char* at = text;
  for (const auto& [number, digits] : numbers) {
    if (at != text) *at++ = ',';
    const auto [end, error] = std::to_chars(at, text + sizeof text - 2, number, std::chars_format::fixed, digits);
    if (error != std::errc()) return 0;
    at = end;
  }
  *at = '\0';
  return static_cast<std::size_t>(at - text);
}

bool read_feature(const char* text, Feature& feature) {
  double numbers[4];
  const char* at = text;
  const char* end = text + std::strlen(text);
  for (std::size_t i = 0; i < 4; ++i) {
    if (i > 0 && (at == end || *at++ != ',')) return false;
    const auto [stop, error] = std::from_chars(at, end, numbers[i]);
    if (error != std::errc() || !std::isfinite(numbers[i])) return false;
    at = stop;
  }
  if (at != end) return false;
  feature = {numbers[0], numbers[1], numbers[2], numbers[3]};
  return true;
}

Result<void> FeatureWriter::open(const std::string& link) {
  close();
  records_ = link.starts_with("file:");
  if (records_) {
    try {
      RecordingFile opened = open_recording(link.substr(5));
      file_ = opened.file, note_ = other_path_note(link.substr(5), opened.path);
    } catch (const std::runtime_error& error) {
      return bad(error.what());
    }
    const std::string head = std::string(kHeader) + "\n";
    if (::write(file_, head.data(), head.size()) < 0) return refused_by_system(link);
    return {};
  }
  const Result<Address> to = address_of(link);
  if (!to) return to.error();
  const auto* bytes = reinterpret_cast<const std::byte*>(&to->storage);
  to_.assign(bytes, bytes + to->size);
  file_ = datagram_socket(*to);
  if (file_ < 0) return refused_by_system(link);
  return {};
}

void FeatureWriter::flush() {
  Feature feature;
  char text[96];
  while (ring_.take(feature)) {
    const std::size_t n = feature_text(feature, text);
    if (n == 0) continue;
    if (records_) {
      text[n] = '\n';
      if (::write(file_, text, n + 1) < 0) return;
    } else {
      ::sendto(file_, text, n, MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(to_.data()),
               static_cast<socklen_t>(to_.size()));
    }
  }
}

void FeatureWriter::close() {
  if (file_ >= 0) ::close(std::exchange(file_, -1));
}

Result<void> FeatureReader::play(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  if (!file) return bad(path + ": cannot be read");
  recording_.clear();
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    if (number == 1 && line != kHeader)
      return bad(path + ":1: expected the head " + std::string(kHeader) + ", found '" + line + "'");
    if (number == 1 || line.empty() || line[0] == '#') continue;
    Feature feature;
    const double before = recording_.empty() ? 0 : recording_.back().time;
    if (!read_feature(line.c_str(), feature) || feature.time < before) {
      return bad(path + ":" + std::to_string(number) + ": expected t,u,v,size with rising t, found '" + line + "'");
    }
    recording_.push_back(feature);
  }
  if (recording_.empty()) return bad(path + ": there is nothing in this recording");
  return {};
}

Result<void> FeatureReader::open(const std::string& link) {
  close();
  if (link.starts_with("file:")) return play(link.substr(5));
  const Result<Address> at = address_of(link);
  if (!at) return at.error();
  file_ = datagram_socket(*at);
  if (file_ < 0 || ::bind(file_, at->get(), at->size) != 0) {
    const Error error = refused_by_system(link);
    close();
    return error;
  }
  if (link.starts_with("unix:") && link[5] != '@') unlink_ = link.substr(5);
  return {};
}

bool FeatureReader::take(double elapsed, Feature& feature) noexcept {
  if (recording_.empty()) return ring_.take(feature);
  if (next_ >= recording_.size() || recording_[next_].time > elapsed + 1e-9) return false;
  feature = recording_[next_++];
  return true;
}

void FeatureReader::drain() {
  if (file_ < 0) return;
  char text[96];
  for (int i = 0; i < 64; ++i) {
    const ssize_t n = ::recv(file_, text, sizeof text - 1, MSG_DONTWAIT);
    if (n < 0) return;
    text[n] = '\0';
    Feature feature;
    if (!read_feature(text, feature)) refused_.fetch_add(1, std::memory_order_relaxed);
    else if (!ring_.put(feature)) return;
  }
}

void FeatureReader::close() {
  if (file_ >= 0) ::close(std::exchange(file_, -1));
  if (!unlink_.empty()) ::unlink(std::exchange(unlink_, {}).c_str());
  recording_.clear();
}

}  // namespace chimera::library
