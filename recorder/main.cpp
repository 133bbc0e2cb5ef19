// recorder: keeps what a run leaves behind.
#include <atomic>
#include <cstdio>
#include <ctime>
#include <exception>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "core/base/json_text.h"
#include "core/transport/process.h"
#include "recorder/record.h"
#include "recorder/results_folder.h"
#include "recorder/summary.h"

namespace {

using namespace vpslam;

nlohmann::ordered_json ParseOptions(const std::string& text) {
  const auto json = nlohmann::ordered_json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) {
    throw std::runtime_error("--options is no JSON object; write it as '{\"preset\": \"points\"}'");
  }
  return json;
}

std::atomic<bool> stop = false;  // outlives the thread that handles signals

int Run(Process& process, const std::string& out, const RunInfo& info, bool show_progress) {
  process.OnStopSignal([&process] {
    stop = true;
    process.bus.Notify();
  });
  std::function<void(const std::string&)> progress;
  if (show_progress) {
    progress = [](const std::string& line) {
      std::puts(line.c_str());
      std::fflush(stdout);
    };
  }
  const ResultsFolder folder(out);
  std::optional<MessageLogOptions> log;
  if (process.options.IsRecorded()) {
    log = {folder.path() + "/log.lcm",
           process.options.record == "all",
           {static_cast<uint64_t>(info.seed), info.commit, info.options.dump()}};
  }
  bool complete = false;
  try {
    complete = Recorder(process.bus, process.status, folder, info, progress, log).Run(stop);
  } catch (const std::exception& e) {
    // Where the disk is full, the log has no room for it either.
    if (progress) progress(ToText(nlohmann::ordered_json{{"error", e.what()}}));
    throw;
  }
  if (!complete) spdlog::warn("stopped before poses and map had ended");
  return kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Follows a run of the VP-SLAM process graph and writes its results.");
  std::string out = fmt::format("results/{:%Y%m%d-%H%M%S}", fmt::localtime(std::time(nullptr)));
  std::string options_json = "{}";
  bool show_progress = false;
  RunInfo info;
  ProcessOptions options;
  options.name = "recorder";
  app.add_option("--out", out, "folder for the results")->capture_default_str();
  app.add_flag("--progress", show_progress, "print lines of JSON that tell how far the run is");
  app.add_option("--seed", info.seed, "of the run, for summary.json");
  app.add_option("--options", options_json, "of the run, a JSON object, for summary.json");
  AddProcessOptions(app, &options);
  return RunProcess(app, argc, argv, &options, [&](Process& process) {
    info.options = ParseOptions(options_json);
    info.commit = GitCommit();
    return Run(process, out, info, show_progress);
  });
}
