// A request to a process of the graph.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/description.h"

namespace vpslam {

enum class CommandAction : int32_t {
  kStop = 1,        ///< end the sequence now, as if it were over; results are written
  kSaveNow = 3,     ///< recorder: write the results so far
  kSendCamera = 4,  ///< player: repeat the camera message at once
  kPause = 5,       ///< player: send nothing more until kResume or kStep
  kResume = 6,      ///< player
  kStep = 7,        ///< player: send `value` frames, then pause
  kSetRate = 8,     ///< player: at most `value` times real time; 0 for no limit
  kShow = 9,        ///< frontend: publish previews for some seconds
};

struct Command {
  std::string target;  ///< process name; empty: everyone whom it concerns
  CommandAction action = CommandAction::kStop;
  double value = 0;  ///< what kStep and kSetRate need

  static constexpr const char* kWireName = "command_t";
  static void Describe(auto& v, auto& m) {
    auto& [target, action, value] = m;
    using enum CommandAction;
    v("target", target, ProcessName{.may_be_empty = true});
    v("action", action,
      OneOf<kStop, kSaveNow, kSendCamera, kPause, kResume, kStep, kSetRate, kShow>());
    v("value", value, Within{0, 1e9});
  }
};

}  // namespace vpslam
