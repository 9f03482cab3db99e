// SPDX-License-Identifier: Apache-2.0
#include "chimera/draw/picture.h"

#include <gtest/gtest.h>

#include "chimera/draw/layout.h"

namespace chimera::draw::picture_test {
namespace {

using enum PortKind;

Graph pair() {
  return {"pair",
          {{"gain", "gain", "1 kHz", "",
            {{kIn, "x", "u"}, {kOut, "y", "y"}, {kInConst, "k", "", "2"}, {kResource, "dev", "", "/dev/x"}}},
           {"log", "csv_log", "", "", {{kIn, "a", "y"}, {kIn, "b", "y"}}}},
          {"u"}};
}

std::string words(const Json& all, const char* key, const char* more) {
  std::string text;
  for (const Json& one : all) text += one[key].as_string() + ":" + one[more].dump() + " ";
  return text;
}

TEST(Picture, HasTheKeysOfTheFormat) {
  const Json picture = picture_json(pair());
  EXPECT_EQ(picture["title"], "pair");
  EXPECT_EQ(words(picture["boxes"], "task", "width"), "gain:101 log:96 ");
  EXPECT_EQ(words(picture["ports"], "port", "variable"), "x:\"u\" y:\"y\" k:null dev:null a:\"y\" b:\"y\" ");
  EXPECT_EQ(words(picture["ports"], "kind", "task"),
            "in-var:\"gain\" out-var:\"gain\" in-const:\"gain\" resource:\"gain\" in-var:\"log\" in-var:\"log\" ");
  EXPECT_EQ(words(picture["lines"], "arrow", "variable"),
            ":\"y\" :\"y\" end:\"y\" end:\"y\" end:\"u\" end:null both:null ");
  EXPECT_EQ(words(picture["labels"], "text", "style"),
            "pair:\"title\" gain:\"name\" 1 kHz:\"soft\" x:\"port\" u:\"given\" y:\"port\" y:\"soft\" k=2:\"soft\" "
            "dev: /dev/x:\"soft\" log:\"name\" csv_log:\"soft\" a:\"port\" b:\"port\" ");
  EXPECT_EQ(picture["labels"][0]["task"], nullptr);
  EXPECT_EQ(picture["labels"][4]["variable"], "u");
  EXPECT_EQ(picture["labels"][4]["anchor"], "end");
}

TEST(Picture, IsTheLayoutOfTheSvg) {
  const Json picture = picture_json(pair());
  const std::string document = svg(pair());
  for (const Json& box : picture["boxes"]) {
    const std::string rectangle = "<rect x=\"" + box["x"].dump() + "\" y=\"" + box["y"].dump() + "\" width=\"";
    EXPECT_NE(document.find(rectangle), std::string::npos) << rectangle;
  }
  for (const Json& label : picture["labels"]) {
    const std::string text = "y=\"" + label["y"].dump() + "\" class=\"" + label["style"].as_string();
    EXPECT_NE(document.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(picture["dots"].size(), 1u);
  const std::string dot = "<circle cx=\"" + picture["dots"][0]["x"].dump();
  EXPECT_NE(document.find(dot), std::string::npos) << dot;
}

TEST(Picture, OfNoTaskIsEmpty) {
  const Json picture = picture_json({"idle", {}, {}});
  EXPECT_EQ(picture["boxes"], Json::array());
  EXPECT_GT(picture["width"].as_int64(), 0);
}

}  // namespace
}  // namespace chimera::draw::picture_test
