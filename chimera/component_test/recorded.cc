// SPDX-License-Identifier: Apache-2.0
// Strictly reads a recording in the form of csv_log.
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>

#include "chimera/base/hosted/recording_text.h"
#include "chimera/base/message.h"
#include "chimera/component_test/inputs.h"

namespace chimera::component_test {
namespace {

struct RecordingPlace {
  const std::string& file;
  std::size_t line = 1, column = 1;

  Error refuse(const Message& message) const {
    return message.error(ErrorCode::kBadInput, file + ":" + std::to_string(line) + ":" + std::to_string(column));
  }
};

// "in[1][2]" becomes "NAME[2]" if names[1] is NAME.
std::string renamed(std::string_view word, std::span<const std::string> names) {
  if (names.empty() || !word.starts_with("in[")) return std::string(word);
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(word.data() + 3, word.data() + word.size(), number);
  if (error != std::errc{} || end == word.data() + word.size() || *end != ']' || number >= names.size())
    return std::string(word);
  return names[number] + std::string(end + 1, word.data() + word.size());
}

const InputChannel* find(const InputForm& form, const std::string& name) {
  for (const InputChannel& channel : form.channels)
    if (channel.name == name || channel.port_name == name) return &channel;
  return nullptr;
}

Result<std::vector<const InputChannel*>> read_head(const InputForm& form, std::string_view line,
                                                   std::span<const std::string> names, RecordingPlace place) {
  if (const std::string why = foreign_head(line); !why.empty()) return place.refuse(Message() << why);
  const auto words = fields_of(line);
  if (words.size() > kMaxColumns)
    return place.refuse(Message() << words.size() << " columns, at most " << kMaxColumns << " are read");
  std::vector<const InputChannel*> columns;
  for (std::size_t i = 1; i < words.size(); ++i) {
    place.column += words[i - 1].size() + 1;
    const ColumnHead heading = column_head(words[i]);
    const std::string name = renamed(heading.name, names);
    const InputChannel* channel = find(form, name);
    if (channel == nullptr) return place.refuse(Message() << "no in-var of the component is called '" << name << "'");
    if (!heading.unit.empty() && heading.unit != channel->unit)
      return place.refuse(Message() << "'" << name << "' is in " << heading.unit << ", and the port takes "
                                    << channel->unit);
    for (const InputChannel* other : columns)
      if (other == channel) return place.refuse(Message() << "'" << name << "' is there twice");
    columns.push_back(channel);
  }
  return columns;
}

Result<std::optional<double>> read_number(std::string_view field, const RecordingPlace& place) {
  if (field.empty()) return std::optional<double>{};
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc{} || end != field.data() + field.size())
    return place.refuse(Message() << "'" << field.substr(0, 40) << "' is no number");
  return std::optional(value);
}

/// Reads the rows of the file unchanged, with their times.
struct RecordingReader {
  const InputForm& form;
  std::vector<const InputChannel*> columns;
  std::vector<double> times{};
  std::vector<std::byte> rows{};

  Result<void> read(std::string_view line, RecordingPlace place) {
    if (const std::string why = foreign_line(line); !why.empty()) return place.refuse(Message() << why);
    const auto fields = fields_of(line);
    if (fields.size() != columns.size() + 1)
      return place.refuse(Message() << fields.size() << " fields, expected " << columns.size() + 1);
    const auto time = read_number(fields[0], place);
    if (!time) return time.error();
    if (!*time || !std::isfinite(**time) || (!times.empty() && **time <= times.back()))
      return place.refuse(Message() << "the time does not grow");
    const std::size_t begin = rows.size();
    std::vector<std::byte> row = form.base;
    if (!times.empty()) row.assign(rows.end() - static_cast<std::ptrdiff_t>(form.bytes()), rows.end());
    for (std::size_t i = 0; i < columns.size(); ++i) {
      place.column += fields[i].size() + 1;
      const auto value = read_number(fields[i + 1], place);
      if (!value) return value.error();
      if (*value) form.put(*columns[i], **value, row);
    }
    rows.resize(begin + form.bytes());
    if (form.bytes() > 0) std::memcpy(rows.data() + begin, row.data(), form.bytes());
    times.push_back(**time);
    return {};
  }
};

Result<void> read_all(RecordingReader& reader, std::string_view text, std::span<const std::string> names,
                      RecordingPlace place) {
  for (; !text.empty(); ++place.line) {
    const std::string_view raw = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), raw.size() + 1));
    const std::string_view line = recording_line(raw);
    if (place.line == 1) {
      auto columns = read_head(reader.form, line, names, place);
      if (!columns) return columns.error();
      reader.columns = *std::move(columns);
      continue;
    }
    if (reader.times.size() == kMaxRows) return place.refuse(Message() << "more than " << kMaxRows << " rows");
    if (const auto read = reader.read(line, place); !read) return read;
  }
  if (reader.times.empty()) return place.refuse(Message() << "no row of values");
  return {};
}

}  // namespace

Result<Inputs> Inputs::recorded(const InputForm& form, std::string_view text, const std::string& file,
                                std::span<const std::string> names, Nanoseconds period, std::size_t least) {
  if (text.size() > kMaxRecordingBytes)
    return RecordingPlace{file}.refuse(Message()
                                       << text.size() << " bytes, at most " << kMaxRecordingBytes << " are read");
  RecordingReader reader{form, {}};
  if (const auto read = read_all(reader, text, names, {file}); !read) return read.error();
  const double length = reader.times.back() - reader.times.front();
  const double cycles = length / to_seconds(period) + 1.5;
  const std::size_t rows = std::max(least, static_cast<std::size_t>(std::min(cycles, static_cast<double>(kMaxRows))));
  Inputs made(rows, form.bytes());
  made.are_recorded_ = true;
  for (std::size_t i = 0, at = 0; i < rows; ++i) {
    const double now = reader.times.front() + static_cast<double>(i) * to_seconds(period) + 1e-9;
    while (at + 1 < reader.times.size() && reader.times[at + 1] <= now) ++at;
    if (form.bytes() > 0) std::memcpy(made.writable(i).data(), reader.rows.data() + at * form.bytes(), form.bytes());
  }
  return made;
}

}  // namespace chimera::component_test
