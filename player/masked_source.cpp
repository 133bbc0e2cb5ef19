#include "player/masked_source.h"

#include <utility>

#include "core/base/mask_file.h"

namespace vpslam {
namespace {

class MaskedSource : public ImageSource {
 public:
  MaskedSource(std::unique_ptr<ImageSource> source, Camera camera)
      : source_(std::move(source)), camera_(std::move(camera)) {}

  const Camera& camera() const override { return camera_; }
  bool IsLive() const override { return source_->IsLive(); }
  bool HasFeatures() const override { return source_->HasFeatures(); }
  bool WaitReady(std::chrono::milliseconds patience) override {
    return source_->WaitReady(patience);
  }
  std::optional<SourceFrame> Next() override { return source_->Next(); }
  std::optional<SE3> WorldFromCam(int64_t stamp_us) const override {
    return source_->WorldFromCam(stamp_us);
  }
  std::string Notice() const override { return source_->Notice(); }
  SourceReport Report() override { return source_->Report(); }

 private:
  const std::unique_ptr<ImageSource> source_;
  const Camera camera_;
};

}  // namespace

std::unique_ptr<ImageSource> WithMask(std::unique_ptr<ImageSource> source,
                                      const std::string& mask_file) {
  Camera camera = source->camera();
  camera.mask_runs = ReadMaskFile(mask_file, camera.width, camera.height);
  return std::make_unique<MaskedSource>(std::move(source), std::move(camera));
}

}  // namespace vpslam
