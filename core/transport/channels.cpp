#include "core/transport/channels.h"

#include <algorithm>

namespace vpslam {

std::vector<std::string> RequiredConsumers(const std::vector<std::string>& consumers,
                                           const std::vector<std::string>& required) {
  std::vector<std::string> both;
  for (const std::string& name : consumers) {
    if (std::find(required.begin(), required.end(), name) != required.end()) both.push_back(name);
  }
  return both;
}

std::vector<std::string> AndRecorderIf(bool recorded, std::vector<std::string> consumers) {
  if (recorded) consumers.emplace_back("recorder");
  return consumers;
}

}  // namespace vpslam
