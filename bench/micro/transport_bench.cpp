// Map changes as bytes, and messages there and back.
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "bench/micro/scene.h"
#include "core/transport/bus.h"
#include "core/transport/codec.h"

namespace vpslam {
namespace {

/// The largest part of what a map of so many keyframes is in messages.
MapDelta Delta(int num_keyframes) {
  MapScene scene = MakeMapScene(num_keyframes);
  std::vector<MapDelta> parts = scene.map.TakeDeltas(scene.last, MappingTimes());
  MapDelta largest = parts.front();
  for (const MapDelta& part : parts) {
    if (part.geometries.size() > largest.geometries.size()) largest = part;
  }
  return largest;
}

void EncodeDelta(benchmark::State& state) {
  const MapDelta delta = Delta(static_cast<int>(state.range(0)));
  size_t bytes = 0;
  for (auto _ : state) {
    const std::vector<uint8_t> encoded = Encode(Header(), delta);
    bytes = encoded.size();
    benchmark::DoNotOptimize(encoded.data());
  }
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(bytes));
}
BENCHMARK(EncodeDelta)->Arg(2)->Arg(20)->Unit(benchmark::kMicrosecond);

void DecodeDelta(benchmark::State& state) {
  const std::vector<uint8_t> bytes = Encode(Header(), Delta(static_cast<int>(state.range(0))));
  std::string why;
  for (auto _ : state) {
    const auto decoded = Decode<MapDelta>(bytes, &why);
    if (!decoded) return state.SkipWithError(why.c_str());
    benchmark::DoNotOptimize(decoded->value.version);
  }
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(bytes.size()));
}
BENCHMARK(DecodeDelta)->Arg(2)->Arg(20)->Unit(benchmark::kMicrosecond);

/// `bytes` on PING to the other party, which sends them back on PONG.
void PingPong(benchmark::State& state, Bus& near, Bus& far) {
  using std::chrono::milliseconds;
  const std::vector<uint8_t> payload(static_cast<size_t>(state.range(0)), 7);
  std::atomic<int64_t> returned = 0;
  const auto echo =
      far.Subscribe("PING", [&](std::span<const uint8_t> bytes) { far.Publish("PONG", bytes); });
  const auto count = near.Subscribe("PONG", [&](std::span<const uint8_t>) { ++returned; });
  const auto round_trip = [&] {
    const int64_t before = returned;
    near.Publish("PING", payload);
    return near.WaitFor([&] { return returned > before; }, milliseconds(500));
  };
  // A first one may come too early.
  if (!round_trip() && !round_trip()) return state.SkipWithError("nothing comes back");
  for (auto _ : state) {
    if (!round_trip()) return state.SkipWithError("a message was lost");
  }
  state.SetBytesProcessed(2 * state.iterations() * state.range(0));
}

void RoundTripInProcess(benchmark::State& state) {
  BusOptions options;
  options.url = "memq://";
  Bus bus(options);
  PingPong(state, bus, bus);
}
BENCHMARK(RoundTripInProcess)->Arg(200)->Arg(60000)->UseRealTime()->Unit(benchmark::kMicrosecond);

void RoundTripMulticast(benchmark::State& state) {
  BusOptions options;
  options.url = "udpm://239.255.76.67:" + std::to_string(20000 + getpid() % 20000);
  try {
    Bus near(options), far(options);
    PingPong(state, near, far);
  } catch (const std::exception& e) {
    state.SkipWithError(e.what());
  }
}
BENCHMARK(RoundTripMulticast)->Arg(200)->Arg(60000)->UseRealTime()->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace vpslam
