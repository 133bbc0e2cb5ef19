#include "console/status_line.h"

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "core/messages/state_names.h"

namespace vpslam {

std::string StatusLine(int64_t session, const ProcessStatus& s) {
  const nlohmann::ordered_json json = {{"process", s.process},
                                       {"session", std::to_string(session)},
                                       {"pid", s.pid},
                                       {"protocol_version", s.protocol_version},
                                       {"state", StateName(s.state)},
                                       {"rate_hz", s.rate_hz},
                                       {"processed", s.processed},
                                       {"queued", s.queued},
                                       {"dropped", s.dropped},
                                       {"gaps", s.gaps},
                                       {"rejected", s.rejected},
                                       {"resent", s.resent},
                                       {"cpu_s", s.cpu_s},
                                       {"rss_peak_mb", s.rss_peak_mb},
                                       {"message", s.message}};
  return ToText(json);
}

}  // namespace vpslam
