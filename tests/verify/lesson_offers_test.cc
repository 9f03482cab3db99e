// SPDX-License-Identifier: Apache-2.0
// Offered edits with the components of the library: Figure 4 of the 1994 paper from three bare tasks, and lessons that
// seeded damage makes illegal.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>
#include <set>

#include "chimera/base/testing/tree_path.h"
#include "chimera/catalogue/library.h"
#include "chimera/description/edit/text_edit.h"
#include "chimera/description/testing/edit_campaign.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/offers.h"

namespace chimera {
namespace {

const Library& lesson_library() {
  static const Library kLibrary = [] {
    const std::string folders[] = {build_path("components")};
    return Library::make(folders, our_units());
  }();
  return kLibrary;
}

Outlined offered_for(const std::string& text) {
  const ReadDescription reading = read_description(text, "a.yaml");
  Outlined outlined = verify_with_outline(reading, lesson_library());
  offer_edits(reading, lesson_library(), outlined);
  return outlined;
}

/// The first offer of the first error that has one; nullptr: there is none.
const Offer* first_offer(const Report& report) {
  for (const Fault& fault : report.faults())
    if (fault.severity == Severity::kError && !fault.offers.empty()) return &fault.offers[0];
  return nullptr;
}

TEST(OffersOfTheLessons, MakeFigureFourOfThreeTasksInOnePressAFault) {
  std::string text =
      "version: 1\nsubsystem: puma_pid\ntasks:\n  trajectory: {component: joint_trajectory}\n"
      "  pid: {component: pid_joint}\n  arm: {component: puma_torque}\n";
  std::string labels;
  Outlined now = offered_for(text);
  const std::size_t faults = now.verdict.report.errors();
  EXPECT_EQ(faults, 7u) << now.verdict.report.text();
  for (const Fault& fault : now.verdict.report.faults()) EXPECT_FALSE(fault.offers.empty()) << fault.message;
  std::size_t presses = 0;
  while (const Offer* offer = first_offer(now.verdict.report)) {
    labels += "  " + offer->label + "\n";
    text = *edit_text(text, offer->acts);
    now = offered_for(text);
    ASSERT_LE(++presses, faults) << labels;
  }
  EXPECT_TRUE(now.verdict.configuration) << labels << now.verdict.report.text();
  std::cout << "Figure 4: " << faults << " faults, " << presses << " presses\n" << labels;
}

TEST(OffersOfTheLessons, JoinTwoTrajectoriesByPriorityOrSelectionAsAMeanIsScalar) {
  std::ifstream stream(source_path("examples/01_puma_pid/puma_pid.yaml"));
  std::ostringstream lesson;
  lesson << stream.rdbuf();
  const auto two = edit_text(lesson.str(), std::vector<EditAct>{AddTask{"other", "joint_trajectory"}});
  ASSERT_TRUE(two);
  const Outlined now = offered_for(*two);
  ASSERT_EQ(now.verdict.report.errors(), 3u) << now.verdict.report.text();
  for (const Fault& fault : now.verdict.report.faults()) {
    if (fault.severity == Severity::kWarning) continue;
    std::vector<std::string> labels;
    for (const Offer& offer : fault.offers) labels.push_back(offer.label);
    EXPECT_EQ(labels, (std::vector<std::string>{
                          "join by priority", "join by selection",
                          "link '" + fault.port + "' of 'other' to a new variable '" + fault.port + "_2'"}));
  }
}

std::multiset<std::string> errors_without_places(const Report& report) {
  std::multiset<std::string> errors;
  for (const Fault& fault : report.faults()) {
    std::string words = std::string(fault.rule) + ' ' + fault.set + ' ' + fault.task + ' ' + fault.port + ": ";
    for (const char c : fault.message)  // an edit moves "at 12:3"
      if (c < '0' || c > '9') words += c;
    if (fault.severity == Severity::kError) errors.insert(words);
  }
  return errors;
}

/// Damages a description as a slip of a person does.
class Slip {
 public:
  Slip(const std::string& text, unsigned seed) : random_(seed) {
    const ReadDescription reading = read_description(text, "a.yaml");
    outline_ = *verify_with_outline(reading, lesson_library()).outline;
    const auto read = ReadText::of(text);
    for (const auto& [path, value] : read->flat) {
      const EditPath parts = edit_path(path.empty() ? path : path.substr(1));
      if (parts.size() == 2 || (parts.size() == 3 && parts[0] == "tasks") || parts.size() == 4) paths_.push_back(parts);
    }
  }

  EditAct act() {
    const OutlineTask& task = outline_.tasks[pick(outline_.tasks.size())];
    switch (task.ports.empty() ? 7 : pick(8)) {
      case 0:
        return AddTask{"again", task.component};
      case 1:
        return SetValue{{"tasks", task.name, "rate"}, "50"};
      case 2:
        return SetValue{{"tasks", task.name, "budget"}, "990 us"};
      case 3:
        return SetValue{{"tasks", task.name, "rtpu"}, "nowhere"};
      case 4:
        return link(task, "elsewhere");
      case 5:
        return link(task, outline_.tasks[0].ports.empty() ? "x" : outline_.tasks[0].ports[0].name);
      default:
        return RemoveValue{paths_[pick(paths_.size())]};
    }
  }

 private:
  std::size_t pick(std::size_t n) { return n == 0 ? 0 : random_() % n; }

  LinkPort link(const OutlineTask& task, const std::string& variable) {
    const OutlinePort& port = task.ports[pick(task.ports.size())];
    return {task.name, port.declared, variable, std::nullopt};
  }

  std::mt19937 random_;
  Outline outline_;
  std::vector<EditPath> paths_;
};

void expect_help(const std::string& text, const Outlined& damaged) {
  const std::multiset<std::string> before = errors_without_places(damaged.verdict.report);
  for (const Fault& fault : damaged.verdict.report.faults())
    for (const Offer& offer : fault.offers) {
      const auto edited = edit_text(text, offer.acts);
      ASSERT_TRUE(edited) << offer.label;
      const Report report = verify(read_description(*edited, "a.yaml"), lesson_library()).report;
      const std::multiset<std::string> after = errors_without_places(report);
      EXPECT_TRUE(std::ranges::includes(before, after)) << text << offer.label << '\n' << report.text();
      EXPECT_TRUE(fault.severity == Severity::kWarning || after.size() < before.size()) << text << offer.label;
    }
}

TEST(OffersOfTheLessons, HelpAfterEachSlip) {
  std::size_t faults = 0, with_offer = 0, slips = 0;
  std::map<std::string, int> without;
  for (const auto& [path, text] : texts_to_edit()) {
    if (path.find("/examples/") == std::string::npos) continue;
    if (!verify(read_description(text, "a.yaml"), lesson_library()).configuration) continue;
    SCOPED_TRACE(path);
    Slip slip(text, static_cast<unsigned>(slips));
    for (int i = 0; i < 12; ++i) {
      const auto damaged = edit_text(text, std::vector<EditAct>{slip.act()});
      if (!damaged) continue;
      ++slips;
      const Outlined now = offered_for(*damaged);
      expect_help(*damaged, now);
      for (const Fault& fault : now.verdict.report.faults()) {
        if (fault.severity == Severity::kWarning) continue;
        ++faults;
        with_offer += fault.offers.empty() ? 0 : 1;
        if (fault.offers.empty()) ++without[std::string(fault.rule)];
      }
    }
  }
  std::cout << slips << " slips, " << faults << " errors, " << with_offer << " with an offer\n";
  for (const auto& [rule, times] : without) std::cout << "  without: " << rule << ' ' << times << '\n';
  EXPECT_GE(with_offer * 10, faults * 9) << "too many faults are left without a remedy";
}

}  // namespace
}  // namespace chimera
