// console: looks into a running graph or a log, and gives commands. It is no part of the graph: it
// says nothing of itself on STATUS, and nobody waits for it.
#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "console/commands.h"
#include "console/log_summary.h"
#include "console/status_line.h"
#include "core/base/json_text.h"
#include "core/transport/channels.h"
#include "core/transport/inbox.h"
#include "core/transport/process.h"
#include "core/transport/publisher.h"

namespace {

using namespace vpslam;
using std::chrono::duration_cast;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

BusOptions OptionsOf(const std::string& url) {
  RequireGraphUrl(url);
  BusOptions options;
  options.url = url;
  return options.WithEnvironment();
}

void PrintStatuses(const std::string& url, double seconds) {
  Bus bus(OptionsOf(url));
  Inbox<ProcessStatus> statuses(bus, kStatusChannel, Inbox<ProcessStatus>::kUnbounded);
  const auto end = steady_clock::now() + std::chrono::duration<double>(seconds);
  while (true) {
    const auto left = duration_cast<milliseconds>(end - steady_clock::now());
    if (seconds > 0 && left <= left.zero()) return;
    bus.WaitFor([&] { return statuses.HasMessage(); }, seconds > 0 ? left : milliseconds(1000));
    while (const auto status = statuses.TryTake()) {
      std::puts(StatusLine(status->header.session, status->value).c_str());
    }
    if (std::fflush(stdout) != 0) return;  // nobody reads on
  }
}

Command Parse(const std::string& text) {
  std::string why;
  const auto command = ParseCommand(text, &why);
  if (!command) throw std::runtime_error(why);
  return *command;
}

void Give(const std::string& url, const std::string& text, double every_s) {
  const Command command = Parse(text);
  Bus bus(OptionsOf(url));
  Publisher<Command> commands(bus, kCommandChannel);
  commands.Publish(command);
  while (every_s > 0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(every_s));
    commands.Publish(command);
  }
}

void GiveWhatIsTyped(const std::string& url) {
  Bus bus(OptionsOf(url));
  Publisher<Command> commands(bus, kCommandChannel);
  for (std::string line; std::getline(std::cin, line);) {
    try {
      commands.Publish(Parse(line));
    } catch (const std::exception& e) {
      std::fprintf(stderr, "console: %s\n", e.what());
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Looks into a running VP-SLAM graph or a log of one.");
  app.set_version_flag("--version", "console " + VersionLine());
  app.require_subcommand(1);
  std::string url = BusOptions().url, path;
  double seconds = 0, every_s = 0;
  std::vector<std::string> words;
  CLI::App* status = app.add_subcommand("status", "print a line of JSON per STATUS message");
  status->add_option("--seconds", seconds, "end after that time; 0: never")
      ->check(CLI::NonNegativeNumber);
  CLI::App* command = app.add_subcommand("command", "give a command to the process that obeys it");
  command->add_option(
      "command", words,
      fmt::format("one of {}, and its number; none: lines from standard input are commands",
                  fmt::join(CommandNames(), ", ")));
  command->add_option("--every", every_s, "repeat it after so many seconds, until killed")
      ->check(CLI::NonNegativeNumber);
  for (CLI::App* sub : {status, command}) {
    sub->add_option("--url", url, "LCM URL of the graph")->capture_default_str();
  }
  CLI::App* log = app.add_subcommand("log", "print what a log holds, as JSON");
  log->add_option("log", path, "a log of LCM messages")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kExitOk : kExitUsage;
  }
  try {
    if (*status) PrintStatuses(url, seconds);
    if (*command) {
      words.empty() ? GiveWhatIsTyped(url)
                    : Give(url, fmt::format("{}", fmt::join(words, " ")), every_s);
    }
    if (*log) std::puts(ToText(SummarizeLog(path), 2).c_str());
    return kExitOk;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "console: %s\n", e.what());
    return kExitFailed;
  }
}
