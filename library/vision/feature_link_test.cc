// SPDX-License-Identifier: Apache-2.0
#include "library/vision/feature_link.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <random>
#include <string>

namespace chimera::library {
namespace {

std::string name_of(const char* what) { return std::string(what) + "_" + std::to_string(::getpid()); }

TEST(Pinhole, LocatesProjectedPoints) {
  Pinhole camera;
  camera.place = frame_of(Pose{{1.6, 0, 0.4}, {0.5, -0.5, -0.5, 0.5}});
  std::mt19937 random(3);
  std::uniform_real_distribution<double> metre(-0.3, 0.3);
  int seen = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 ball = camera.place.origin + camera.place.rotate({metre(random), metre(random), 1 + metre(random)});
    Feature feature;
    if (!camera.project(ball, feature)) continue;
    ++seen;
    Vec3 found;
    ASSERT_TRUE(camera.locate(feature, found));
    EXPECT_LT(length(found - ball), 1e-12);
  }
  EXPECT_GT(seen, 900);
}

TEST(Pinhole, SeesNothingBehindItOrBesideThePicture) {
  const Pinhole camera;
  Feature feature;
  EXPECT_TRUE(camera.project({0, 0, 1}, feature));
  EXPECT_EQ(feature.u, 640);
  EXPECT_EQ(feature.v, 480);
  EXPECT_DOUBLE_EQ(feature.size, 40);
  EXPECT_FALSE(camera.project({0, 0, -1}, feature));
  EXPECT_FALSE(camera.project({0.81, 0, 1}, feature));
  EXPECT_FALSE(camera.project({0, -0.61, 1}, feature));
  Vec3 point;
  EXPECT_FALSE(camera.locate({0, 640, 480, 0}, point));
  EXPECT_FALSE(camera.locate({0, 640, std::nan(""), 40}, point));
}

TEST(FeatureText, IsReadAsItWasWritten) {
  char text[96];
  EXPECT_EQ(feature_text({1.5, 640.25, 480, 26.5}, text), 35u);
  EXPECT_STREQ(text, "1.500000,640.2500,480.0000,26.50000");
  Feature back;
  ASSERT_TRUE(read_feature(text, back));
  EXPECT_EQ(back.u, 640.25);
  for (const char* wrong : {"", "1,2,3", "1,2,3,4,5", "1,2,3,x", "1;2;3;4", "1,2,3,nan", "1,2,3,4 "}) {
    EXPECT_FALSE(read_feature(wrong, back)) << wrong;
  }
  const double huge = 1e300;  // would take 900 characters
  EXPECT_EQ(feature_text({huge, huge, huge, 1}, text), 0u);
  EXPECT_EQ(feature_text({1e9, 1e5, 1e5, 1e5}, text), 54u);
}

TEST(FeatureLink, CarriesFeaturesByDatagram) {
  const std::string link = "unix:@" + name_of("features");
  FeatureReader reader;
  FeatureWriter writer;
  ASSERT_TRUE(reader.open(link));
  ASSERT_TRUE(writer.open(link));
  for (int i = 0; i < 3; ++i) writer.send({0.1 * i, 10.0 * i, 20, 30});
  writer.flush();
  reader.drain();
  Feature feature;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(reader.take(0, feature));
    EXPECT_EQ(feature.u, 10.0 * i);
  }
  EXPECT_FALSE(reader.take(0, feature));
  EXPECT_EQ(reader.refused(), 0u);
}

TEST(FeatureLink, HereIsAnotherPlaceInEachProcess) {
  FeatureReader reader;
  ASSERT_TRUE(reader.open("here:eye"));
  FeatureWriter here, elsewhere;
  ASSERT_TRUE(here.open("here:eye"));
  ASSERT_TRUE(elsewhere.open("unix:@eye"));
  here.send({1, 2, 3, 4});
  here.flush();
  elsewhere.send({5, 6, 7, 8});
  elsewhere.flush();
  reader.drain();
  Feature feature;
  ASSERT_TRUE(reader.take(0, feature));
  EXPECT_EQ(feature.time, 1);
  EXPECT_FALSE(reader.take(0, feature));
}

TEST(FeatureLink, OneAddressHasOneReader) {
  const std::string path = testing::TempDir() + name_of("sock");
  FeatureReader first, second;
  ASSERT_TRUE(first.open("unix:" + path));
  EXPECT_EQ(second.open("unix:" + path).error().message.view(), "unix:" + path + ": Address already in use");
  first.close();
  EXPECT_NE(::access(path.c_str(), F_OK), 0);
  EXPECT_TRUE(second.open("unix:" + path));
}

TEST(FeatureLink, PlaysItsOwnRecording) {
  const std::string path = testing::TempDir() + name_of("recording");
  FeatureWriter writer;
  ASSERT_TRUE(writer.open("file:" + path));
  writer.send({0, 1, 2, 3});
  writer.send({0.5, 4, 5, 6});
  writer.flush();
  writer.close();
  FeatureReader reader;
  ASSERT_TRUE(reader.open("file:" + path));
  Feature feature;
  for (int round = 0; round < 2; ++round) {
    reader.rewind();
    ASSERT_TRUE(reader.take(0.1, feature));
    EXPECT_EQ(feature.u, 1);
    EXPECT_FALSE(reader.take(0.4, feature));
    ASSERT_TRUE(reader.take(0.5, feature));
    EXPECT_EQ(feature.size, 6);
    EXPECT_FALSE(reader.take(9, feature));
  }
  EXPECT_EQ(writer.note(), "");
  ASSERT_TRUE(writer.open("file:" + path));
  EXPECT_NE(writer.note().find(".2: an earlier recording has the name"), std::string::npos);
  EXPECT_TRUE(reader.open("file:" + path)) << "unchanged";
  ::unlink(path.c_str()), ::unlink((path + ".2").c_str());
}

TEST(FeatureLink, RefusesABadLinkAndNamesTheBadLine) {
  FeatureReader reader;
  const auto refusal = [&](const std::string& link) { return std::string(reader.open(link).error().message.view()); };
  EXPECT_EQ(refusal("tcp:1"), "tcp:1: expected udp:ADDRESS:PORT, unix:PATH, here:NAME or file:PATH");
  EXPECT_EQ(refusal("udp:127.0.0.1"), "udp:127.0.0.1: expected udp:ADDRESS:PORT, as udp:127.0.0.1:5600");
  EXPECT_EQ(refusal("udp:here:5600"), "udp:here:5600: expected udp:ADDRESS:PORT, as udp:127.0.0.1:5600");
  EXPECT_EQ(refusal("here:"), "here:: expected here:NAME of 1 to 64 bytes");
  EXPECT_EQ(refusal("unix:"), "unix:: expected unix:PATH of 1 to 107 bytes");
  EXPECT_EQ(refusal("file:no_such.csv"), "no_such.csv: cannot be read");
  const std::string path = testing::TempDir() + name_of("bad");
  std::ofstream(path) << "t,u,v,size\n0,1,2,3\n-1,1,2,3\n";
  EXPECT_EQ(refusal("file:" + path), path + ":3: expected t,u,v,size with rising t, found '-1,1,2,3'");
  std::ofstream(path) << "0,1,2,3\n";
  EXPECT_EQ(refusal("file:" + path), path + ":1: expected the head t,u,v,size, found '0,1,2,3'");
  std::ofstream(path) << "t,u,v,size\n";
  EXPECT_EQ(refusal("file:" + path), path + ": there is nothing in this recording");
  ::unlink(path.c_str());
}

}  // namespace
}  // namespace chimera::library
