// SPDX-License-Identifier: Apache-2.0
// The text of a tree in a style by seed: brackets on one line or on several, lines, indentation, quotes, comments.
#pragma once

#include <cstddef>
#include <random>
#include <string>

#include "chimera/description/node.h"
#include "chimera/description/yaml_words.h"

namespace chimera {

class StyledText {
 public:
  explicit StyledText(std::mt19937& random) : random_(random) {}

  std::string of(const Node& root) {
    text_.clear();
    entries(root, 0);
    return text_;
  }

 private:
  bool one_of(unsigned n) { return random_() % n == 0; }

  /// A line end, often behind a comment. Each comment has its own number.
  void end_line() {
    if (one_of(3))
      text_ += std::string(1 + random_() % 4, one_of(5) ? '\t' : ' ') + "# c" + std::to_string(++comments_) + ".";
    text_ += '\n';
    if (one_of(12)) text_ += '\n';
    if (one_of(12)) text_ += std::string(random_() % 9, ' ') + "# c" + std::to_string(++comments_) + ".\n";
  }
  std::string words(const Node& value) {
    if (value.is_scalar() && value.quoted) return quoted_words(value.text, one_of(2) ? '\'' : '"');
    return written_text(value, true);
  }
  std::string name(const Node& parent, std::size_t i) {
    if (!parent.is_map()) return "";
    return (one_of(9) ? quoted_words(parent.keys[i].text, '"') : parent.keys[i].text) + (one_of(20) ? " :" : ":");
  }

  void entries(const Node& node, std::size_t indent) {
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      text_ += std::string(indent, ' ') + (node.is_map() ? name(node, i) : "-");
      value(node.items[i], indent, node.is_map());
    }
  }

  void value(const Node& node, std::size_t indent, bool is_behind_key) {
    if (!node.is_none() && (node.items.empty() || one_of(2))) {
      text_ += std::string(1 + random_() % 2, ' ') + words(node);
      return end_line();
    }
    if (node.is_none()) return end_line();
    if (is_behind_key && one_of(2)) {
      end_line();
      return entries(node, indent + (node.is_list() && one_of(2) ? 0 : 1 + random_() % 4));
    }
    text_ += node.is_map() ? " {" : " [";
    const bool closes_alone = one_of(2), has_last_comma = one_of(3);
    const std::size_t inner = indent + 2 + random_() % 4;
    end_line();
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      const bool is_last = i + 1 == node.items.size();
      text_ += std::string(inner, ' ') + name(node, i) + (node.is_map() ? " " : "") + words(node.items[i]);
      if (!is_last || has_last_comma) text_ += one_of(9) ? " ," : ",";
      if (!is_last || closes_alone) end_line();
    }
    text_ += (closes_alone ? std::string(indent + 1, ' ') : "") + (node.is_map() ? "}" : "]");
    end_line();
  }

  std::mt19937& random_;
  std::string text_;
  std::size_t comments_ = 0;
};

}  // namespace chimera
