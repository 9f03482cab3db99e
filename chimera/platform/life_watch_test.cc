// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/life_watch.h"

#include <gtest/gtest.h>

namespace chimera {
namespace {

constexpr Nanoseconds kEvery = milliseconds(250);

/// A process and its watch, in stepped time.
struct Scene {
  LifeSample sample{seconds(1000), 7, {'S', {}, 0}};
  LifeWatch watch;
  LifeLimits limits;

  LifeVerdict look() { return watch.look(sample, limits); }
  /// A sample each quarter of a second.
  LifeVerdict after(Nanoseconds time, bool beats = false, double load = 0) {
    LifeVerdict last;
    for (Nanoseconds t; t < time; t = t + kEvery) {
      sample.at = sample.at + kEvery;
      sample.process.used = sample.process.used + Nanoseconds{static_cast<std::int64_t>(load * double(kEvery.count))};
      if (beats) ++sample.beats;
      last = look();
      if (last.is_news) ++news;
    }
    return last;
  }
  int news = 0;
};

TEST(LifeWatch, ReportsNothingWhileTheLoopRuns) {
  Scene scene;
  scene.look();
  EXPECT_EQ(scene.after(seconds(100), true).life, Life::kRuns);
  EXPECT_EQ(scene.news, 0);
}

TEST(LifeWatch, ReportsAStoppedProcessOnceAndThenIsOver) {
  Scene scene;
  scene.look();
  scene.sample.process.letter = 'T';
  EXPECT_EQ(scene.after(milliseconds(1250)).life, Life::kRuns);
  const LifeVerdict told = scene.after(kEvery);
  EXPECT_EQ(told.life, Life::kStopped);
  EXPECT_TRUE(told.is_news);
  EXPECT_FALSE(told.is_over);
  EXPECT_EQ(told.text(), "stopped by a signal (state T)");
  const LifeVerdict more = scene.after(milliseconds(1250));
  EXPECT_FALSE(more.is_news);
  EXPECT_FALSE(more.is_over);
  EXPECT_TRUE(scene.after(kEvery).is_over);
  EXPECT_EQ(scene.news, 1);
}

TEST(LifeWatch, ReportsThatTheProcessRunsAgainWithItsSilence) {
  Scene scene;
  scene.look();
  scene.sample.process.letter = 'T';
  scene.after(seconds(2));
  scene.sample.process.letter = 'S';
  const LifeVerdict again = scene.after(kEvery, true);
  EXPECT_EQ(again.life, Life::kRuns);
  EXPECT_TRUE(again.is_news);
  EXPECT_EQ(again.silent, milliseconds(2250));
  EXPECT_FALSE(scene.after(kEvery, true).is_news);
  EXPECT_EQ(scene.after(seconds(1)).life, Life::kRuns) << "the silence starts again";
}

TEST(LifeWatch, WaitsForADebuggerAndReportsItAgain) {
  Scene scene;
  scene.look();
  scene.sample.process = {'t', {}, 4711};
  const LifeVerdict held = scene.after(seconds(9));
  EXPECT_EQ(held.life, Life::kTraced);
  EXPECT_EQ(held.text(), "held by a debugger (pid 4711)");
  EXPECT_EQ(scene.news, 1);
  EXPECT_TRUE(scene.after(seconds(1)).is_news);
  EXPECT_FALSE(scene.after(seconds(3600)).is_over);
  EXPECT_EQ(scene.news, 3 + 6) << "after 1.5 s, 10 s, 60 s, and each ten minutes";
}

TEST(LifeWatch, DistinguishesALoopAWaitAndAStarvedProcess) {
  for (const auto& [letter, load, life, is_over] :
       {std::tuple{'R', 1.0, Life::kLoops, true}, std::tuple{'S', 0.0, Life::kWaits, true},
        std::tuple{'D', 0.0, Life::kWaits, true}, std::tuple{'R', 0.1, Life::kStarves, false}}) {
    Scene scene;
    scene.look();
    scene.sample.process.letter = letter;
    const LifeVerdict verdict = scene.after(seconds(4), false, load);
    EXPECT_EQ(verdict.life, life) << letter << load;
    EXPECT_EQ(verdict.is_over, is_over) << letter << load;
  }
}

TEST(LifeWatch, ReportsALoopThatNeverWaits) {
  Scene scene;
  scene.limits.spins = milliseconds(1500);
  scene.look();
  EXPECT_EQ(scene.after(seconds(10), true, 0.8).life, Life::kRuns);
  EXPECT_EQ(scene.news, 0);
  const LifeVerdict spins = scene.after(seconds(3), true, 1.0);  // at most one window until the report
  EXPECT_EQ(spins.life, Life::kSpins);
  EXPECT_EQ(spins.text(), "uses a whole processor");
  EXPECT_FALSE(scene.after(seconds(10), true, 1.0).is_over);
  EXPECT_EQ(scene.news, 1);
  EXPECT_EQ(scene.after(seconds(3), true, 0.1).life, Life::kRuns);
  EXPECT_EQ(scene.news, 2);
}

TEST(LifeWatch, RecognisesALoopThatSharesItsProcessor) {
  Scene scene;
  scene.look();
  scene.sample.process.letter = 'R';
  EXPECT_EQ(scene.after(milliseconds(2750), false, 0.25).life, Life::kStarves);
  const LifeVerdict used = scene.after(kEvery, false, 0.25);
  EXPECT_EQ(used.life, Life::kLoops) << "0.75 s of processor use";
  EXPECT_TRUE(used.is_over);
}

TEST(LifeWatch, CountsNoSilenceWhileTheWatchItselfWasStopped) {
  Scene scene;
  scene.look();
  scene.after(kEvery);
  scene.sample.at = scene.sample.at + seconds(60);  // the watch was stopped, and all other processes too
  const LifeVerdict back = scene.look();
  EXPECT_EQ(back.life, Life::kRuns);
  EXPECT_FALSE(back.is_news);
  EXPECT_EQ(back.silent, kEvery);
  EXPECT_EQ(scene.after(milliseconds(1000)).life, Life::kRuns);
  EXPECT_EQ(scene.after(kEvery).life, Life::kWaits) << "the watch continues";
}

TEST(LifeWatch, SubtractsOnlyTheTimesWhenTheWatchWasStopped) {
  Scene scene;
  scene.look();
  LifeVerdict verdict;
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(scene.after(kEvery).life, i < 5 ? Life::kRuns : Life::kWaits) << i;
    scene.sample.at = scene.sample.at + seconds(2);
    verdict = scene.look();
  }
  EXPECT_EQ(verdict.silent, milliseconds(1500));
}

TEST(LifeWatch, RemembersItsReportAfterItWasStopped) {
  Scene scene;
  scene.look();
  scene.after(seconds(2));
  scene.sample.at = scene.sample.at + seconds(60);
  scene.look();
  EXPECT_TRUE(scene.after(kEvery, true).is_news) << "the process runs again";
}

}  // namespace
}  // namespace chimera
