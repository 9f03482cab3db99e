// SPDX-License-Identifier: Apache-2.0
// Reads `target` and `link`, which belong together, and judges the times of the link.
#include "chimera/description/draft_link.h"

#include <array>

#include "chimera/description/draft_values.h"
#include "chimera/description/keys.h"

namespace chimera {
namespace {

constexpr const char* kLinkForm = "write 'link: {serial: /dev/ttyUSB0, rate: 100 Hz, stale_after: 50 ms}'";
// Those that Linux knows: chimera/platform/line/byte_line.cc.
constexpr std::array<std::string_view, 10> kBauds = {"9600",   "19200",  "38400",  "57600",   "115200",
                                                     "230400", "460800", "921600", "1000000", "2000000"};
constexpr Nanoseconds kShortest = milliseconds(1), kLongest = seconds(1);
constexpr std::int64_t kLeastPeriods = 2;

void missing(const std::string& key, const std::string& what, Place at, const char* remedy, Report& report) {
  report.add({.rule = "key-missing", .at = at, .message = "'" + key + "' " + what + " is missing", .expected = key,
              .remedy = remedy});
}

class LinkReader {
 public:
  LinkReader(const Node& node, const std::string& rtpu, Report& report) : node_(node), rtpu_(rtpu), report_(report) {}

  std::optional<DraftLink> read() {
    if (!expect(node_, Node::Kind::kMap, "'link' of " + rtpu_, report_)) return std::nullopt;
    const std::size_t before = report_.errors();
    refuse_unknown_keys(node_, kLinkKeys, "'link' of " + rtpu_, report_);
    link_.at = node_.at;
    address();
    if (const Node* node = node_.find("baud")) baud(*node);
    if (const Node* rate = required("rate"))
      link_.rate = read_rate(*rate, said("rate"), report_).value_or(Located<Rate>{});
    if (const Node* stale = required("stale_after"))
      link_.stale_after = read_duration(*stale, said("stale_after"), report_).value_or(Located<Nanoseconds>{});
    if (report_.errors() == before) times();
    return report_.errors() == before ? std::optional(link_) : std::nullopt;
  }

 private:
  std::string said(const std::string& key) const { return "'" + key + "' in 'link' of " + rtpu_; }

  const Node* required(const std::string& key) {
    const Node* found = node_.find(key);
    if (found == nullptr) missing(key, "in 'link' of " + rtpu_, node_.at, kLinkForm, report_);
    return found;
  }

  void address() {
    const Node *serial = node_.find("serial"), *udp = node_.find("udp");
    if (serial == nullptr && udp == nullptr)
      return missing("serial' or 'udp", "in 'link' of " + rtpu_, node_.at, kLinkForm, report_);
    if (serial != nullptr && udp != nullptr) {
      report_.add({.rule = "board-rtpu",
                   .at = udp->at,
                   .message = said("udp") + " stands beside 'serial': a link has one line",
                   .found = udp->text,
                   .remedy = "leave one of them out"});
      return;
    }
    link_.is_udp = udp != nullptr;
    const Node& node = link_.is_udp ? *udp : *serial;
    const auto text = read_text(node, said(link_.is_udp ? "udp" : "serial"), report_);
    if (!text) return;
    link_.address = *text;
    const bool is_host_and_port = text->text.find(':') != std::string::npos && text->text.back() != ':';
    if (!text->empty() && (!link_.is_udp || is_host_and_port)) return;
    report_.add({.rule = "value-kind",
                 .at = text->at,
                 .message = said(link_.is_udp ? "udp" : "serial") + " is '" + text->text + "'",
                 .found = text->text,
                 .expected = link_.is_udp ? "ADDRESS:PORT of the board" : "the path of a serial device",
                 .remedy = link_.is_udp ? "write 'udp: \"192.168.0.7:5000\"'" : "write 'serial: /dev/ttyUSB0'"});
  }

  void baud(const Node& node) {
    const auto found = read_choice(node, kBauds, said("baud"), report_);
    if (found) link_.baud = {static_cast<std::uint32_t>(std::stoul(std::string(kBauds[found->value]))), found->at};
  }

  void times() {
    const Nanoseconds period = link_.rate.value.period;
    if (period < kShortest || period > kLongest)
      report_.add({.rule = "link-time",
                   .at = link_.rate.at,
                   .message = said("rate") + " is outside 1 Hz to 1 kHz",
                   .expected = "1 Hz to 1 kHz",
                   .remedy = "write a rate of that range: one frame of each direction is sent in a period"});
    else if (link_.stale_after.value < period * kLeastPeriods)
      report_.add({.rule = "link-time",
                   .at = link_.stale_after.at,
                   .message = said("stale_after") + " is shorter than " + std::to_string(kLeastPeriods) +
                              " periods of its rate: each lost frame would count as a cut cable",
                   .expected = "at least " + std::to_string(kLeastPeriods) + " periods",
                   .remedy = "write a longer 'stale_after' or a higher 'rate'"});
  }

  const Node& node_;
  const std::string& rtpu_;
  Report& report_;
  DraftLink link_;
};

}  // namespace

void read_board(const Node& map, DraftRtpu& rtpu, Report& report) {
  const Node *target = map.find("target"), *link = map.find("link");
  if (target == nullptr && link == nullptr) return;
  const std::string what = "rtpu '" + rtpu.name.text + "'";
  if (target == nullptr)
    missing("target", "of " + what, link->at, "write 'target: mps2-an385', the board that runs its tasks", report);
  if (link == nullptr) missing("link", "of " + what, target->at, kLinkForm, report);
  if (target != nullptr) rtpu.target = read_text(*target, "'target' of " + what, report);
  if (link != nullptr) rtpu.link = LinkReader(*link, what, report).read();
  if (const Node* cpu = map.find("cpu"))
    report.add({.rule = "board-rtpu", .at = cpu->at, .message = "'cpu' of " + what + ": a board has a CPU of its own",
                .found = cpu->text, .remedy = "leave 'cpu' out"});
}

}  // namespace chimera
