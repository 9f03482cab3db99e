// SPDX-License-Identifier: Apache-2.0
// The analysis of drafts, over every description of the lessons and of tests/verify, and over parts of them.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "chimera/base/testing/tree_path.h"
#include "chimera/description/edit/text_edit.h"
#include "chimera/description/edit_json.h"
#include "chimera/draw/graph_of.h"
#include "chimera/manager/answer/question.h"
#include "chimera/text/json.h"
#include "chimera/units/testing/unit_samples.h"
#include "chimera/verify/verify.h"

namespace chimera::manager {
namespace {

namespace fs = std::filesystem;

struct Sample {
  std::string path, text;
  const Library* library = nullptr;
};

void add_samples(const char* folder, const Library& library, std::vector<Sample>& all) {
  for (const auto& entry : fs::recursive_directory_iterator(source_path(folder))) {
    const std::string path = entry.path().string();
    if (!path.ends_with(".yaml") || path.ends_with(".cases.yaml")) continue;
    std::ifstream stream(path, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    all.push_back({path, text.str(), &library});
  }
}

const std::vector<Sample>& samples() {
  static const std::string kBuilt[] = {build_path("components")}, kTested[] = {source_path("tests/verify/components")};
  static const Library kLessons = Library::make(kBuilt, our_units()), kTests = Library::make(kTested, our_units());
  static const std::vector<Sample> kAll = [] {
    std::vector<Sample> all;
    add_samples("examples", kLessons, all);
    add_samples("tests/verify/good", kTests, all);
    add_samples("tests/verify/faulty", kTests, all);
    return all;
  }();
  return kAll;
}

Json answer(Question::Kind kind, const Sample& sample) {
  const auto answered = answer_of({kind, "a.yaml", sample.text, "", 7}, *sample.library);
  EXPECT_TRUE(answered) << answered.error().message.c_str();
  return Json::parse(answered->json);
}

/// The faults without their offers.
Json without_offers(Json report) {
  for (Json& fault : report["faults"].elements()) fault["offers"] = Json::array();
  return report;
}

TEST(Draft, HasTheReportOfCheckAndTheOutlineOfEveryText) {
  int legal = 0, faulty = 0, unreadable = 0;
  for (const Sample& sample : samples()) {
    SCOPED_TRACE(sample.path);
    const Json draft = answer(Question::Kind::kDraft, sample), check = answer(Question::Kind::kCheck, sample);
    EXPECT_EQ(draft["version"], 7);
    EXPECT_EQ(draft["report"], without_offers(check));
    ++(draft["outline"].is_null() ? unreadable : check["legal"].as_bool() ? legal : faulty);
    EXPECT_EQ(draft["picture"].is_null(), draft["outline"].is_null());
    EXPECT_EQ(draft["picture"]["boxes"].size(), draft["outline"]["tasks"].size());
    bool is_judged = true;
    for (const Json& fault : check["faults"])
      is_judged = is_judged && (fault["severity"] == "warning" || fault["rule"] == "utilisation" ||
                                text_at(fault, "rule").starts_with("object-"));
    EXPECT_EQ(draft["schedule"].is_null(), !is_judged);
  }
  EXPECT_GE(legal, 50);
  EXPECT_GE(faulty, 50);
  EXPECT_GE(unreadable, 3);
}

TEST(Draft, DrawsALegalOutlineAsItsConfiguration) {
  int drawn = 0;
  for (const Sample& sample : samples()) {
    SCOPED_TRACE(sample.path);
    const Outlined outlined = verify_with_outline(read_description(sample.text, "a.yaml"), *sample.library);
    if (!outlined.verdict.configuration) continue;
    const draw::Graph by_outline = draw::graph_of(*outlined.outline);
    const draw::Graph by_configuration = draw::graph_of(*outlined.verdict.configuration);
    EXPECT_EQ(draw::svg(by_outline), draw::svg(by_configuration));
    EXPECT_EQ(draw::text(by_outline), draw::text(by_configuration));
    ++drawn;
  }
  EXPECT_GE(drawn, 50);
}

TEST(Draft, OffersTheEditsOfCheck) {
  std::size_t all = 0;
  for (const Sample& sample : samples()) {
    SCOPED_TRACE(sample.path);
    const Json offers = answer(Question::Kind::kOffers, sample)["offers"];
    const Json check = answer(Question::Kind::kCheck, sample);
    std::size_t n = 0;
    for (std::size_t f = 0; f < check["faults"].size(); ++f)
      for (const Json& offer : check["faults"][f]["offers"]) {
        EXPECT_EQ(offers[n], Json({{"fault", f}, {"label", offer["label"]}, {"acts", offer["acts"]}}));
        ++n;
      }
    EXPECT_EQ(offers.size(), n);
    all += n;
  }
  EXPECT_GE(all, 30u);
}

TEST(Draft, IsAnsweredForTextsWithoutSomeOfTheirLines) {
  std::mt19937 random(1);
  for (const Sample& sample : samples()) {
    SCOPED_TRACE(sample.path);
    for (int round = 0; round < 2; ++round) {
      std::istringstream lines(sample.text);
      Sample less{sample.path, {}, sample.library};
      for (std::string line; std::getline(lines, line);)
        if (random() % 12 != 0) less.text += line + "\n";
      const Json draft = answer(Question::Kind::kDraft, less);
      EXPECT_EQ(draft["text"], less.text);
      EXPECT_EQ(draft["picture"]["boxes"].size(), draft["outline"]["tasks"].size());
    }
  }
}

/// The remedies of each CPU that does not fit, by set and CPU.
template <class Visit>
void each_remedy(const Json& schedule, Visit visit) {
  for (std::size_t s = 0; s < schedule["sets"].size(); ++s)
    for (std::size_t c = 0; c < schedule["sets"][s]["cpus"].size(); ++c)
      for (const Json& remedy : schedule["sets"][s]["cpus"][c]["remedies"]) visit(s, c, remedy);
}

TEST(Draft, FitsAfterTheActsOfEachRemedy) {
  int tried = 0;
  for (const Sample& sample : samples()) {
    SCOPED_TRACE(sample.path);
    const Json schedule = answer(Question::Kind::kDraft, sample)["schedule"];
    each_remedy(schedule, [&](std::size_t s, std::size_t c, const Json& remedy) {
      SCOPED_TRACE(remedy.dump());
      const auto acts = edit_acts(remedy["acts"]);
      ASSERT_TRUE(acts) << acts.error().message.c_str();
      const auto text = edit_text(sample.text, *acts);
      ASSERT_TRUE(text) << text.error().message.c_str();
      const Json after = answer(Question::Kind::kDraft, {sample.path, *text, sample.library});
      const Json cpu = after["schedule"]["sets"][s]["cpus"][c];
      ASSERT_TRUE(cpu.is_object()) << after["report"];
      for (const Json& task : cpu["tasks"])
        EXPECT_TRUE(task["guarantee"] == "yes" || task["guarantee"] == "not-stated" ||
                    (remedy["criticality"] == "low" && task["task"] == remedy["task"]))
            << task;
      ++tried;
    });
  }
  EXPECT_GE(tried, 5);
}

}  // namespace
}  // namespace chimera::manager
