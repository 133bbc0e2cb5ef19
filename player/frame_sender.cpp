#include "player/frame_sender.h"

#include <cstddef>
#include <string>
#include <vector>

#include "core/messages/frame_features.h"
#include "core/transport/channels.h"
#include "core/transport/clock.h"
#include "core/transport/image_message.h"
#include "core/transport/image_pool.h"

namespace vpslam {
namespace {

constexpr int kLosslessWindow = 4;
/// In realtime a slot is used again after so many images, whether or not they were looked at.
/// Readers copy an image when they take it up, and drop what waits longer than this.
constexpr int kRealtimeSlots = 12;

int Slots(Pace pace) {
  return pace == Pace::kRealtime ? kRealtimeSlots : FrameWindow(pace).window + 1;
}

/// What images and features have in common.
template <class T>
class StreamSender : public FrameSender {
 public:
  StreamSender(Bus& bus, const char* channel, const std::vector<std::string>& consumers, Pace pace)
      : stream_(bus, channel, consumers, FrameWindow(pace)) {}

  bool HasRoom() const override { return stream_.HasRoom(); }
  bool SendEnd() override { return stream_.SendEnd(); }
  bool WaitAllAcked(std::chrono::milliseconds timeout) override {
    return stream_.WaitAllAcked(timeout);
  }

 protected:
  StreamWriter<T> stream_;
};

class ImageSender : public StreamSender<ImageMessage> {
 public:
  ImageSender(Bus& bus, const Camera& camera, const PlayOptions& options)
      : StreamSender(bus, kImageChannel,
                     AndRecorderIf(options.record == "all",
                                   RequiredConsumers(kImageConsumers, options.required)),
                     options.pace) {
    if (options.inline_pixels) return;
    pool_ = std::make_unique<ImagePool>(ImageSegmentName(bus.session()), Slots(options.pace),
                                        static_cast<std::size_t>(camera.width) * camera.height);
  }

  bool Send(const SourceFrame& frame, int64_t frame_seq) override {
    ImageFrame image;
    image.frame_seq = frame_seq;
    image.stamp_us = frame.stamp_us;
    image.published_us = MonotonicMicroseconds();
    image.decode_ms = frame.decode_ms;
    image.pixels = frame.grey;
    return stream_.Send(pool_ ? pool_->Store(image) : InlineImage(image));
  }

 private:
  std::unique_ptr<ImagePool> pool_;
};

class FeatureSender : public StreamSender<FrameFeatures> {
 public:
  FeatureSender(Bus& bus, const PlayOptions& options)
      : StreamSender(bus, kFeaturesChannel, RequiredConsumers(kImageConsumers, options.required),
                     options.pace) {}

  bool Send(const SourceFrame& frame, int64_t frame_seq) override {
    FrameFeatures features = *frame.features;
    features.frame_seq = frame_seq;
    features.stamp_us = frame.stamp_us;
    features.published_us = MonotonicMicroseconds();
    features.decode_ms = frame.decode_ms;
    return stream_.Send(features);
  }
};

}  // namespace

StreamWriterOptions FrameWindow(Pace pace) {
  StreamWriterOptions options;
  options.window = pace == Pace::kLossless ? kLosslessWindow : 1;
  options.drop_oldest = pace == Pace::kRealtime;
  return options;
}

std::unique_ptr<FrameSender> MakeFrameSender(Bus& bus, const ImageSource& source,
                                             const PlayOptions& options) {
  if (source.HasFeatures()) return std::make_unique<FeatureSender>(bus, options);
  return std::make_unique<ImageSender>(bus, source.camera(), options);
}

}  // namespace vpslam
