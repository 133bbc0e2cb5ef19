// A live camera: always its newest frame. Frames that come while the graph is busy are left out,
// and counted, since a camera does not wait.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "player/frame_capture.h"
#include "player/image_source.h"

namespace vpslam {

/// `camera:0`, `camera:/dev/video0`, `/dev/video0`, or the URL of a stream.
bool IsLiveCamera(const std::string& name);

/// Throws std::runtime_error with one line naming device, fault and remedy.
std::unique_ptr<ImageSource> OpenLiveCamera(const std::string& name, const SourceOptions& options);

struct LiveCameraPatience {
  /// Without a frame for so long the camera has failed, although its driver does not say so.
  std::chrono::milliseconds stalled{10000};
  /// A driver that does not return from a read for so long is not waited for at the end.
  std::chrono::milliseconds stop{1000};
};

/// The same with a given capture, for tests. `camera` is the calibration that holds for its frames,
/// `camera_name` the file it is from.
std::unique_ptr<ImageSource> MakeLiveCamera(std::unique_ptr<FrameCapture> capture,
                                            const Camera& camera, const std::string& camera_name,
                                            const SourceOptions& options,
                                            const LiveCameraPatience& patience = {});

/// The calibration for images of another size but of the same shape, taken to be the whole view
/// made smaller or larger; throws std::runtime_error if the shape differs.
Camera ScaledCamera(const Camera& camera, int width, int height);

}  // namespace vpslam
