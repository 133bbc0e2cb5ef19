// The pose of a frame, and local bundle adjustment.
#include <benchmark/benchmark.h>

#include "backend/local_ba.h"
#include "bench/micro/scene.h"

namespace vpslam {
namespace {

void OptimiseFramePose(benchmark::State& state) {
  const Camera camera = SceneCamera();
  const auto measurements = MakeMeasurements(camera, static_cast<int>(state.range(0)));
  const SE3 initial(Eigen::Quaterniond::Identity(), {0.05, -0.03, 0.04});
  for (auto _ : state) {
    benchmark::DoNotOptimize(OptimizePose(camera, measurements, initial, PoseOptimizerOptions()));
  }
}
BENCHMARK(OptimiseFramePose)->Arg(50)->Arg(200)->Arg(800)->Unit(benchmark::kMicrosecond);

/// From 200 points, so many lines, and the vanishing points' rotation.
void OptimiseFramePoseWithLines(benchmark::State& state) {
  const Camera camera = SceneCamera();
  const auto measurements = MakeMeasurements(camera, 200, static_cast<int>(state.range(0)));
  const SE3 initial(Eigen::Quaterniond::Identity(), {0.05, -0.03, 0.04});
  for (auto _ : state) {
    benchmark::DoNotOptimize(OptimizePose(camera, measurements, initial, PoseOptimizerOptions()));
  }
}
BENCHMARK(OptimiseFramePoseWithLines)->Arg(30)->Arg(100)->Unit(benchmark::kMicrosecond);

void AdjustScene(benchmark::State& state, bool with_lines) {
  LocalBaOptions options;
  options.max_keyframes = options.max_fixed_keyframes = static_cast<int>(state.range(0));
  const MapScene scene = MakeMapScene(2 * options.max_keyframes, with_lines);
  const OrbOptions orb;
  const ScalePyramid scales(orb.num_levels, orb.scale_factor, orb.sigma_px);
  const ManhattanFrames no_axes{ManhattanOptions()};
  BaSummary summary;
  for (auto _ : state) {
    state.PauseTiming();
    OwnedMap map = scene.map;
    const MappingContext context{scene.camera, scene.bounds, scales, map};
    state.ResumeTiming();
    summary = AdjustLocally(context, scene.last, no_axes, options, options.max_iterations);
  }
  state.counters["keyframes"] = summary.keyframes;
  state.counters["points"] = summary.points;
  state.counters["observations"] = summary.observations;
  state.counters["iterations"] = summary.iterations;
}

/// By the number of poses that move; as many others hold the gauge.
void AdjustWindow(benchmark::State& state) { AdjustScene(state, false); }
BENCHMARK(AdjustWindow)->Arg(2)->Arg(5)->Arg(10)->Arg(20)->Unit(benchmark::kMillisecond);
void AdjustWindowWithLines(benchmark::State& state) { AdjustScene(state, true); }
BENCHMARK(AdjustWindowWithLines)->Arg(10)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vpslam
