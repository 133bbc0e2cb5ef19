// Lines, their descriptors, and vanishing points of one image.
#include <benchmark/benchmark.h>

#include "bench/micro/scene.h"
#include "vpdetector/line_descriptor.h"
#include "vpdetector/line_extractor.h"
#include "vpdetector/vp_estimator.h"

namespace vpslam {
namespace {

const std::vector<EdgeSegment>& Segments() {
  static const std::vector<EdgeSegment> segments =
      ExtractLines(Images().images[0], Images().camera, LineExtractorOptions());
  return segments;
}

void ExtractLineSegments(benchmark::State& state) {
  LineExtractorOptions options;
  options.detector.kind = static_cast<LineDetectorKind>(state.range(0));
  state.SetLabel(Name(options.detector.kind));
  for (auto _ : state) {
    benchmark::DoNotOptimize(ExtractLines(Images().images[0], Images().camera, options));
  }
}
BENCHMARK(ExtractLineSegments)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

void DescribeLineSegments(benchmark::State& state) {
  const LineDescriptorOptions options;
  size_t count = 0;
  for (auto _ : state) {
    const auto descriptors =
        DescribeLines(Images().images[0], Images().camera, Segments(), options);
    count = descriptors.size();
    benchmark::DoNotOptimize(descriptors.data());
  }
  state.counters["lines"] = static_cast<double>(count);
}
BENCHMARK(DescribeLineSegments)->Unit(benchmark::kMillisecond);

void EstimateVps(benchmark::State& state) {
  VpOptions options;
  options.method = static_cast<VpMethod>(state.range(0));
  state.SetLabel(Name(options.method));
  for (auto _ : state) {
    benchmark::DoNotOptimize(EstimateVanishingPoints(Segments(), Images().camera, options));
  }
  state.counters["segments"] = static_cast<double>(Segments().size());
}
BENCHMARK(EstimateVps)->DenseRange(0, 1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vpslam
