// SPDX-License-Identifier: Apache-2.0
// Builds the tree from the events of yaml-cpp. The tree of yaml-cpp would keep a repeated key without an error, drop
// anchors before any check, and need ten times the memory.
#include "chimera/description/yaml_reader.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <exception>
#include <istream>
#include <streambuf>
#include <string>
#include <unordered_map>
#include <vector>

#include "chimera/description/key_paths.h"
#include "chimera/description/text_limits.h"
#include "chimera/description/yaml_fault.h"

namespace chimera {
namespace {

Place place(const YAML::Mark& mark) {
  return {static_cast<std::uint32_t>(mark.line + 1), static_cast<std::uint32_t>(mark.column + 1)};
}

/// Leaves the parser from inside an event; the fault is in the report.
struct Stop : std::exception {};

class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(std::string_view text, Report& report) : text_(text), report_(report) {}

  Node take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_marks(mark, "?", anchor);
    begin(Node::Kind::kNone, mark);
    end();
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse("yaml-alias", mark, "an alias (*) is not accepted", "write the value out where it is used");
    begin(Node::Kind::kNone, mark);
    end();
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_marks(mark, tag, anchor);
    const char lead = character_at(mark);
    if (lead == '|' || lead == '>')
      refuse("yaml-block-scalar", mark, "a block scalar (| or >) is not accepted", "write the text on one line");
    if (value.size() > kMaxValueBytes)
      refuse("value-size", mark,
             "a value of " + std::to_string(value.size()) + " bytes; at most " + std::to_string(kMaxValueBytes) +
                 " are read",
             "shorten it, or give the component a file to read");
    if (value.find('\0') != std::string::npos)
      refuse("text-encoding", mark, "a text holds the byte 0", std::string(kNoZero));
    Node& node = begin(Node::Kind::kScalar, mark);
    node.text = value.substr(0, kMaxValueBytes);
    node.quoted = tag == "!";
    end();
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    refuse_marks(mark, tag, anchor);
    begin(Node::Kind::kList, mark);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    refuse_marks(mark, tag, anchor);
    begin(Node::Kind::kMap, mark);
  }
  void OnMapEnd() override { end(); }

 private:
  void refuse(std::string_view rule, const YAML::Mark& mark, std::string message, std::string remedy) {
    report_.add({.rule = rule,
                 .at = place(mark),
                 .message = std::move(message),
                 .remedy = std::move(remedy)});
  }
  void refuse_marks(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    if (anchor != 0)
      refuse("yaml-anchor", mark, "an anchor (&) is not accepted", "write the value out where it is used");
    if (!tag.empty() && tag != "?" && tag != "!")
      refuse("yaml-tag", mark, "a tag (!) is not accepted", "leave it out: the port settles the type");
  }

  char character_at(const YAML::Mark& mark) {
    for (; line_ < mark.line; ++line_) line_start_ = std::min(text_.find('\n', line_start_), text_.size() - 1) + 1;
    const std::size_t at = line_start_ + static_cast<std::size_t>(mark.column);
    return mark.line == line_ && at < text_.size() ? text_[at] : ' ';
  }

  /// The node for the next event: the value of the pending key, the next item, or the root.
  Node& begin(Node::Kind kind, const YAML::Mark& mark) {
    if (depth_ == kMaxNesting) {
      refuse("text-nesting", mark, "more than " + std::to_string(kMaxNesting) + " levels of nesting",
             "no description needs more: take brackets out");
      throw Stop{};
    }
    Node& node = slot();
    if (&node == &key_ && kind != Node::Kind::kScalar) refuse_key(mark);
    node.kind = kind;
    // A missing value has no place of its own; the parser reports the next word, possibly lines below.
    node.at = place(mark);
    const bool has_key = depth_ > 0 && open_[depth_ - 1]->is_map() && &node != &key_;
    if (kind == Node::Kind::kNone && has_key && node.at.line > open_[depth_ - 1]->keys.back().at.line)
      node.at = open_[depth_ - 1]->keys.back().at;
    open_[depth_++] = &node;
    return node;
  }
  Node& slot() {
    if (depth_ == 0) return root_;
    Node& parent = *open_[depth_ - 1];
    if (parent.is_map() && !has_key_[depth_ - 1]) return key_;
    has_key_[depth_ - 1] = false;
    return parent.items.emplace_back();
  }
  void end() {
    --depth_;
    if (open_[depth_] == &key_) {
      take_key();
      return;
    }
    has_key_[depth_] = false;
  }
  [[noreturn]] void refuse_key(const YAML::Mark& mark) {
    refuse("yaml-key", mark, "a key must be a word", "write 'key: value'");
    throw Stop{};
  }
  void take_key() {
    Node& parent = *open_[depth_ - 1];
    parent.keys.push_back({std::move(key_.text), key_.at});
    has_key_[depth_ - 1] = true;
    key_ = Node{};
  }

  std::string_view text_;
  Report& report_;
  Node root_, key_;
  Node* open_[kMaxNesting] = {};  // parents never move while open: only the last item of a list grows
  bool has_key_[kMaxNesting] = {};
  std::size_t depth_ = 0;
  std::size_t line_start_ = 0;
  int line_ = 0;
};

/// Refuses any text after the first document.
class NoMore : public TreeBuilder {
 public:
  NoMore(std::string_view text, Report& report) : TreeBuilder(text, report), report_(report) {}
  void OnDocumentStart(const YAML::Mark& mark) override {
    report_.add({.rule = "yaml-documents",
                 .at = place(mark),
                 .message = "a second document begins here",
                 .found = "---",
                 .expected = "one document",
                 .remedy = "put it into a file of its own"});
    throw Stop{};
  }

 private:
  Report& report_;
};

/// Removes repeated keys of each map; the first one stays.
void refuse_duplicates(Node& node, Report& report) {
  std::unordered_map<std::string_view, Place> first;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    const Word& key = node.keys[i];
    const auto [known, is_new] = first.emplace(key.text, key.at);
    if (is_new) {
      kept.push_back(i);
      continue;
    }
    report.add({.rule = "key-twice",
                .at = key.at,
                .message = "the key '" + key.text + "' stands already at " + std::to_string(known->second.line) + ':' +
                           std::to_string(known->second.column),
                .found = key.text,
                .expected = "each key once",
                .remedy = "take one of the two out"});
  }
  if (node.is_map() && kept.size() != node.keys.size()) {
    std::vector<Word> keys;
    std::vector<Node> items;
    for (const std::size_t i : kept) {
      keys.push_back(std::move(node.keys[i]));
      items.push_back(std::move(node.items[i]));
    }
    node.keys = std::move(keys);
    node.items = std::move(items);
  }
  for (Node& item : node.items) refuse_duplicates(item, report);
}

/// A stream over the text itself, because yaml-cpp needs a stream and a copy would double the memory.
class TextBuffer : public std::streambuf {
 public:
  explicit TextBuffer(std::string_view text) {
    char* begin = const_cast<char*>(text.data());  // only read
    setg(begin, begin, begin + text.size());
  }
};

bool parse(std::string_view text, TreeBuilder& builder, Report& report) {
  TextBuffer buffer(text);
  std::istream stream(&buffer);
  try {
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) return true;
    NoMore more(text, report);
    parser.HandleNextDocument(more);
    return true;
  } catch (const Stop&) {
    return false;
  } catch (const YAML::Exception& fault) {
    const bool alias = fault.msg.find("anchor is not defined") != std::string::npos;
    if (!alias)
      report.add(yaml_fault(text, place(fault.mark), fault.msg));
    else
      report.add({.rule = "yaml-alias",
                  .at = place(fault.mark),
                  .message = "an alias (*) is not accepted",
                  .remedy = "write the value out where it is used"});
    return false;
  }
}

}  // namespace

std::optional<Node> read_yaml(std::string_view text, Report& report) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (!check_text_limits(text, report)) return std::nullopt;
  TreeBuilder builder(text, report);
  if (!parse(text, builder, report)) return std::nullopt;
  Node root = builder.take();
  report.use(std::make_shared<const KeyPaths>(root));
  refuse_duplicates(root, report);
  return root;
}

}  // namespace chimera
