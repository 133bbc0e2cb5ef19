// Conversions of the parts that several messages share.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/transport/convert.h"

namespace vpslam {

/// `value`, if it is sound.
template <class T>
std::optional<T> Checked(T value, std::string* why) {
  if (Fault fault = Validate(value)) {
    *why = *std::move(fault);
    return std::nullopt;
  }
  return value;
}

void CopyQuaternion(const Eigen::Quaterniond& from, double (&to)[4]);
/// Not normalised, so that a pose arrives bit by bit as it was sent.
Eigen::Quaterniond ReadQuaternion(const double (&from)[4]);

se3_t ToWirePose(const SE3& pose);
SE3 FromWirePose(const se3_t& wire);

descriptor_t ToWireDescriptor(const Descriptor& descriptor);
Descriptor FromWireDescriptor(const descriptor_t& wire);

void CopyFeatures(const Features& from, std::vector<keypoint_t>* keypoints,
                  std::vector<descriptor_t>* descriptors);
Features ReadFeatures(const std::vector<keypoint_t>& keypoints,
                      const std::vector<descriptor_t>& descriptors);

line_set_t CopyLineSet(const LineSet& from, std::vector<line_segment_t>* lines,
                       std::vector<vanishing_point_t>* vanishing_points);
LineSet ReadLineSet(const line_set_t& set, const std::vector<line_segment_t>& lines,
                    const std::vector<vanishing_point_t>& vanishing_points);

}  // namespace vpslam
