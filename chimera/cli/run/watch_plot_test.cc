// SPDX-License-Identifier: Apache-2.0
#include "chimera/cli/run/watch_plot.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "chimera/cli/files/testing/test_place.h"
#include "chimera/cli/run/run.h"

namespace chimera::cli {
namespace {

namespace fs = std::filesystem;

TEST(WatchPlot, DrawsWatchedVariablesInsteadOfPrintingThem) {
  const fs::path folder = fs::temp_directory_path();
  const std::string file = (folder / ("plot_" + std::to_string(::getpid()) + ".yaml")).string();
  const std::string picture = file + ".svg", table = file + ".csv";
  std::ofstream(file) << "subsystem: drawn\ntasks: {t_counter: {rate: 1 kHz}}\n";
  RunRequest request;
  request.file = file;
  request.virtual_time = true;
  request.duration = milliseconds(50);
  request.watch = {"count"};
  request.svg = picture;
  request.csv = table;
  std::FILE* out = std::tmpfile();
  EXPECT_EQ(run(request, test_place(), nullptr, out, out), kOk);
  std::rewind(out);
  char text[4096] = {};
  EXPECT_GT(std::fread(text, 1, sizeof text - 1, out), 0u);
  EXPECT_EQ(std::string(text).find("t 0.0"), std::string::npos) << text;
  std::fclose(out);
  std::ifstream stream(picture);
  const std::string svg{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_TRUE(svg.starts_with("<svg")) << svg.substr(0, 100);
  EXPECT_NE(svg.find("drawn"), std::string::npos);
  EXPECT_NE(svg.find("count"), std::string::npos);
  std::size_t steps = 0;
  for (std::size_t at = svg.find(" L"); at != std::string::npos; at = svg.find(" L", at + 1)) ++steps;
  EXPECT_GE(steps, 40u) << "without --every a point for each cycle\n" << svg;
  std::ifstream rows(table);
  std::string line;
  std::getline(rows, line);
  EXPECT_EQ(line, "t(s),count(1)");
  std::getline(rows, line);
  EXPECT_EQ(line, "0.001000000,1");
  std::size_t n_rows = 1;
  while (std::getline(rows, line)) ++n_rows;
  EXPECT_EQ(n_rows, 50u);
  request.svg = "/nowhere/a.svg";
  std::FILE* refused = std::tmpfile();
  EXPECT_EQ(run(request, test_place(), nullptr, refused, refused), kRefused);
  std::fclose(refused);
  fs::remove(file);
  fs::remove(picture);
  fs::remove(table);
}

}  // namespace
}  // namespace chimera::cli
