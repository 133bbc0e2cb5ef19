#include "console/log_summary.h"

#include <map>
#include <optional>

#include "core/geometry/camera.h"
#include "core/messages/run_description.h"
#include "core/transport/channels.h"
#include "core/transport/codec.h"
#include "core/transport/event_log.h"
#include "core/transport/sequence_watch.h"

namespace vpslam {
namespace {

using Json = nlohmann::ordered_json;

struct Channel {
  int64_t messages = 0, missing = 0, repeated = 0, ended = 0, bytes = 0;
  SequenceWatch watch;
};

Json DescribeRun(const LogEvent& event) {
  std::string why;
  const auto run = Decode<RunDescription>(event.bytes, &why);
  if (!run) return nullptr;
  Json options = Json::parse(run->value.options, nullptr, /*allow_exceptions=*/false);
  if (!options.is_object()) options = Json::object();
  return {{"seed", run->value.seed}, {"commit", run->value.commit}, {"options", options}};
}

Json DescribeCamera(const LogEvent& event) {
  std::string why;
  const auto camera = Decode<Camera>(event.bytes, &why);
  if (!camera) return nullptr;
  return {{"width", camera->value.width}, {"height", camera->value.height}};
}

}  // namespace

Json SummarizeLog(const std::string& path) {
  EventLogReader log(path);
  std::map<std::string, Channel> channels;
  Json run, camera;
  int64_t events = 0, first_us = 0, last_us = 0;
  while (const std::optional<LogEvent> event = log.Next()) {
    if (events++ == 0) first_us = event->stamp_us;
    last_us = event->stamp_us;
    Channel& channel = channels[event->channel];
    ++channel.messages;
    channel.bytes += static_cast<int64_t>(event->bytes.size());
    if (run.is_null() && event->channel == kRunChannel) run = DescribeRun(*event);
    if (camera.is_null() && event->channel == kCameraChannel) camera = DescribeCamera(*event);
    if (!HasSequence(event->channel)) continue;
    if (const auto header = PeekHeader(event->bytes)) {
      const SequenceWatch::Verdict verdict = channel.watch.See(*header);
      channel.missing += verdict.missed;
      if (!verdict.is_new) ++channel.repeated;
      if (header->last) ++channel.ended;
    }
  }
  Json described = Json::object();
  for (const auto& [name, channel] : channels) {
    const bool numbered = HasSequence(name);
    described[name] = {{"messages", channel.messages},
                       {"missing", numbered ? Json(channel.missing) : Json()},
                       {"repeated", numbered ? Json(channel.repeated) : Json()},
                       {"ended", channel.ended},
                       {"bytes", channel.bytes}};
  }
  return {{"events", events},
          {"damaged_bytes", log.damaged_bytes()},
          {"damaged_places", log.damaged_places()},
          {"duration_s", 1e-6 * static_cast<double>(last_us - first_us)},
          {"run", run},
          {"camera", camera},
          {"channels", described}};
}

}  // namespace vpslam
