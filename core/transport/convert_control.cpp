// Messages that hold the graph together: acknowledgement, request for lines, command, run,
// status.
#include "core/transport/convert_parts.h"

namespace vpslam {

ack_t ToWire(const Ack& ack) {
  ack_t wire{};
  wire.stream = ack.stream;
  wire.stream_session = ack.stream_session;
  wire.consumer = ack.consumer;
  wire.received = ack.received;
  wire.done = ack.done;
  return wire;
}

std::optional<Ack> FromWire(const ack_t& wire, std::string* why) {
  return Checked(Ack{wire.stream, wire.stream_session, wire.consumer, wire.received, wire.done},
                 why);
}

lines_request_t ToWire(const LinesRequest& request) {
  lines_request_t wire{};
  wire.frame_seq = request.frame_seq;
  wire.image_session = request.image_session;
  wire.detector = request.detector;
  return wire;
}

std::optional<LinesRequest> FromWire(const lines_request_t& wire, std::string* why) {
  return Checked(LinesRequest{wire.frame_seq, wire.image_session, wire.detector}, why);
}

command_t ToWire(const Command& command) {
  command_t wire{};
  wire.target = command.target;
  wire.action = static_cast<int32_t>(command.action);
  wire.value = command.value;
  return wire;
}

std::optional<Command> FromWire(const command_t& wire, std::string* why) {
  return Checked(Command{wire.target, static_cast<CommandAction>(wire.action), wire.value}, why);
}

run_t ToWire(const RunDescription& run) {
  run_t wire{};
  wire.seed = static_cast<int64_t>(run.seed);
  wire.commit = run.commit;
  wire.options = run.options;
  return wire;
}

std::optional<RunDescription> FromWire(const run_t& wire, std::string* why) {
  return Checked(RunDescription{static_cast<uint64_t>(wire.seed), wire.commit, wire.options}, why);
}

status_t ToWire(const ProcessStatus& status) {
  status_t wire{};
  wire.process = status.process;
  wire.pid = status.pid;
  wire.protocol_version = status.protocol_version;
  wire.state = static_cast<int32_t>(status.state);
  wire.rate_hz = status.rate_hz;
  wire.processed = status.processed;
  wire.queued = status.queued;
  wire.dropped = status.dropped;
  wire.gaps = status.gaps;
  wire.rejected = status.rejected;
  wire.resent = status.resent;
  wire.cpu_s = status.cpu_s;
  wire.rss_peak_mb = status.rss_peak_mb;
  wire.message = status.message;
  return wire;
}

std::optional<ProcessStatus> FromWire(const status_t& wire, std::string* why) {
  ProcessStatus status;
  status.process = wire.process;
  status.pid = wire.pid;
  status.protocol_version = wire.protocol_version;
  status.state = static_cast<ProcessState>(wire.state);
  status.rate_hz = wire.rate_hz;
  status.processed = wire.processed;
  status.queued = wire.queued;
  status.dropped = wire.dropped;
  status.gaps = wire.gaps;
  status.rejected = wire.rejected;
  status.resent = wire.resent;
  status.cpu_s = wire.cpu_s;
  status.rss_peak_mb = wire.rss_peak_mb;
  status.message = wire.message;
  return Checked(std::move(status), why);
}

}  // namespace vpslam
