#include "player/sim_source.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "core/base/camera_file.h"
#include "core/base/stopwatch.h"
#include "player/simulator/simulator.h"
#include "player/truth_track.h"

namespace vpslam {
namespace {

class SimSource : public ImageSource {
 public:
  SimSource(const std::string& name, const SourceOptions& options)
      : simulator_(simulator::Simulator::Create(name)), camera_(simulator_.camera()) {
    if (!options.camera_file.empty()) camera_ = ReadCameraFile(options.camera_file);
    if (camera_.width != simulator_.camera().width ||
        camera_.height != simulator_.camera().height) {
      throw std::runtime_error(fmt::format(
          "{}: is not for {} x {} px, as {} needs; leave out --camera", options.camera_file,
          simulator_.camera().width, simulator_.camera().height, name));
    }
    if (options.start >= simulator_.frames()) {
      throw std::runtime_error(
          fmt::format("{}: has {} frames, and --start {} leaves none; start earlier", name,
                      simulator_.frames(), options.start));
    }
    next_ = first_ = static_cast<int>(options.start);
    end_ = simulator_.frames();
    if (options.max_frames > 0) {
      end_ = static_cast<int>(std::min<int64_t>(end_, options.start + options.max_frames));
    }
    for (int i = next_; i < end_; ++i) {
      truth_.Add(simulator_.stamp_us(i), simulator_.world_from_cam(i));
    }
  }

  const Camera& camera() const override { return camera_; }

  std::optional<SourceFrame> Next() override {
    if (next_ >= end_) return std::nullopt;
    const int i = next_++;
    Stopwatch watch;
    cv::Mat image = simulator_.Render(i);
    return SourceFrame{simulator_.stamp_us(i), std::move(image), watch.Lap_ms()};
  }

  std::optional<SE3> WorldFromCam(int64_t stamp_us) const override {
    return truth_.Nearest(stamp_us);
  }

  SourceReport Report() override {
    SourceReport report;
    report.expected = end_ - first_;
    return report;
  }

 private:
  simulator::Simulator simulator_;
  Camera camera_;  // what is told to others; a calibration file may be wrong on purpose
  TruthTrack truth_;
  int first_ = 0, next_ = 0, end_ = 0;
};

}  // namespace

bool IsSimulation(const std::string& name) { return name.starts_with("sim:"); }

std::unique_ptr<ImageSource> OpenSimulation(const std::string& name, const SourceOptions& options) {
  return std::make_unique<SimSource>(name, options);
}

}  // namespace vpslam
