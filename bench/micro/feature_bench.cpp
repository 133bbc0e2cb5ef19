// Point features of one image, and their matching between two.
#include <map>
#include <numeric>

#include <benchmark/benchmark.h>

#include "bench/micro/scene.h"
#include "core/features/matcher.h"
#include "core/features/orb_extractor.h"

namespace vpslam {
namespace {

struct View {
  Features features;
  FeatureGrid grid;
};

/// Of the first two images.
const std::vector<View>& Views(int num_features) {
  static std::map<int, std::vector<View>> made;
  std::vector<View>& views = made[num_features];
  if (views.empty()) {
    OrbOptions options;
    options.num_features = num_features;
    OrbExtractor extractor(Images().camera, options);
    for (int i = 0; i < 2; ++i) {
      View view;
      view.features = extractor.Extract(Images().images[i]);
      view.grid = FeatureGrid(view.features.keypoints, Images().camera.UndistortedBounds());
      views.push_back(std::move(view));
    }
  }
  return views;
}

std::vector<int32_t> All(const Features& features) {
  std::vector<int32_t> all(features.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

void ExtractOrb(benchmark::State& state) {
  OrbOptions options;
  options.num_features = static_cast<int>(state.range(0));
  OrbExtractor extractor(Images().camera, options);
  for (auto _ : state) benchmark::DoNotOptimize(extractor.Extract(Images().images[0]));
}
BENCHMARK(ExtractOrb)->Arg(1000)->Arg(2000)->Unit(benchmark::kMillisecond);

void SortIntoGrid(benchmark::State& state) {
  const View& view = Views(1000)[0];
  const Camera::Bounds bounds = Images().camera.UndistortedBounds();
  for (auto _ : state) benchmark::DoNotOptimize(FeatureGrid(view.features.keypoints, bounds));
}
BENCHMARK(SortIntoGrid)->Unit(benchmark::kMicrosecond);

/// As when a frame is matched with the local map: every feature of one view is looked for.
void MatchInWindows(benchmark::State& state) {
  const std::vector<View>& views = Views(1000);
  const Features& queries = views[0].features;
  for (auto _ : state) {
    for (int i = 0; i < queries.size(); ++i) {
      WindowQuery query;
      query.x_px = queries.keypoints[i].x_px;
      query.y_px = queries.keypoints[i].y_px;
      query.radius_px = static_cast<float>(state.range(0));
      benchmark::DoNotOptimize(
          BestMatchInWindow(queries.descriptors[i], query, views[1].features, views[1].grid));
    }
  }
  state.SetItemsProcessed(state.iterations() * queries.size());
}
BENCHMARK(MatchInWindows)->Arg(15)->Arg(60)->Unit(benchmark::kMicrosecond);

void MatchToInitialise(benchmark::State& state) {
  const std::vector<View>& views = Views(2000);
  std::vector<Eigen::Vector2f> predicted_px;
  for (const Keypoint& k : views[0].features.keypoints) predicted_px.emplace_back(k.x_px, k.y_px);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        MatchForInitialisation(views[0].features, views[1].features, views[1].grid, predicted_px));
  }
}
BENCHMARK(MatchToInitialise)->Unit(benchmark::kMillisecond);

void MatchToTriangulate(benchmark::State& state) {
  const std::vector<View>& views = Views(1000);
  const OrbExtractor extractor(Images().camera, OrbOptions());
  const SE3 second_from_first = Images().cam_from_world[1] * Images().cam_from_world[0].Inverse();
  const std::vector<int32_t> first = All(views[0].features), second = All(views[1].features);
  for (auto _ : state) {
    benchmark::DoNotOptimize(MatchForTriangulation(views[0].features, first, views[1].features,
                                                   second, second_from_first, Images().camera,
                                                   extractor.scales()));
  }
}
BENCHMARK(MatchToTriangulate)->Unit(benchmark::kMillisecond);

void MatchByBruteForce(benchmark::State& state) {
  const std::vector<View>& views = Views(1000);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        MatchByDescriptor(views[0].features.descriptors, views[1].features.descriptors));
  }
}
BENCHMARK(MatchByBruteForce)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace vpslam
