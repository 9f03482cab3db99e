// SPDX-License-Identifier: Apache-2.0
// Runs an application once in virtual time, takes its measures, and packs the outcome into a text.
#include "chimera/cli/batch/measured_run.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "chimera/cli/files/blanks.h"
#include "chimera/cli/run/profile_report.h"
#include "chimera/cli/run/run_loop.h"
#include "chimera/cli/run/run_plan.h"
#include "chimera/text/json.h"
#include "chimera/text/not_off.h"

namespace chimera::cli {
namespace {

/// A FILE in memory, whose content is a text.
class TextFile {
 public:
  TextFile() : file_(::open_memstream(&text_, &size_)) {}
  ~TextFile() {
    std::fclose(file_);
    std::free(text_);  // NOLINT: open_memstream's
  }
  TextFile(const TextFile&) = delete;
  TextFile& operator=(const TextFile&) = delete;
  std::FILE* file() const noexcept { return file_; }
  /// Its lines joined by "; ".
  std::string text() const {
    std::fflush(file_);
    std::string all(text_, size_);
    while (!all.empty() && all.back() == '\n') all.pop_back();
    for (std::size_t at = 0; (at = all.find('\n', at)) != std::string::npos;) all.replace(at, 1, "; ");
    return all;
  }

 private:
  char* text_ = nullptr;
  std::size_t size_ = 0;
  std::FILE* file_;
};

struct ParsedMeasures {
  std::vector<Measure> measures, expectations;
};

Result<ParsedMeasures> parse_measures(const MeasuredRequest& request, const RunPlan& plan) {
  ParsedMeasures parsed;
  for (const std::string& text : request.measures) {
    auto measure = Measure::parse(text, plan.configuration, plan.library.units());
    if (!measure) return measure.error();
    parsed.measures.push_back(*std::move(measure));
  }
  for (const std::string& text : request.expect) {
    auto expectation = Measure::parse_expectation(text, plan.configuration, plan.library.units());
    if (!expectation) return expectation.error();
    parsed.expectations.push_back(*std::move(expectation));
  }
  return parsed;
}

/// One that may begin; else why not.
std::optional<RunPlan> plan(const MeasuredRequest& request, const Library& library, std::string& why) {
  TextFile out, err;
  RunRequest run = request.run;
  run.expect.clear();
  run.watch.clear();
  run.json = false;
  auto made = plan_run(run, library, out.file(), err.file());
  if (!made) why = err.text();
  return made;
}

void add_remarks(std::span<const Task* const> tasks, bool is_flag_up, std::vector<std::string>& remarks) {
  const auto add = [&remarks](const Task& task, std::uint64_t count, const char* what) {
    if (count > 0) remarks.push_back(std::string(task.spec->name) + ": " + std::to_string(count) + " " + what);
  };
  for (const Task* each : tasks) {
    const Task& task = *each;
    add(task, task.profile.missed, "missed");
    add(task, task.profile.dropped, "dropped");
    add(task, task.profile.overrun, "over budget");
    add(task, task.profile.rejected, "outputs rejected");
    add(task, task.profile.events_lost, "events lost");
    add(task, task.faults.count, "faults");
  }
  if (is_flag_up) remarks.emplace_back("the illegal-configuration flag is up");
}

class Measuring {
 public:
  Measuring(const MeasuredRequest& request, const RunPlan& plan, Application application, ParsedMeasures parsed)
      : request_(request), plan_(plan), application_(std::move(application)), parsed_(std::move(parsed)) {}

  MeasuredRun run() {
    RunOptions options;
    options.script = Script(plan_.acts);
    options.asked = &asked_;
    loop_ = make_virtual_loop(application_, request_.run, options);
    MeasuredRun made;
    if (auto started = loop_->start(); !started) return failed(started.error());
    for (auto* list : {&parsed_.measures, &parsed_.expectations})
      for (Measure& measure : *list)
        if (auto bound = measure.bind(application_); !bound) return failed(bound.error());
    const RunEnd end = go(made.ran);
    if (end == RunEnd::kTaskStopped)
      made.failure = "ended by the reaction `stop` of task '" + who_stopped(application_.all_tasks()) + "'";
    report(made);
    return made;
  }

 private:
  static MeasuredRun failed(const Error& error) {
    MeasuredRun made;
    made.failure =
        trimmed(error.where.c_str() + std::string(error.where.view().empty() ? "" : ": ") + error.message.c_str());
    return made;
  }

  RunEnd go(Nanoseconds& ran) {
    const Nanoseconds every = sample_distance(request_.every, request_.run.duration, plan_.configuration.spec());
    for (Nanoseconds at;;) {
      at = std::min(at + every, request_.run.duration);
      const auto end = loop_->advance(at);
      ran = end ? std::min(loop_->now(), request_.run.duration) : at;
      for (auto* list : {&parsed_.measures, &parsed_.expectations})
        for (Measure& measure : *list) measure.add_sample(ran);
      if (end) return *end;
    }
  }

  void report(MeasuredRun& made) {
    for (const Measure& measure : parsed_.measures)
      for (Measure::Number& number : measure.numbers()) made.numbers.push_back(std::move(number));
    for (const Measure& expectation : parsed_.expectations) {
      RunReport::Judged judged{expectation.text(), {}, false};
      judged.holds = expectation.holds(judged.said);
      made.expectations.push_back(std::move(judged));
    }
    const auto tasks = application_.all_tasks();
    add_remarks(tasks, application_.is_flag_up(), made.remarks);
    for (std::string& line : refused_lines(*loop_, tasks, asked_, application_.spec()))
      made.remarks.push_back(std::move(line));
    for (std::string& remark : made.remarks)
      if (remark.ends_with('\n')) remark.pop_back();
    loop_->shut_down();
    for (const Task* task : tasks)
      if (task->faults.off_count > 0 && made.failure.empty())
        made.failure =
            std::string(task->spec->name) + ": " + not_off_text(task->faults.off_method, task->faults.off_text);
  }

  const MeasuredRequest& request_;
  const RunPlan& plan_;
  Application application_;
  ParsedMeasures parsed_;
  AskedSets asked_{application_.spec()};
  std::unique_ptr<RunLoop> loop_;
};

}  // namespace

Result<void> judge_measured(const MeasuredRequest& request, const Library& library) {
  std::string why;
  const auto planned = plan(request, library, why);
  if (!planned) return Error{ErrorCode::kRefused, std::string_view(why), {}};
  const auto measures = parse_measures(request, *planned);
  return measures ? Result<void>() : Result<void>(measures.error());
}

MeasuredRun measured_run(const MeasuredRequest& request, const Library& library) {
  MeasuredRun refused;
  const auto planned = plan(request, library, refused.failure);
  if (!planned) return refused;
  auto measures = parse_measures(request, *planned);
  std::error_code error;
  if (!request.folder.empty()) std::filesystem::current_path(request.folder, error);
  if (error) {
    refused.failure = request.folder + ": " + error.message();
    return refused;
  }
  auto application = Application::load(planned->configuration, planned->library, Application::Contexts::kByRtpu);
  if (measures && application) return Measuring(request, *planned, *std::move(application), *std::move(measures)).run();
  const Error& why = measures ? application.error() : measures.error();
  refused.failure = why.message.c_str();
  return refused;
}

std::string encode(const MeasuredRun& run) {
  Json numbers = Json::array(), expectations = Json::array();
  for (const Measure::Number& number : run.numbers)
    numbers.push_back({number.name, number.unit, number.value ? Json(*number.value) : Json()});
  for (const RunReport::Judged& judged : run.expectations)
    expectations.push_back({judged.text, judged.said, judged.holds});
  return Json{{"failure", run.failure},
              {"numbers", std::move(numbers)},
              {"expectations", std::move(expectations)},
              {"remarks", run.remarks},
              {"ran", run.ran.count}}
      .dump();
}

MeasuredRun decode_measured(const std::string& text) {
  MeasuredRun run;
  try {
    const Json json = Json::parse(text);
    run.failure = json.at("failure").as_string();
    run.remarks = json.at("remarks").as_strings();
    run.ran = Nanoseconds{json.at("ran").as_int64()};
    for (const Json& number : json.at("numbers"))
      run.numbers.push_back({number[0].as_string(), number[1].as_string(),
                             number[2].is_null() ? std::nullopt : std::optional(number[2].as_double())});
    for (const Json& judged : json.at("expectations"))
      run.expectations.push_back({judged[0].as_string(), judged[1].as_string(), judged[2].as_bool()});
  } catch (const JsonError&) {
    run = {};
    run.failure = "the process of this run ended without a result";
  }
  return run;
}

}  // namespace chimera::cli
