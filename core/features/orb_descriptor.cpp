#include "core/features/orb_descriptor.h"

#include <cstring>
#include <numbers>
#include <stdexcept>

#include <opencv2/features2d.hpp>

namespace vpslam {

std::vector<Descriptor> Describe(const cv::Mat& image, const std::vector<Corner>& corners,
                                 const std::vector<float>& angles_rad) {
  std::vector<Descriptor> descriptors(corners.size());
  if (corners.empty()) return descriptors;
  std::vector<cv::KeyPoint> keypoints;
  keypoints.reserve(corners.size());
  for (size_t i = 0; i < corners.size(); ++i) {
    keypoints.emplace_back(static_cast<float>(corners[i].x), static_cast<float>(corners[i].y), 31.f,
                           angles_rad[i] * 180.0f / std::numbers::pi_v<float>,
                           static_cast<float>(corners[i].score), 0);
  }
  // One level and no edge threshold: key points stay as they are, in number and order.
  const cv::Ptr<cv::ORB> orb = cv::ORB::create(static_cast<int>(corners.size()), 1.2f, 1, 0);
  cv::Mat result;
  orb->compute(image.clone(), keypoints, result);
  if (keypoints.size() != corners.size() || result.cols != sizeof(Descriptor)) {
    throw std::logic_error("cv::ORB dropped key points");
  }
  for (size_t i = 0; i < corners.size(); ++i) {
    std::memcpy(descriptors[i].data(), result.ptr(static_cast<int>(i)), sizeof(Descriptor));
  }
  return descriptors;
}

}  // namespace vpslam
