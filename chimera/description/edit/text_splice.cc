// SPDX-License-Identifier: Apache-2.0
// Compares two trees part by part and makes a splice of each difference, in the style of the text around it.
#include "chimera/description/edit/text_splice.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "chimera/description/edit/text_places.h"
#include "chimera/description/yaml_words.h"

namespace chimera {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

struct Splice {
  std::size_t from = 0, to = 0;
  std::string with;
};

/// How the text around a value is written.
struct Style {
  bool in_brackets = false;
  bool block = false;      ///< a new map as value gets lines of its own; a list of maps gets them anyway
  std::size_t indent = 0;  ///< of the entry; of such lines: `inner` more
  std::size_t inner = 2;
  bool is_root = false;
};

/// The parts of a list or map before and after.
struct PartsChange {
  const Node& old;
  const Node& now;
  std::vector<TextPart> parts;    // of `old`
  std::vector<std::size_t> from;  // index in `old` of each part of `now`; kNone: new
  std::vector<bool> stays;        // each part of `old`
};

std::vector<std::size_t> paired(const Node& old, const Node& now) {
  std::vector<std::size_t> from(now.items.size(), kNone);
  const auto place = [](const Node& node, std::size_t i) { return node.is_map() ? node.keys[i].at : node.items[i].at; };
  std::size_t next = 0;
  for (std::size_t i = 0; i < now.items.size(); ++i) {
    if (place(now, i).line == 0) continue;
    while (next < old.items.size() && place(old, next) != place(now, i)) ++next;
    if (next < old.items.size()) from[i] = next++;
  }
  return from;
}

/// True if a new value of a key gets lines of its own.
bool has_lines(const Node& value, const Style& style) {
  const auto is_filled_map = [](const Node& node) { return node.is_map() && !node.items.empty(); };
  if (style.in_brackets || value.items.empty()) return false;
  return value.is_list() ? std::ranges::all_of(value.items, is_filled_map) : style.block && is_filled_map(value);
}

class Splicer {
 public:
  Splicer(std::string_view text, const Report& faults) : places_(text), faults_(faults) {}

  void root(const Node& old, const Node& now) {
    if (is_same(old, now)) return;
    if (!now.is_map() || now.items.empty())
      return refuse({}, "no key would be left in the text: remove the file instead");
    if (!old.is_none()) return value(old, now, {}, {.block = true, .is_root = true});
    const std::string_view text = places_.text();
    const std::string end(places_.line_break(text.size()));
    std::string added = text.empty() || text.ends_with('\n') ? "" : end;
    for (std::size_t i = 0; i < now.items.size(); ++i) added += entry(now, i, {.block = true}, end) + end;
    splice(text.size(), text.size(), added);
  }

  Result<std::string> result() {
    if (refusal_) return *refusal_;
    std::stable_sort(splices_.begin(), splices_.end(), [](const Splice& a, const Splice& b) {
      return a.from != b.from ? a.from < b.from : (a.from == a.to) > (b.from == b.to);
    });
    std::string all;
    std::size_t at = 0;
    for (const Splice& one : splices_) {
      all.append(places_.text(), at, one.from > at ? one.from - at : 0).append(one.with);
      at = std::max(at, one.to);
    }
    return all.append(places_.text(), std::min(at, places_.text().size()));
  }

 private:
  void refuse(Place at, const std::string& message) {
    if (refusal_) return;
    const std::string where = at.line == 0 ? "" : std::to_string(at.line) + ":" + std::to_string(at.column);
    refusal_ = Error{ErrorCode::kRefused, {message}, {where}};
  }
  void refuse_form(Place at) {
    refuse(at, "this place is written in a form that no edit follows: edit the text by hand");
  }

  /// Refuses if a fault of the text lies within.
  void touch(std::size_t from, std::size_t to) {
    for (const Fault& fault : faults_.faults()) {
      const std::size_t at = places_.offset_of(fault.at);
      if (fault.at.line != 0 && at >= from && at < to) refuse(fault.at, sentence(fault));
    }
  }
  void splice(std::size_t from, std::size_t to, std::string with) {
    touch(from, to);
    splices_.push_back({from, to, std::move(with)});
  }
  /// Removes whole lines. A text without a last line end has none afterwards: the one before the lines goes instead.
  void remove_lines(std::size_t from, std::size_t to) {
    const std::size_t begin = places_.line_begin(from), end = places_.next_line(to);
    const bool is_open = end == places_.text().size() && !places_.text().ends_with('\n');
    splice(is_open ? places_.break_before(begin) : begin, end, "");
  }

  // ---- words ----

  std::string key_words(const std::string& key, bool in_brackets) const {
    return needs_quotes(key, in_brackets) ? quoted_words(key, '"') : key;
  }

  /// An entry of a map or list, from its key or dash to its end; `line_break` is as the text has them.
  std::string entry(const Node& parent, std::size_t i, const Style& style, std::string_view line_break) const {
    const Node& item = parent.items[i];
    const std::string words = written_text(item, style.in_brackets);
    if (parent.is_list()) return (style.in_brackets ? "" : "- ") + words;
    const std::string key = key_words(parent.keys[i].text, style.in_brackets) + ":";
    if (has_lines(item, style)) return key + lines_of(item, style, line_break);
    return words.empty() ? key : key + " " + words;
  }
  /// The entries of a map or list in lines of their own, each behind a line end.
  std::string lines_of(const Node& parts, const Style& style, std::string_view line_break) const {
    std::string all;
    const Style inner{.indent = style.indent + style.inner};
    for (std::size_t i = 0; i < parts.items.size(); ++i)
      all.append(line_break).append(inner.indent, ' ').append(entry(parts, i, inner, line_break));
    return all;
  }

  // ---- values ----

  void value(const Node& old, const Node& now, const TextPart& part, const Style& style) {
    if (old.kind != now.kind || old.is_scalar() || old.items.empty()) return replace(old, now, part, style);
    auto parts = places_.parts_of(old);
    if (!parts) return refuse_form(old.at);
    PartsChange change{old, now, *std::move(parts), paired(old, now), std::vector<bool>(old.items.size(), false)};
    for (const std::size_t from : change.from)
      if (from != kNone) change.stays[from] = true;
    if (std::find(change.stays.begin(), change.stays.end(), true) != change.stays.end())
      return change_parts(change, style);
    if (style.is_root) return refuse_form(old.at);
    if (!now.items.empty()) return replace(old, now, part, style);
    if (places_.has_brackets(old)) return remove_in_brackets(change, 0, change.parts.size() - 1);
    if (places_.is_same_line(part.value, part.after)) return replace(old, now, part, style);
    splice(part.after, part.after, " " + written_text(now));
    remove_block(change, 0, change.parts.size() - 1);
  }

  void change_parts(const PartsChange& change, const Style& style) {
    const bool brackets = places_.has_brackets(change.old);
    Style inner{.in_brackets = brackets || style.in_brackets, .indent = column_of(change.parts[0].begin)};
    for (std::size_t i = 0; i < change.now.items.size(); ++i) {
      const std::size_t from = change.from[i];
      if (from == kNone) continue;
      if (change.now.is_map()) rename(change.parts[from], change.old.keys[from], change.now.keys[i]);
      if (is_same(change.old.items[from], change.now.items[i])) continue;
      inner.block = has_block_near(change, from, inner.inner) || style.is_root;
      value(change.old.items[from], change.now.items[i], change.parts[from], inner);
    }
    for (std::size_t i = 0, end = 0; i < change.stays.size(); i = end + 1) {
      for (end = i; end < change.stays.size() && !change.stays[end];) ++end;
      if (end > i) inner.in_brackets ? remove_in_brackets(change, i, end - 1) : remove_block(change, i, end - 1);
    }
    for (std::size_t i = 0, end = 0; i < change.from.size(); i = end + 1) {
      for (end = i; end < change.from.size() && change.from[end] == kNone;) ++end;
      if (end > i) insert(change, i, end, inner, style.is_root);
    }
  }

  std::size_t column_of(std::size_t at) const { return at - places_.line_begin(at); }

  /// True if the map nearest to position `at` has lines of its own; `inner` is then how far they are indented.
  bool has_block_near(const PartsChange& change, std::size_t at, std::size_t& inner) const {
    for (std::size_t distance = 0; change.old.is_map() && distance < change.parts.size(); ++distance)
      for (const std::size_t i : {at - distance - 1, at + distance}) {
        if (i >= change.parts.size() || !change.old.items[i].is_map() || change.old.items[i].items.empty()) continue;
        if (places_.has_brackets(change.old.items[i])) return false;
        const std::size_t outer = column_of(change.parts[i].begin), column = column_of(change.parts[i].value);
        inner = column > outer ? column - outer : 2;
        return true;
      }
    return false;
  }

  void rename(const TextPart& part, const Word& old, const Word& now) {
    if (old.text == now.text) return;
    const char quote = places_.text()[part.begin];
    const bool is_quoted = quote == '"' || quote == '\'';
    splice(part.begin, part.key_end, is_quoted ? quoted_words(now.text, quote) : key_words(now.text, true));
  }

  void replace(const Node& old, const Node& now, const TextPart& part, const Style& style) {
    touch(part.after, old.is_none() ? places_.line_end(part.end) : part.end);
    const std::size_t end_of_line = places_.line_end(part.end);
    const bool is_in_lines = has_lines(now, style);
    const std::string words = written_text(now, style.in_brackets);
    if (old.is_none()) {
      if (part.end > part.after) return splice(places_.skip_blanks(part.after), part.end, words);
      if (is_in_lines) return splice(end_of_line, end_of_line, lines_of(now, style, places_.line_break(part.after)));
      return splice(part.after, part.after, (part.has_colon ? " " : ": ") + words);
    }
    if (old.is_scalar()) {
      const char quote = places_.text()[part.value];
      const bool keeps_quote = quote == '\'' && now.is_scalar() && now.quoted;
      return splice(part.value, part.end, keeps_quote ? quoted_words(now.text, quote) : words);
    }
    if (old.items.empty() && is_in_lines) {  // empty brackets have no style
      splice(part.after, part.end, "");
      return splice(end_of_line, end_of_line, lines_of(now, style, places_.line_break(part.after)));
    }
    if (old.items.empty() && old.kind == now.kind)
      return splice(part.value + 1, part.value + 1, words.substr(1, words.size() - 2));
    if (places_.has_brackets(old) || places_.is_same_line(part.value, part.after))
      return splice(part.value, part.end, words);
    splice(part.after, part.after, " " + words);
    remove_lines(part.value, part.end);
  }

  // ---- parts that go ----

  void remove_block(const PartsChange& change, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i <= last; ++i) {
      const TextPart& part = change.parts[i];
      if (places_.is_first_on_line(part.begin))
        remove_lines(part.begin, part.end);
      else if (i + 1 < change.parts.size())
        splice(part.begin, change.parts[i + 1].begin, "");
      else
        refuse_form(change.old.at);
    }
  }

  void remove_in_brackets(const PartsChange& change, std::size_t first, std::size_t last) {
    const std::size_t begin = change.parts[first].begin, end = change.parts[last].end;
    const std::optional<std::size_t> comma = places_.after_comma(end);
    const std::size_t behind = comma.value_or(end);
    const bool has_lines = places_.is_first_on_line(begin) && places_.is_last_on_line(behind);
    if (first == 0 || last + 1 < change.parts.size()) {
      if (has_lines) return remove_lines(begin, behind);
      return splice(begin, places_.skip_blanks(behind), "");
    }
    const std::size_t before = change.parts[first - 1].end;  // one part stays
    const bool has_comment = places_.text().substr(before, begin - before).find('#') != std::string_view::npos;
    if (!has_lines && !has_comment) return splice(before, end, "");
    if (const auto last_comma = places_.after_comma(before); last_comma && !comma)
      splice(*last_comma - 1, *last_comma, "");
    if (has_lines) return remove_lines(begin, behind);
    splice(begin, behind, "");
  }

  // ---- parts that come ----

  /// Inserts the parts `first` to `end` - 1 of `now`.
  void insert(const PartsChange& change, std::size_t first, std::size_t end, Style style, bool is_root) {
    const std::size_t before = first == 0 ? kNone : change.from[first - 1];
    const std::size_t behind = end < change.from.size() ? change.from[end] : kNone;
    const std::size_t next = before == kNone ? 0 : before + 1;
    style.block = has_block_near(change, next, style.inner) || is_root;
    const std::string eol(places_.line_break(change.parts[before == kNone ? behind : before].begin));
    std::vector<std::string> words;
    for (std::size_t i = first; i < end; ++i) words.push_back(entry(change.now, i, style, eol));
    if (style.in_brackets) {
      const bool is_next = next < change.parts.size() && change.stays[next];
      if (before == kNone || is_next) return insert_before(change.parts[is_next ? next : behind], words, eol);
      return insert_behind(change.parts[before], words, eol);
    }
    const std::string margin(style.indent, ' ');
    std::string text;
    if (before == kNone) {
      for (const std::string& one : words) text += one + eol + margin;
      return splice(change.parts[behind].begin, change.parts[behind].begin, text);
    }
    const bool is_apart = is_root && places_.is_blank_above(change.parts[before].begin);
    for (const std::string& one : words) text += (is_apart ? eol : "") + eol + margin + one;
    const std::size_t at = places_.line_end(change.parts[before].end);
    splice(at, at, text);
  }

  void insert_before(const TextPart& part, const std::vector<std::string>& words, const std::string& eol) {
    const bool has_lines = places_.is_first_on_line(part.begin);
    const std::string gap = has_lines ? eol + std::string(column_of(part.begin), ' ') : " ";
    std::string text;
    for (const std::string& one : words) text += one + "," + gap;
    splice(part.begin, part.begin, text);
  }

  void insert_behind(const TextPart& part, const std::vector<std::string>& words, const std::string& eol) {
    const bool has_lines = places_.is_first_on_line(part.begin);
    const std::string gap = has_lines ? eol + std::string(column_of(part.begin), ' ') : " ";
    const auto comma = places_.after_comma(part.end);
    const std::size_t behind = comma && places_.is_same_line(*comma, part.end) ? *comma : part.end;
    std::string text;
    if (has_lines && places_.is_last_on_line(behind)) {
      if (!comma) splice(part.end, part.end, ",");
      for (std::size_t i = 0; i < words.size(); ++i)
        text += gap + words[i] + (i + 1 < words.size() || comma ? "," : "");
      return splice(places_.line_end(behind), places_.line_end(behind), text);
    }
    for (const std::string& one : words) text += "," + gap + one;
    splice(part.end, part.end, text);
  }

  TextPlaces places_;
  const Report& faults_;
  std::vector<Splice> splices_;
  std::optional<Error> refusal_;
};

}  // namespace

Result<std::string> spliced(std::string_view text, const Report& faults, const Node& old, const Node& now) {
  Splicer splicer(text, faults);
  splicer.root(old, now);
  return splicer.result();
}

}  // namespace chimera
