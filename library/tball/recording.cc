// SPDX-License-Identifier: Apache-2.0
// Reads recorded input events from their text.
#include "library/tball/recording.h"

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "library/device/sentence.h"

namespace chimera::library {
namespace {

constexpr long long kLatestSecond = 4'000'000'000;  // on the clock of the recording machine

bool read_event(const char* line, RecordedEvent& to) {
  long long seconds = 0, micros = 0;
  unsigned type = 0, code = 0;
  int value = 0, used = 0, point = 0, end = 0;
  if (std::sscanf(line, "E: %lld.%n%lld%n %4x %4x %d %n", &seconds, &point, &micros, &end, &type, &code, &value,
                  &used) != 5)
    return false;
  if (end - point != 6 || seconds < 0 || seconds > kLatestSecond || micros < 0) return false;
  if (line[used] != '\0' && line[used] != '#') return false;
  to.at = Nanoseconds{seconds * 1'000'000'000 + micros * 1'000};
  to.event = {static_cast<std::uint16_t>(type), static_cast<std::uint16_t>(code), value};
  return true;
}

bool is_passed_over(const std::string& line) {
  return line.empty() || line[0] == '#' || (line.size() > 1 && line[1] == ':' && line[0] != 'E');
}

}  // namespace

std::vector<RecordedEvent> read_recording(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(open_refusal(path, errno));
  std::vector<RecordedEvent> events;
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    const std::string place = path + ":" + std::to_string(++number) + ": ";
    if (is_passed_over(line)) continue;
    RecordedEvent event;
    if (!read_event(line.c_str(), event))
      throw std::runtime_error(place + "no event: \"E: 0.008000 0002 0000 0120\" is one");
    if (!events.empty() && event.at < events.back().at) throw std::runtime_error(place + "the time goes back");
    if (events.size() == kMostRecordedEvents) throw std::runtime_error(place + "more than a million events");
    events.push_back(event);
  }
  if (events.empty()) throw std::runtime_error(path + ": there is no event in it");
  const Nanoseconds first = events.front().at;
  for (RecordedEvent& event : events) event.at = event.at - first;
  return events;
}

}  // namespace chimera::library
